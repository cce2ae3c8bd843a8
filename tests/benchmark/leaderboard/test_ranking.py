"""Ranks: by error among those that answer, and shared where units built alike disagree."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmark.leaderboard.board import at_field, build, within_error
from benchmark.leaderboard.ranking import Spread
from benchmark.metrics.rings import RINGS
from benchmark.metrics.score import METRICS


def row(model, rms, *, unit=0, condition="c", dataset="d", **more):
    return {
        "dataset": dataset, "condition": condition, "extractor": "e", "model": model, "unit": unit,
        "dataset_version": 1, "detector": "PD", "mask": "M", "half_fov_deg": None,
        **dict.fromkeys(METRICS), "rms_deg": rms, "availability": 1.0, **more,
    }  # fmt: skip


def ranked(rows, dataset=0):
    """Give (rank, tied, model) of the rows of a board, in order."""
    return [(r["rank"], r["tied"], r["model"]) for r in build(rows)["datasets"][dataset]["rows"]]


def units(model, *errors, **more):
    return [row(model, error, unit=number, **more) for number, error in enumerate(errors)]


def test_rows_are_ranked_by_error_within_dataset_and_condition():
    rows = [
        row("a", 2.0),
        row("b", None),
        row("c", 1.0),
        row("d", 3.0, condition="b"),
        row("e", 9.0, condition="b", dataset="a"),
    ]
    board = build(rows, {("d", "e", "a"): {"latency_us": 5.0, "time_ratio": 4.0}})
    assert [d["name"] for d in board["datasets"]] == ["a", "d"]
    assert board["datasets"][1]["conditions"] == ["b", "c"]
    found = [(r["condition"], r["rank"], r["model"]) for r in board["datasets"][1]["rows"]]
    assert found == [("b", 1, "d"), ("c", 1, "c"), ("c", 2, "a"), ("c", None, "b")]
    timed = [(r["latency_us"], r["time_ratio"]) for r in board["datasets"][1]["rows"]]
    assert timed == [(None, None), (None, None), (5.0, 4.0), (None, None)]


def test_the_nominal_condition_stands_first_and_the_others_by_name():
    rows = [row("m", 1.0, condition=name) for name in ("z", "nominal", "a")]
    (dataset,) = build(rows)["datasets"]
    assert dataset["conditions"] == ["nominal", "a", "z"]
    assert [r["condition"] for r in dataset["rows"]] == ["nominal", "a", "z"]
    assert [r["condition"] for r in at_field(dataset["rows"], 10)] == ["nominal", "a", "z"]


def test_a_pipeline_that_answers_less_than_95_percent_is_behind_all_that_answer_more():
    rows = [
        row("silent", 0.001, availability=0.9499),
        row("bad", 50.0, availability=0.95),
        row("good", 1.0),
        row("nothing", None, availability=0.0),
        row("unseen", 0.01, availability=None),
    ]
    assert ranked(rows) == [
        (1, False, "good"),
        (2, False, "bad"),
        (3, False, "silent"),
        (4, False, "unseen"),
        (None, False, "nothing"),
    ]


@settings(deadline=None, derandomize=True)
@given(
    st.lists(
        st.tuples(
            st.none() | st.floats(0.0, 10.0), st.none() | st.sampled_from([0.0, 0.94, 0.95, 1.0])
        ),
        max_size=12,
    )
)
def test_no_silent_pipeline_is_before_an_available_one_whatever_the_errors(values):
    rows = [row(f"m{n:02}", rms, availability=share) for n, (rms, share) in enumerate(values)]
    if not rows:
        assert build(rows)["datasets"] == []
        return
    (dataset,) = build(rows)["datasets"]
    listed = [r for r in dataset["rows"] if r["rank"] is not None]
    assert len(listed) == sum(rms is not None for rms, _ in values)
    available = [(r["availability"] or 0.0) >= 0.95 for r in listed]
    assert available == sorted(available, reverse=True)
    for kind in (True, False):
        errors = [r["rms_deg"] for r, one in zip(listed, available, strict=True) if one is kind]
        assert errors == sorted(errors)


def test_equals_stand_by_the_names_of_extractor_and_model_whatever_the_order():
    rows = [
        row("b", 1.0, extractor="e"),
        row("a", 1.0, extractor="f"),
        row("a", 1.0, extractor="e"),
        row("z", 0.0, extractor="z"),  # no error is not an error of none
        row("c", None, extractor="a"),
    ]
    for order in (rows, rows[::-1]):
        (dataset,) = build(order)["datasets"]
        found = [(r["rank"], r["extractor"], r["model"]) for r in dataset["rows"]]
        assert found == [
            (1, "z", "z"), (2, "e", "a"), (4, "f", "a"), (3, "e", "b"), (None, "a", "c"),
        ]  # fmt: skip
        assert [r["model"] for r in at_field(dataset["rows"], 10)] == ["c", "a", "b", "a", "z"]


def test_the_best_pipeline_of_each_extractor_stands_before_all_others():
    """Ranks stay those of all pipelines; an extractor without an error has no best one."""
    rows = [
        row("a", 1.0, extractor="e", rms_0_10_deg=4.0),
        row("b", 2.0, extractor="e", rms_0_10_deg=3.0),
        row("a", 3.0, extractor="f", rms_0_10_deg=2.0),
        row("b", 4.0, extractor="f", rms_0_10_deg=1.0),
        row("a", 0.5, extractor="g", availability=0.5),
        row("a", None, extractor="h"),
    ]
    (dataset,) = build(rows)["datasets"]

    def listed(found):
        return [(r["rank"], r["extractor"], r["model"], r["best_of_extractor"]) for r in found]

    assert listed(dataset["rows"]) == [
        (1, "e", "a", True),
        (3, "f", "a", True),
        (5, "g", "a", True),
        (2, "e", "b", False),
        (4, "f", "b", False),
        (None, "h", "a", False),
    ]
    assert listed(at_field(dataset["rows"], 10)) == [
        (1, "f", "b", True),
        (3, "e", "b", True),
        (2, "f", "a", False),
        (4, "e", "a", False),
        (None, "h", "a", False),
        (None, "g", "a", False),
    ]
    found = listed(within_error(dataset["rows"], 3.5))
    assert found[:3] == [(1, "e", "b", True), (2, "f", "a", True), (3, "f", "b", False)]


def test_studies_stand_beside_the_pipelines_that_they_used_on_that_architecture():
    rows = [row("a", 1.0), row("b", 2.0), row("a", 1.0, dataset="other", mask="N")]
    studied = {("PD", "M", "e", "a"): ("Bao2001", "Chi2002"), ("CCD", "M", "e", "b"): ("Du2003",)}
    found = {
        (r["dataset"], r["model"]): r["studies"]
        for dataset in build(rows, studied=studied)["datasets"]
        for r in dataset["rows"]
    }
    assert found == {("d", "a"): ["Bao2001", "Chi2002"], ("d", "b"): [], ("other", "a"): []}


def test_ranks_are_shared_where_the_units_of_two_overlap():
    """The third is behind both; its rank is its place."""
    rows = [
        *units("a", 1.0, 1.4, 0.9),
        *units("b", 1.2, 1.1, 1.9),
        *units("c", 2.0, 2.1, 2.2),
    ]
    assert ranked(rows) == [(1, True, "a"), (1, True, "b"), (3, False, "c")]


def test_a_group_is_of_those_that_overlap_its_first_not_its_last():
    """Else a chain of overlaps would tie the best with what is worse on every unit."""
    rows = [
        *units("a", 1.0, 1.2),
        *units("b", 1.1, 1.6),
        *units("c", 1.5, 1.9),
        *units("d", 1.7, 2.5),
        *units("e", 3.0, 3.1),
    ]
    assert ranked(rows) == [
        (1, True, "a"),
        (1, True, "b"),
        (3, True, "c"),
        (3, True, "d"),
        (5, False, "e"),
    ]


def test_spreads_that_touch_overlap():
    assert Spread((1.0, 2.0)).overlaps(Spread((2.0, 3.0)))
    assert not Spread((1.0, 2.0)).overlaps(Spread((2.0001, 3.0)))


def test_a_unit_without_an_error_leaves_the_spread_open():
    """Nothing is known of that unit, so nothing of the order either."""
    open_spread = Spread((3.0, None, 3.1))
    assert (open_spread.low_deg, open_spread.high_deg) == (0.0, math.inf)
    assert open_spread.overlaps(Spread((1.0, 1.1)))
    assert open_spread.overlaps(Spread((99.0, 100.0)))
    (dataset,) = build([*units("a", 1.0, 1.1), *units("b", 3.0, None)])["datasets"]
    assert [(r["rank"], r["tied"]) for r in dataset["rows"]] == [(1, True), (1, True)]
    told = [(r["unit_rms_deg"], r["low_deg"], r["high_deg"]) for r in dataset["rows"]]
    assert told == [([1.0, 1.1], 1.0, 1.1), ([3.0, None], None, None)]


def test_what_was_scored_on_one_unit_alone_has_a_rank_of_its_own():
    rows = [*units("a", 1.0, 2.0), row("b", 1.1), *units("c", 1.2, 1.3)]
    assert ranked(rows) == [(1, False, "a"), (2, False, "b"), (3, False, "c")]
    (dataset,) = build(rows)["datasets"]
    assert [r["unit_rms_deg"] for r in dataset["rows"]] == [[1.0, 2.0], None, [1.2, 1.3]]
    assert dataset["rows"][1]["low_deg"] is dataset["rows"][1]["high_deg"] is None


def test_one_that_answers_shares_no_rank_with_one_that_does_not():
    rows = [*units("a", 1.0, 1.4), *units("b", 1.1, 1.2, availability=0.9)]
    assert ranked(rows) == [(1, False, "a"), (2, False, "b")]
    both = [*units("a", 1.0, 1.4, availability=0.9), *units("b", 1.1, 1.2, availability=0.8)]
    assert ranked(both) == [(1, True, "a"), (1, True, "b")]


def test_the_errors_of_units_stand_in_their_order_whatever_the_rows():
    rows = [row("a", rms, unit=unit) for unit, rms in ((3, 0.3), (0, 0.0), (10, 1.0), (1, 0.1))]
    (dataset,) = build(rows)["datasets"]
    (found,) = dataset["rows"]
    assert (found["unit"], found["unit_rms_deg"]) == (0, [0.0, 0.1, 0.3, 1.0])


@settings(deadline=None, derandomize=True)
@given(
    st.lists(
        st.none() | st.lists(st.floats(0.0, 4.0), min_size=2, max_size=3), min_size=1, max_size=8
    )
)
def test_ranks_never_fall_and_say_how_many_are_before_the_group(errors):
    rows = []
    for number, some in enumerate(errors):
        rows += units(f"m{number}", *(some or [float(number)]))
    found = ranked(rows)
    numbers = [rank for rank, *_ in found]
    assert numbers == sorted(numbers)
    for place, (rank, tied, _) in enumerate(found):
        assert rank == 1 + sum(other < rank for other in numbers)
        assert rank <= place + 1
        assert tied == (numbers.count(rank) > 1)


def by_rings(model, *errors, **more):
    rings = {
        ring.column: error for ring, error in zip(RINGS, [*errors, *[None] * 9][:9], strict=True)
    }
    return row(model, 0.5, **{**more, **rings})


def test_at_an_equal_field_ranks_are_by_the_error_over_it():
    """Best at the centre is not best over the wide field, and one is blind out there."""
    rows = build(
        [
            by_rings("narrow", 0.1, 5.0),
            by_rings("wide", 0.2, 0.3),
            by_rings("blind", 0.05),
            by_rings("silent", 0.01, 0.01, availability=0.5),
        ]
    )["datasets"][0]["rows"]

    def listed(half_angle):
        return [(r["rank"], r["model"]) for r in at_field(rows, half_angle)]

    assert listed(10) == [(1, "blind"), (2, "narrow"), (3, "wide"), (4, "silent")]
    assert listed(20) == [(1, "wide"), (2, "narrow"), (3, "silent"), (None, "blind")]
    found = at_field(rows, 10)
    assert [r["field_rms_deg"] for r in found] == pytest.approx([0.05, 0.1, 0.2, 0.01])
    assert {r["field_deg"] for r in found} == {10}
    with pytest.raises(ValueError, match="edge"):
        at_field(rows, 15)


def test_ranks_at_a_field_are_of_each_board_and_not_shared():
    rows = build(
        [
            *units("a", 1.0, 2.0, rms_0_10_deg=0.2),
            *units("b", 1.1, 1.9, rms_0_10_deg=0.1),
            row("z", 1.0, condition="other", rms_0_10_deg=0.3),
        ]
    )["datasets"][0]["rows"]
    assert [r["tied"] for r in rows] == [True, True, False]
    found = [(r["condition"], r["rank"], r["tied"], r["model"]) for r in at_field(rows, 10)]
    assert found == [
        ("c", 1, False, "b"),
        ("c", 2, False, "a"),
        ("other", 1, False, "z"),
    ]


def test_a_sensor_has_no_error_over_a_wider_field_than_its_own():
    """Directions drawn over a square of two angles reach further in its corners alone."""
    rings = {"rms_0_10_deg": 0.1, "rms_10_20_deg": 0.1, "rms_20_30_deg": 0.1}
    rows = [row("square", 0.1, half_fov_deg=20.0, **rings), row("sphere", 0.1, **rings)]
    assert [r["field_rms_deg"] for r in at_field(rows, 20)] == pytest.approx([0.1, 0.1])
    at_thirty = {r["model"]: (r["field_rms_deg"], r["rank"]) for r in at_field(rows, 30)}
    assert at_thirty["square"] == (None, None)
    assert at_thirty["sphere"] == (pytest.approx(0.1), 1)
    found = {r["model"]: r["widest_field_deg"] for r in within_error(rows, 0.1)}
    assert found == {"square": 20, "sphere": 30}


def test_ranks_by_the_field_that_keeps_an_error():
    rows = [
        row("wide", 0.4, rms_0_10_deg=0.4, rms_10_20_deg=0.4),
        row("sharp", 0.1, rms_0_10_deg=0.1, rms_10_20_deg=0.6),
        row("sharper", 0.05, rms_0_10_deg=0.05, rms_10_20_deg=0.7),
        row("silent", 0.01, rms_0_10_deg=0.01, rms_10_20_deg=0.01, availability=0.9),
        row("off", 3.0, rms_0_10_deg=3.0, rms_10_20_deg=0.1),
    ]
    found = [(r["rank"], r["model"], r["widest_field_deg"]) for r in within_error(rows, 0.5)]
    assert found == [
        (1, "wide", 20),
        (2, "sharper", 10),
        (3, "sharp", 10),
        (None, "off", None),
        (None, "silent", None),
    ]
