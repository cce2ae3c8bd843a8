"""Why nothing meets what is asked, and the least that must give way."""

import itertools
import re
from collections.abc import Callable, Mapping

import pytest
from scores import STUDY, pipeline

from registry.measured_pipelines import Measurements, Score
from registry.recommendation import recommend
from registry.relaxation import MOST_CHANGES, Explanation
from registry.requirements import Requirements
from registry.studies import Facts
from tests.registry.drawn_questions import drawn_questions

FactsOf = Callable[[list[Mapping[str, list[str]]]], Facts]


def count(asked: Requirements, measured: Measurements, facts: Facts) -> int:
    return int(recommend(asked, measured, facts=facts).question.matching_places.sum())


@pytest.mark.parametrize("number", [30, pytest.param(300, marks=pytest.mark.slow)])
def test_each_way_out_gives_what_it_says_and_no_smaller_one_is_left_out(
    number: int, survey: Facts, published: Measurements
) -> None:
    explained = 0
    for ask in drawn_questions(number, 21, survey):
        answer = recommend(ask, published)
        asked, blocked = answer.question.requirements, answer.explanation
        if blocked is None:
            continue
        explained += 1
        for way in blocked.relaxations:
            changed = asked.without(*way.drop)
            for name, value in way.change.items():
                changed = changed.with_value(name, value)
            assert count(changed, published, survey) == way.architectures > 0, (ask, way.words)
            for name in way.change.keys() & {"max_error_deg", "min_fov_deg"}:
                times = 0.999999 if name == "max_error_deg" else 1.000001
                stricter = min(times * way.change[name], 360.0)  # type: ignore[operator]
                if stricter != way.change[name]:
                    asks = asked.with_value(name, stricter)
                    assert not count(asks, published, survey), (ask, way.words)
        offered = {tuple(way.drop) for way in blocked.relaxations if way.drop}
        alone = {(n,) for n in asked.names if count(asked.without(n), published, survey)}
        if alone:
            assert offered == alone
        elif not offered:
            for pair in itertools.combinations(asked.names, 2):
                assert not count(asked.without(*pair), published, survey)
        most = max((way.architectures for way in blocked.relaxations if way.drop), default=0)
        assert not offered or blocked.relaxations[0].architectures == most
    assert explained > number / 10


def blocked_of(ask: Mapping[str, object], rows: list[object], facts: Facts) -> Explanation:
    answer = recommend(ask, rows, facts=facts)  # type: ignore[arg-type]
    assert answer.architectures == ()
    assert answer.explanation is not None
    return answer.explanation


def changes(blocked: Explanation) -> list[tuple[dict[str, object], int]]:
    return [(dict(one.change), one.architectures) for one in blocked.relaxations if one.change]


@pytest.mark.parametrize(
    ("ask", "numbers", "rows", "offered"),
    [
        ({"max_error_deg": 0.1}, {}, [{"rms_deg": 0.3}, {"rms_deg": 0.2}], 0.2),
        ({"min_fov_deg": 200.0}, {}, [{"half_fov_deg": 45.0}, {"half_fov_deg": 30.0}], 90.0),
        ({"min_fov_deg": 200.0}, {"fov_deg": "140"}, [{"half_fov_deg": 45.0}], 140.0),
        # rows that break another limit have nothing to offer
        ({"max_error_deg": 0.1, "min_fov_deg": 60.0}, {},
         [{"rms_deg": 0.3}, {"rms_deg": 0.2, "half_fov_deg": 20.0}], 0.3),
        # the better of what is reported and what is measured
        ({"max_error_deg": 0.1}, {"accuracy_deg": "0.15"}, [], 0.15),
        ({"max_error_deg": 0.1}, {"accuracy_deg": "0.15"}, [{"rms_deg": 0.2}], 0.15),
        ({"max_error_deg": 0.1}, {"accuracy_deg": "0.25"}, [{"rms_deg": 0.2}], 0.2),
        # a pipeline that seldom answers has no error that could be asked for
        ({"max_error_deg": 0.1}, {}, [{"is_available": False}, {"rms_deg": 0.9}], 0.9),
    ],
)  # fmt: skip
def test_a_limit_in_the_way_is_offered_at_the_strictest_that_is_kept(
    facts_of: FactsOf,
    ask: dict[str, float],
    numbers: dict[str, str],
    rows: list[dict[str, object]],
    offered: float,
) -> None:
    facts = facts_of([{**STUDY, **{name: [number] for name, number in numbers.items()}}])
    only = {"detector": "CMOS", "mask": "Slit"}
    measured = [pipeline(**{"model": str(at), **row}) for at, row in enumerate(rows)]
    blocked = blocked_of({**ask, **only}, measured, facts)
    name = next(iter(ask))
    assert (name,) in [tuple(way.drop) for way in blocked.relaxations]
    ((found,),) = (change.values() for change, _ in changes(blocked) if name in change)
    assert found == pytest.approx(offered, rel=1e-12)


def test_other_values_are_offered_by_how_many_they_give_and_five_at_most(survey: Facts) -> None:
    blocked = blocked_of({"mask": "V-Slit", "detector": "Event"}, [], survey)
    ways = [one.architectures for one in blocked.relaxations if "mask" in one.change]
    assert 0 < len(ways) <= MOST_CHANGES
    assert ways == sorted(ways, reverse=True)


def test_hazards_are_offered_less_one_and_two_that_must_go_are_named_together(
    facts_of: FactsOf,
) -> None:
    row = pipeline(hazards={"albedo": (Score("bad", 0.3),), "spin": (Score("spinning", None),)})
    only = {"detector": "CMOS", "mask": "Slit"}
    blocked = blocked_of({"tolerate": ["albedo", "spin"], **only}, [row], facts_of([STUDY]))
    assert ({"tolerate": ("albedo",)}, 1) in changes(blocked)
    assert "surviving albedo and spin" in blocked.detail
    ask = {"tolerate": ["spin"], "min_fov_deg": 180.0, **only}
    both = blocked_of(ask, [row], facts_of([STUDY]))
    assert both.constraints == ("min_fov_deg", "tolerate")
    assert len(both.relaxations) == 1
    assert "without them 1 architecture would" in both.detail


def test_a_bench_in_the_way_is_said_with_one_that_would_do(facts_of: FactsOf) -> None:
    ask = {"detector": "CMOS", "mask": "Slit", "max_error_deg": 0.2, "bench_deg": 0.5}
    detail = blocked_of(ask, [pipeline()], facts_of([STUDY])).detail
    named = re.search(r"bench of 0.5 deg stands in the way: one good to (\S+) deg would do", detail)
    assert named is not None
    better = recommend({**ask, "bench_deg": float(named[1])}, [pipeline()], facts=facts_of([STUDY]))
    assert len(better.architectures) == 1
