"""The rule of what the published leaderboard holds, and that workers who follow it at once obey."""

import dataclasses
import math

import fake_plan
import pytest
from fake_atlas import Currents, Diodes, LeastSquares
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmark.contract import ON_BENCH, Cell
from benchmark.leaderboard import scope
from benchmark.leaderboard.scope import BEHIND, CLOSE, LEADING, UNITS, UNITS_BEHIND
from benchmark.plan.combinations import cells
from benchmark.plan.parts import installed_parts
from benchmark.results.store import PUBLISHED, Store

NAMES = ("a", "b", "c")
MODELS = [
    type(name, (LeastSquares,), {"about": dataclasses.replace(LeastSquares.about, name=name)})
    for name in NAMES
]
EXTRACTORS = {
    name: type(name, (Currents,), {"about": dataclasses.replace(Currents.about, name=name)})
    for name in ("x", "y", "z")
}
PARTS = dataclasses.replace(
    fake_plan.parts(*MODELS, presets=(Diodes(conditions=("first", "second", "third")),)),
    extractors=EXTRACTORS,
)
PRESET = PARTS.presets["fake-diodes"]
PAIRS = [(extractor, model) for extractor in EXTRACTORS for model in NAMES]
NUMBERS = st.one_of(
    st.none(), st.tuples(st.sampled_from([0.1, 0.2, 0.5, 3.0]), st.sampled_from([0.5, 0.96, 1.0]))
)


def numbers(given):
    error, availability = given or (None, None)
    return {"rms_all_answers_deg": error, "availability": availability}


@settings(deadline=None, derandomize=True)
@given(st.lists(NUMBERS, min_size=9, max_size=9), st.sets(st.sampled_from(PAIRS), max_size=3))
def test_followers_are_the_leading_the_best_of_each_extractor_and_what_was_studied(given, used):
    scored = {
        Cell("fake-diodes", "first", *pair): numbers(one)
        for pair, one in zip(PAIRS, given, strict=True)
    }
    studied = {(PRESET.detector, PRESET.mask, *pair) for pair in used}
    found = scope.followers(scored, PARTS, studied)
    assert found == sorted(set(found))

    # by counting who is before whom, rather than by sorting
    def place(pair):
        one = given[PAIRS.index(pair)]
        return (one[1] < 0.95, one[0], pair) if one else (math.inf,)

    answering = [pair for pair in PAIRS if given[PAIRS.index(pair)]]
    before = {pair: [other for other in answering if place(other) < place(pair)] for pair in PAIRS}
    leading = {pair for pair in answering if len(before[pair]) < LEADING}
    best = {pair for pair in answering if not any(other[0] == pair[0] for other in before[pair])}
    units = dict.fromkeys(answering, 1)
    for pair in answering:
        error, share = given[PAIRS.index(pair)]
        first_error, first_share = given[PAIRS.index(min(answering, key=place))]
        if (share < 0.95) == (first_share < 0.95) and error <= BEHIND * first_error:
            units[pair] = UNITS if error <= CLOSE * first_error else UNITS_BEHIND
    assert {(c.extractor, c.model, c.unit) for c in found if c.unit and c.condition == "first"} == {
        (*pair, unit) for pair in answering for unit in range(1, units[pair])
    }
    assert {(c.extractor, c.model, c.unit) for c in found if c.condition == ON_BENCH} == {
        (*pair, unit) for pair in leading if units[pair] > 1 for unit in range(UNITS)
    }
    assert {c.condition for c in found if c.unit} <= {"first", ON_BENCH}
    silent_ones = {pair for pair in PAIRS if all(other[0] != pair[0] for other in answering)}
    usual = {model for _, model in leading}
    silent_ones = {pair for pair in silent_ones if pair[1] in usual or not usual}
    for condition in ("second", "third"):
        of_it = {(c.extractor, c.model) for c in found if c.condition == condition}
        assert of_it == leading | best | used | silent_ones


def test_studies_of_another_architecture_do_not_count():
    scored = {Cell("fake-diodes", "first", *pair): numbers((0.1, 1.0)) for pair in PAIRS}
    bare = scope.followers(scored, PARTS, set())
    elsewhere = {(PRESET.detector, "another mask", *pair) for pair in PAIRS}
    assert scope.followers(scored, PARTS, elsewhere) == bare
    assert len(bare) < len(
        scope.followers(scored, PARTS, {(PRESET.detector, PRESET.mask, *PAIRS[-1])})
    )


@pytest.mark.slow
def test_nothing_is_scored_twice_nor_outside_the_plan():
    scores, parts = Store(PUBLISHED).scores(), installed_parts()
    first, found, planned = scope.first(parts), scope.followers(scores, parts), cells(parts=parts)
    assert not set(first) & set(found)
    own = [cell for cell in (*first, *found) if cell.condition != ON_BENCH]
    assert {cell for cell in own if not cell.unit} <= set(planned)
    pairs = {(cell.dataset, cell.extractor, cell.model) for cell in first}
    assert pairs == {(cell.dataset, cell.extractor, cell.model) for cell in planned}
