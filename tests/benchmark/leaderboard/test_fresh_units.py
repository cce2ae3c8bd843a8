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
