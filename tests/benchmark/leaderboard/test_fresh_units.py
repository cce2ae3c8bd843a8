"""Leaders of boards on units that no board is made of."""

from __future__ import annotations

from dataclasses import replace
from statistics import geometric_mean

import pytest

from benchmark.contract import FLIGHT, Cell
from benchmark.leaderboard import fresh_units
from benchmark.leaderboard.fresh_units import FRESH, first_groups
from benchmark.leaderboard.scope import UNITS
from benchmark.plan.parts import Parts, installed_parts
from benchmark.results.store import PUBLISHED, Store

NAME = "qpd-single-aperture"


@pytest.fixture(scope="module")
def parts() -> Parts:
    known = installed_parts()
    return Parts({NAME: known.presets[NAME]}, known.extractors, known.models)


def test_a_first_group_has_the_least_geometric_mean_over_the_units_of_the_board(
    parts: Parts,
) -> None:
    scores = Store(PUBLISHED).scores()
    (leader, *others), behind = first_groups(scores, parts)[NAME]

    def mean(cell: Cell) -> float:
        units = [scores.get(replace(cell, unit=unit)) for unit in range(UNITS)]
        return geometric_mean([row["rms_all_answers_deg"] for row in units if row is not None])

    assert mean(leader) <= min(map(mean, [*others, *behind]))
    assert 0 < len(behind) <= fresh_units.BEHIND
    assert [mean(one) for one in behind] == sorted(mean(one) for one in behind)


def test_a_board_in_flight_is_led_by_what_errs_least_in_flight(parts: Parts) -> None:
    scores = Store(PUBLISHED).scores()
    (leader, *others), behind = first_groups(scores, parts, in_flight=True)[NAME]

    def mean(cell: Cell) -> float:
        units = [scores[replace(cell, unit=unit)]["rms_all_answers_deg"] for unit in range(UNITS)]
        return geometric_mean(units)

    assert {one.condition for one in (leader, *others, *behind)} == {FLIGHT}
    assert all(mean(leader) <= mean(other) for other in others)


@pytest.mark.slow
def test_a_seed_draws_other_suns_units_and_missions(parts: Parts) -> None:
    scores = Store(PUBLISHED)
    (one,) = fresh_units.score_fresh_units(scores, parts=parts, in_flight=True, seeds=[1])
    (other,) = fresh_units.score_fresh_units(scores, parts=parts, in_flight=True, seeds=[2])
    assert one.leader == other.leader
    assert one.over != other.over or one.group_over != other.group_over
    assert 1.0 <= one.group_over <= one.over


@pytest.mark.slow
def test_leaders_are_scored_on_units_that_no_board_has(parts: Parts) -> None:
    assert min(FRESH) == UNITS
    (found,) = fresh_units.score_fresh_units(Store(PUBLISHED), parts=parts)
    (leader, *others), _ = first_groups(Store(PUBLISHED).scores(), parts)[NAME]
    assert (found.dataset, found.leader, found.first) == (NAME, leader, 1 + len(others))
    assert found.first <= found.pipelines
    assert found.over >= 1.0
    assert found.holds or found.over > 1.0


@pytest.mark.parametrize(("times", "over"), [(1.0, 1.0), (2.0, 2.0 / 1.1)])
def test_a_leader_holds_on_fresh_units_where_nobody_errs_less(
    parts: Parts, monkeypatch: pytest.MonkeyPatch, times: float, over: float
) -> None:
    """Made-up errors, the same spread over units: the next ones are a tenth more than the first."""
    scores = Store(PUBLISHED).scores()
    (leader, *others), behind = first_groups(scores, parts)[NAME]
    level = {leader: times} | {one: 1.1 + 0.1 * n for n, one in enumerate([*others, *behind])}

    def errors(wanted: list[Cell], *_told: object) -> dict[Cell, dict[str, float]]:
        return {
            cell: {"rms_all_answers_deg": level[replace(cell, unit=0)] * (1.0 + 0.1 * cell.unit)}
            for cell in wanted
        }

    monkeypatch.setattr(fresh_units, "_measured", errors)
    (found,) = fresh_units.score_fresh_units(Store(PUBLISHED), parts=parts)
    assert found.over == pytest.approx(over)
    assert found.group_over == pytest.approx(1.0 if others else over)
    assert found.holds == (times == 1.0)
    assert (found.leader, found.first) == (leader, 1 + len(others))
    assert found.pipelines >= len(level)


def test_the_command_counts_who_holds_and_fails_where_few_do(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    cell = Cell(NAME, "nominal", "bctm", "lut")
    good = fresh_units.FreshUnitResult(NAME, 40, 3, cell, True, 1.0, 1.0)
    near = fresh_units.FreshUnitResult(NAME, 40, 4, cell, False, 1.3, 1.1)
    far = fresh_units.FreshUnitResult(NAME, 40, 4, cell, False, 1.3, 1.2)
    for found, options, code in (
        ([good] * 19 + [near], [], 0),
        ([good] * 18 + [near] * 2, [], 1),
        ([good] * 18 + [near] * 2, ["--flight"], 0),
        ([good] * 17 + [far] * 3, ["--flight", "--seed", "5"], 1),
    ):
        monkeypatch.setattr(fresh_units, "score_fresh_units", lambda *_, of=found, **__: of)
        assert fresh_units.main(options) == code
        *lines, last = capsys.readouterr().out.splitlines()
        assert len(lines) == len(found)
        assert "3 of 40 in the first group; bctm + lut holds on fresh units, 1.000 of" in lines[0]
        held = sum(one.holds for one in found)
        assert last.startswith(f"{held} of 20 leaders are in the first group on ")
        assert f"{20 - found.count(far)} boards the first group is within 10 %" in last
        assert f"on {held} it has fewer than 10 %" in last
        assert ("drawn by 5" in last) == ("--seed" in options)
