"""Recommendations: what brute force over studies and pipelines gives, in the order said."""

import itertools
import math
from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from registry.measured_pipelines import MeasuredPipeline, Measurements
from registry.recommendation import recommend
from registry.studies import Facts
from tests.registry.brute_force import (
    Ask,
    Found,
    Rows,
    asked,
    brute_force,
    finer,
    key_of,
    pipelines,
    rows,
)


@settings(deadline=None, derandomize=True, max_examples=250)
@given(table=rows, ask=asked, measured=pipelines)
def test_designs_errors_and_studies_are_those_brute_force_finds(
    facts_of: Callable[[Rows], Facts], table: Rows, ask: Ask, measured: list[MeasuredPipeline]
) -> None:
    facts = facts_of(table)
    answer = recommend(ask, measured, facts=facts)
    expected = brute_force(facts, ask, measured)
    found = {(a.detector, a.mask): a for a in answer.architectures}
    assert set(found) == set(expected.designs)
    assert answer.count == len(answer.architectures)
    assert answer.designs == sum(map(len, expected.designs.values()))
    assert (answer.blocking_constraint is None) == bool(found)
    for pair, architecture in found.items():
        designs = expected.designs[pair]
        assert set(architecture.studies) == expected.studies[pair]
        assert {key_of(one) for one in architecture.calibrations} == set(designs)
        assert architecture.count == len(architecture.calibrations) == len(designs)
        for one in architecture.calibrations:
            design = designs[key_of(one)]
            error = None if one.measured is None else one.measured["error_deg"]
            assert error == (None if design.error == math.inf else design.error)
            assert set(one.studies) == design.studies
            assert one.with_model == len(design.with_model)
        least = min((math.inf if d.error is None else d.error) for d in designs.values())
        best = architecture.best.measured
        assert (math.inf if best is None else best["error_deg"] or math.inf) == least


@settings(deadline=None, derandomize=True, max_examples=400)
@given(
    ask=asked.filter(lambda ask: not {"max_error_deg", "accuracy"} & set(ask)), measured=pipelines
)
def test_what_is_far_finer_where_it_answers_is_named_beside_each_measured_error(
    facts_of: Callable[[Rows], Facts], ask: Ask, measured: list[MeasuredPipeline]
) -> None:
    facts = facts_of([])
    for place in recommend(ask, measured, facts=facts).architectures:
        pair = (place.detector, place.mask)
        for one in (place.best, *place.calibrations):
            for shown in (one.measured, *one.other_datasets):
                if shown is None:
                    continue
                error = shown["error_deg"]
                expected = finer(pair, math.inf if error is None else error, ask, measured)
                named = shown["finer"]
                assert (tuple(named.values()) in expected) if named else not expected


@settings(deadline=None, derandomize=True, max_examples=100)
@given(table=rows, ask=asked, measured=pipelines, sort=st.sampled_from(["support", "measured"]))
def test_architectures_and_calibrations_stand_in_the_order_asked_for(
    facts_of: Callable[[Rows], Facts],
    table: Rows,
    ask: Ask,
    measured: list[MeasuredPipeline],
    sort: str,
) -> None:
    facts = facts_of(table)
    answer = recommend(ask, measured, sort=sort, facts=facts)  # type: ignore[arg-type]
    expected = brute_force(facts, ask, measured)

    def error(found: Found) -> float:
        return math.inf if found.error is None else found.error

    places = []
    for a in answer.architectures:
        designs = expected.designs[a.detector, a.mask]
        size = len(expected.studies[a.detector, a.mask])
        places.append((-size, min(map(error, designs.values()))))
        costs = []
        for one in a.calibrations:
            design = designs[key_of(one)]
            support = (size * len(design.with_model) * len(design.studies)) ** (1 / 3)
            assert one.support == pytest.approx(support, abs=5e-5)
            costs.append((-round(support, 9), error(design)))
        turned = sort == "measured"
        assert costs == sorted(costs, key=lambda cost: cost[::-1] if turned else cost)
        assert [one.rank for one in a.calibrations] == [*range(1, a.count + 1)]
    assert places == sorted(places, key=lambda cost: cost[::-1] if sort == "measured" else cost)
    assert [a.rank for a in answer.architectures] == [*range(1, answer.count + 1)]
    for a, cost in zip(answer.architectures, places, strict=True):
        others = [o for o in places if o != cost]
        assert a.pareto == (not any(o[0] <= cost[0] and o[1] <= cost[1] for o in others))
    again = recommend(ask, Measurements(reversed(measured)), sort=sort, limit=2, facts=facts)  # type: ignore[arg-type]
    assert list(again.architectures) == [*answer.architectures[:2]]
    assert all(again.document[n] == answer.document[n] for n in ("count", "nodes", "links"))


@settings(deadline=None, derandomize=True, max_examples=100)
@given(table=rows, ask=asked, measured=pipelines, sort=st.sampled_from(["advice", "measured"]))
def test_regret_is_the_first_calibrations_error_over_the_least_of_all(
    facts_of: Callable[[Rows], Facts],
    table: Rows,
    ask: Ask,
    measured: list[MeasuredPipeline],
    sort: str,
) -> None:
    facts = facts_of(table)
    answer = recommend(ask, measured, sort=sort, facts=facts)  # type: ignore[arg-type]
    designs = brute_force(facts, ask, measured).designs
    errors = [d.error for place in designs.values() for d in place.values() if d.error is not None]
    least = min(errors, default=math.inf)
    if math.isinf(least):
        assert answer.regret is None
        return
    assert answer.regret is not None
    first = answer.architectures[0].calibrations[0]
    error = first.measured and first.measured["error_deg"]
    assert answer.regret["best_deg"] == least
    assert answer.regret["first_deg"] == error
    assert answer.regret["ratio"] == (None if error is None else pytest.approx(error / least))
    if sort == "measured":
        assert answer.regret["ratio"] == 1.0


@settings(deadline=None, derandomize=True, max_examples=120)
@given(table=rows, ask=asked, measured=pipelines)
def test_relaxations_give_what_they_promise_and_nothing_smaller_does(
    facts_of: Callable[[Rows], Facts], table: Rows, ask: Ask, measured: list[MeasuredPipeline]
) -> None:
    facts = facts_of(table)
    answer = recommend(ask, measured, facts=facts)
    if answer.blocking_constraint is None:
        return
    blocked = answer.blocking_constraint
    for relaxation in blocked.relaxations:
        relaxed = recommend(relaxation.apply(answer.requirements), measured, facts=facts)
        assert relaxed.count == relaxation.architectures > 0
    assert tuple(blocked.relaxations[0].drop) == blocked.constraints
    for size in range(1, len(blocked.constraints) + 1):
        working = {
            names
            for names in itertools.combinations(answer.requirements.names, size)
            if recommend(answer.requirements.without(*names), measured, facts=facts).count
        }
        if size < len(blocked.constraints):
            assert not working
        else:
            offered = {tuple(r.drop) for r in blocked.relaxations if r.drop}
            assert offered <= working
            assert len(offered) == min(len(working), 10)


@settings(deadline=None, derandomize=True, max_examples=100)
@given(
    table=rows,
    measured=pipelines,
    limit=st.sampled_from(
        [("max_error_deg", 0.004), ("max_latency_us", 0.5), ("min_fov_deg", 360.0)]
    ),
)
def test_the_changed_limit_is_the_strictest_that_something_keeps(
    facts_of: Callable[[Rows], Facts],
    table: Rows,
    measured: list[MeasuredPipeline],
    limit: tuple[str, float],
) -> None:
    facts = facts_of(table)
    answer = recommend(dict([limit]), measured, facts=facts)
    changes = (
        [r for r in answer.blocking_constraint.relaxations if r.change]
        if answer.blocking_constraint
        else []
    )
    for relaxation in changes:
        ((name, bound),) = relaxation.change.items()
        assert isinstance(bound, float)
        stricter = math.nextafter(bound, 400.0 if name == "min_fov_deg" else 0.0)
        assert recommend({name: stricter}, measured, facts=facts).count == 0
