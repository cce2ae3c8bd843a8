"""Why nothing meets what is asked, and the least that must give way, case by case."""

import re
from collections.abc import Callable, Mapping

import pytest
from scores import STUDY, pipeline

from registry.measured_pipelines import Score
from registry.recommendation import Recommendation, recommend
from registry.relaxation import MOST_CHANGES, BlockingConstraint
from registry.studies import Facts

Rows = list[Mapping[str, list[str]]]


def untold(blocked: BlockingConstraint) -> str:
    """Return what a refusal says, in a sentence of its own, that no study or measurement tells."""
    return blocked.detail.partition(". ")[2]


def test_a_limit_nothing_tells_of_says_so(survey: Facts) -> None:
    answer = recommend({"task": "Accuracy", "max_latency_us": 5}, facts=survey)
    assert answer.blocking_constraint is not None
    assert answer.blocking_constraint.constraint == "max_latency_us"
    assert re.search(r"\b5 us\b", untold(answer.blocking_constraint))


def test_an_impossible_question_names_the_constraint_and_ways_out(survey: Facts) -> None:
    ask = {"task": ["Accuracy"], "detector": ["Event"], "mask": ["V-Slit"]}
    answer = recommend(ask, facts=survey).document
    assert answer["paths"] == answer["nodes"] == answer["links"] == answer["architectures"] == []
    blocked = answer["blocked"]
    assert isinstance(blocked, dict)
    assert blocked["constraint"] == "mask"
    assert {
        "constraint": "mask",
        "drop": {"mask": ["V-Slit"]},
        "architectures": 1,
        "words": "drop mask V-Slit",
    } in blocked["relaxations"]
    assert {
        "constraint": "mask",
        "change": {"mask": ["L-Slit"]},
        "architectures": 1,
        "words": "ask instead for mask L-Slit",
    } in blocked["relaxations"]


def test_no_studies_is_no_one_constraints_fault(facts_of: Callable[[Rows], Facts]) -> None:
    answer = recommend({"task": "Cost"}, facts=facts_of([]))
    assert answer.blocking_constraint is not None
    assert answer.blocking_constraint.constraints == ()
    assert answer.blocking_constraint.relaxations == ()


#: An error, a field and a time that the questions below are beyond.
MEASURED: Mapping[str, object] = {"rms_deg": 0.2, "half_fov_deg": 30.0, "latency_us": 8.0}


def blocked_of(answer: Recommendation) -> BlockingConstraint:
    assert answer.blocking_constraint is not None
    assert answer.count == 0
    return answer.blocking_constraint


def changes(blocked: BlockingConstraint) -> list[tuple[dict[str, object], int]]:
    return [(dict(one.change), one.architectures) for one in blocked.relaxations if one.change]


@pytest.mark.parametrize(
    ("asked", "numbers", "rows", "offered"),
    [
        # the best of what was measured, in the limit's own direction
        ({"max_error_deg": 0.1}, {}, [{"rms_deg": 0.3}, {"dataset": "e"}], 0.2),
        ({"min_fov_deg": 200.0}, {}, [{"half_fov_deg": 45.0}, {"dataset": "e"}], 90.0),
        ({"max_latency_us": 1.0}, {}, [{"latency_us": 9.0}, {"dataset": "e"}], 8.0),
        # rows that break another limit have nothing to offer
        (
            {"max_error_deg": 0.1, "max_latency_us": 5.0},
            {},
            [{"rms_deg": 0.7, "latency_us": 5.0}, {"rms_deg": 0.2}],
            0.7,
        ),
        ({"max_error_deg": 0.1, "min_fov_deg": 60.0}, {}, [{"rms_deg": 0.3}], 0.3),
        # what is stated counts where nothing was measured, and there alone
        ({"max_error_deg": 0.1}, {"accuracy_deg": "0.15"}, [], 0.15),
        ({"max_error_deg": 0.1}, {"accuracy_deg": "0.15"}, [{}], 0.2),
        (
            {"min_fov_deg": 200.0},
            {"fov_deg": "120"},
            [{"dataset": "e", "half_fov_deg": None}],
            None,
        ),
        # a pipeline that seldom answers has no error that could be asked for
        ({"max_error_deg": 0.1}, {}, [{"is_available": False}, {"rms_deg": 0.9}], 0.9),
        ({"max_error_deg": 0.1}, {}, [{"is_available": False}], None),
        ({"max_latency_us": 5.0}, {}, [{"latency_us": None}], None),
    ],
)
def test_a_limit_in_the_way_is_offered_at_the_strictest_that_is_kept(
    facts_of: Callable[[Rows], Facts],
    asked: dict[str, float],
    numbers: dict[str, str],
    rows: list[dict[str, object]],
    offered: float | None,
) -> None:
    facts = facts_of([{**STUDY, **{name: [number] for name, number in numbers.items()}}])
    measured = [pipeline(**{**MEASURED, "model": str(at), **row}) for at, row in enumerate(rows)]
    blocked = blocked_of(recommend(asked, measured, facts=facts))
    name = next(iter(asked))
    assert blocked.constraints == (name,)
    expected = [] if offered is None else [({name: offered}, 1)]
    assert changes(blocked) == expected


def test_a_limit_is_offered_of_the_studies_that_keep_the_others(
    facts_of: Callable[[Rows], Facts],
) -> None:
    """The most accurate is too narrow: what it states is no way out."""
    facts = facts_of(
        [
            {**STUDY, "accuracy_deg": ["0.01"], "fov_deg": ["60"]},
            {**STUDY, "accuracy_deg": ["0.5"], "fov_deg": ["120"]},
            {**STUDY, "accuracy_deg": ["0.7"], "fov_deg": ["140"]},
        ]
    )
    blocked = blocked_of(recommend({"max_error_deg": 0.1, "min_fov_deg": 120.0}, facts=facts))
    assert blocked.constraints == ("max_error_deg",)  # of equals the first that can be asked
    assert ({"max_error_deg": 0.5}, 1) in changes(blocked)
    assert ({"min_fov_deg": 60.0}, 1) in changes(blocked)
    assert len(changes(blocked)) == 2


def test_other_values_are_offered_by_how_many_they_give_and_five_at_most(
    survey: Facts, facts_of: Callable[[Rows], Facts]
) -> None:
    masks = [mask for mask in survey.taxonomy.values("mask") if mask != "Lens"]
    table = [{**STUDY, "mask": [mask]} for mask in masks]
    table += [{**STUDY, "mask": [masks[3]], "detector": [one]} for one in ("CCD", "PDA")]
    table += [{**STUDY, "mask": [masks[-1]], "detector": ["CCD"]}]
    blocked = blocked_of(recommend({"mask": "Lens"}, facts=facts_of(table)))
    found = [(change["mask"], number) for change, number in changes(blocked)]
    assert found[:2] == [((masks[3],), 3), ((masks[-1],), 2)]
    assert [number for _, number in found] == [3, 2, 1, 1, 1]
    assert len(found) == MOST_CHANGES == 5
    every = len(masks) + 3
    assert blocked.relaxations[0].architectures == every
    assert blocked.detail == (f"nothing meets mask Lens; without it {every} architectures would")


def test_values_excluded_are_offered_back_one_by_one(
    facts_of: Callable[[Rows], Facts],
) -> None:
    facts = facts_of(
        [STUDY, {**STUDY, "mask": ["Lens"]}, {**STUDY, "mask": ["Lens"], "detector": ["CCD"]}]
    )
    blocked = blocked_of(recommend({"exclude_mask": ["Slit", "Lens"]}, facts=facts))
    assert changes(blocked) == [
        ({"exclude_mask": ("Slit",)}, 2),
        ({"exclude_mask": ("Lens",)}, 1),
    ]
    assert re.findall(r"mask|Slit|Lens|\d+", blocked.detail) == ["mask", "Slit", "Lens", "3"]
    ask = {"exclude_detector": ["CMOS"], "exclude_mask": ["Slit"], "detector": ["CMOS", "CCD"]}
    alone = blocked_of(recommend({**ask, "mask": "Slit"}, facts=facts))
    assert {"exclude_mask": ()} not in [change for change, _ in changes(alone)]
    only = blocked_of(recommend({"exclude_detector": ["CMOS", "CCD"]}, facts=facts))
    assert [one.words for one in only.relaxations] == [
        "drop no detector CMOS or CCD",
        "ask instead for no detector CCD",
        "ask instead for no detector CMOS",
    ]


@pytest.mark.parametrize(
    "ask",
    [
        {"mask": "Lens"},
        {"exclude_mask": ["Slit", "N-Slit"]},
        {"max_error_deg": 0.1, "min_fov_deg": 120.0},
        {"mask": "Lens", "detector": "CCD"},
    ],
)
def test_each_way_out_gives_as_many_architectures_as_it_says(
    ask: Mapping[str, object], facts_of: Callable[[Rows], Facts]
) -> None:
    facts = facts_of([STUDY, {**STUDY, "mask": ["N-Slit"], "detector": ["PDA"]}])
    rows = [pipeline(rms_deg=0.2, cones=((20.0, 0.05),))]
    answer = recommend(ask, rows, facts=facts)
    ways = blocked_of(answer).relaxations
    assert ways
    for one in ways:
        relaxed = one.apply(answer.requirements)
        assert recommend(relaxed, rows, facts=facts).count == one.architectures > 0


def test_hazards_and_properties_are_offered_less_one(
    survey: Facts, facts_of: Callable[[Rows], Facts]
) -> None:
    bad = (Score("bad", 0.3),)
    row = pipeline(hazards={"albedo": bad, "spin": (Score("spinning", None),)})
    facts = facts_of([STUDY])
    blocked = blocked_of(recommend({"survive": ["albedo", "spin"]}, [row], facts=facts))
    assert re.findall(r"albedo|spin|\d+", blocked.detail) == ["albedo", "spin", "1"]
    assert untold(blocked) == ""
    assert changes(blocked) == [({"survive": ("albedo",)}, 1)]
    untried = blocked_of(recommend({"survive": ["glare"]}, [row], facts=facts))
    assert "glare" in untold(untried)
    marks = survey.properties
    names = [n for n in marks if not marks[n].get("FEIC", 0)][:1]
    names += [n for n in marks if marks[n].get("FEIC", 0)][:1]
    ask = {"extractor": "FEIC", "properties": names}
    blocked = blocked_of(recommend(ask, facts=survey))
    assert {"properties": (names[1],)} in [change for change, _ in changes(blocked)]


def test_a_hazard_and_an_error_that_exclude_each_other_are_each_a_way_out(
    facts_of: Callable[[Rows], Facts],
) -> None:
    """An error is judged under the hazards asked for: either may give way, and by how much."""
    row = pipeline(rms_deg=0.1, hazards={"albedo": (Score("albedo", 0.8),)})
    ask = {"max_error_deg": 0.2, "survive": "albedo"}
    blocked = blocked_of(recommend(ask, [row], facts=facts_of([STUDY])))
    ways = [one.to_dict() for one in blocked.relaxations]
    words = [way.pop("words") for way in ways]
    assert [re.findall(r"drop|albedo|[\d.]+ deg", said) for said in words] == [
        ["drop", "0.2 deg"],
        ["drop", "albedo"],
        ["0.8 deg"],
    ]
    assert ways == [
        {"constraint": "max_error_deg", "drop": {"max_error_deg": 0.2}, "architectures": 1},
        {"constraint": "survive", "drop": {"survive": ["albedo"]}, "architectures": 1},
        {"constraint": "max_error_deg", "change": {"max_error_deg": 0.8}, "architectures": 1},
    ]


def test_an_error_is_offered_at_the_field_that_keeps_it(
    facts_of: Callable[[Rows], Facts],
) -> None:
    row = pipeline(rms_deg=0.5, cones=((20.0, 0.01), (30.0, 0.05), (60.0, 0.5)))
    ask = {"max_error_deg": 0.1, "min_fov_deg": 100.0}
    blocked = blocked_of(recommend(ask, [row], facts=facts_of([STUDY])))
    assert ({"min_fov_deg": 60.0}, 1) in changes(blocked)
    assert ({"max_error_deg": 0.5}, 1) in changes(blocked)


def test_of_several_ways_out_the_one_that_gives_most_is_first(
    facts_of: Callable[[Rows], Facts],
) -> None:
    facts = facts_of(
        [STUDY, {**STUDY, "detector": ["PD"], "mask": ["Lens"]}, {**STUDY, "mask": ["Encoded"]}]
    )
    blocked = blocked_of(recommend({"detector": "CMOS", "mask": "Lens"}, facts=facts))
    assert blocked.constraints == ("mask",)
    assert [(one.constraint, one.architectures) for one in blocked.relaxations[:2]] == [
        ("mask", 2),
        ("detector", 1),
    ]
    found = re.findall(r"mask|Lens|detector|CMOS|\d+", blocked.detail)
    assert found == ["mask", "Lens", "2"]


def test_two_that_must_go_together_are_named_together(
    facts_of: Callable[[Rows], Facts],
) -> None:
    ask = {"detector": "PD", "mask": "Lens", "max_error_deg": 0.25, "task": "Cost"}
    facts = facts_of([{**STUDY, "accuracy_deg": ["0.25"]}])
    blocked = blocked_of(recommend(ask, facts=facts))
    assert blocked.constraint == "detector + mask"
    found = re.findall(r"detector|PD|mask|Lens|\d+", blocked.detail)
    assert found == ["detector", "PD", "mask", "Lens", "1"]
    assert [one.to_dict() for one in blocked.relaxations] == [
        {
            "constraint": "detector + mask",
            "drop": {"detector": ["PD"], "mask": ["Lens"]},
            "architectures": 1,
            "words": "drop detector PD and mask Lens",
        }
    ]


def test_what_nothing_tells_of_is_said_of_that_alone(
    facts_of: Callable[[Rows], Facts],
) -> None:
    plain = facts_of([STUDY])
    both = blocked_of(recommend({"max_error_deg": 1.0, "min_fov_deg": 10.0}, facts=plain))
    assert re.findall(r"[\d.]+ deg", untold(both)) == ["1 deg", "10 deg"]
    stated = facts_of([{**STUDY, "accuracy_deg": ["2"]}])
    assert not untold(blocked_of(recommend({"max_error_deg": 1.0}, facts=stated)))
    rows = [pipeline(rms_deg=2.0)]
    assert not untold(blocked_of(recommend({"max_error_deg": 1.0}, rows, facts=plain)))
    assert untold(blocked_of(recommend({"max_error_deg": 1.0}, facts=plain)))
    assert not untold(blocked_of(recommend({"mask": "Lens"}, facts=plain)))


def test_a_class_of_accuracy_is_named_where_what_is_measured_is_coarser(
    facts_of: Callable[[Rows], Facts],
) -> None:
    """UFSS is 10 arcseconds, 0.0028 deg."""
    facts = facts_of([{**STUDY, "accuracy": ["UFSS"]}])
    blocked = blocked_of(recommend({"accuracy": "UFSS"}, [pipeline(rms_deg=0.01)], facts=facts))
    assert blocked.constraint == "accuracy"
    assert re.findall(r"UFSS|\d+", blocked.detail) == ["UFSS", "1"]
    finer = recommend({"accuracy": "UFSS"}, [pipeline(rms_deg=0.0027)], facts=facts)
    assert finer.blocking_constraint is None
