"""Why no path meets what is asked, and the least that must give way, case by case."""

from collections.abc import Callable, Mapping

import pytest

from registry.measured import Measured
from registry.recommendation import Recommendation, recommend
from registry.relaxation import MOST_CHANGES, Blocked
from registry.studies import Facts

Rows = list[Mapping[str, list[str]]]
PATH = {
    "task": ["Cost"],
    "detector": ["CMOS"],
    "mask": ["Slit"],
    "model": ["SPM"],
    "extractor": ["BCTM"],
}


def test_a_limit_nothing_tells_of_says_so(survey: Facts) -> None:
    answer = recommend({"task": "Accuracy", "max_latency_us": 5}, facts=survey)
    assert answer.blocked is not None
    assert answer.blocked.constraint == "max_latency_us"
    assert "Nothing measured or stated tells of max_latency_us" in answer.blocked.detail


def test_an_impossible_question_names_the_constraint_and_ways_out(survey: Facts) -> None:
    ask = {"task": ["Accuracy"], "detector": ["Event"], "mask": ["V-Slit"]}
    answer = recommend(ask, facts=survey).to_dict()
    assert answer["paths"] == answer["nodes"] == answer["links"] == []
    blocked = answer["blocked"]
    assert isinstance(blocked, dict)
    assert blocked["constraint"] == "mask"
    assert {"constraint": "mask", "drop": {"mask": ["V-Slit"]}, "paths": 1} in blocked[
        "relaxations"
    ]
    assert {"constraint": "mask", "change": {"mask": ["L-Slit"]}, "paths": 1} in blocked[
        "relaxations"
    ]


def test_no_studies_is_no_one_constraints_fault(facts_of: Callable[[Rows], Facts]) -> None:
    answer = recommend({"task": "Cost"}, facts=facts_of([]))
    assert answer.blocked is not None
    assert answer.blocked.constraints == ()
    assert answer.blocked.relaxations == ()


def score(**changed: object) -> Measured:
    row: dict[str, object] = {
        "dataset": "d", "condition": "nominal", "detector": "CMOS", "mask": "Slit",
        "extractor": "bctm", "extractor_taxonomy": "BCTM", "model": "spm",
        "model_taxonomy": "SPM", "rms_deg": 0.2, "half_fov_deg": 30.0, "latency_us": 8.0,
    }  # fmt: skip
    return Measured(**{**row, **changed})  # type: ignore[arg-type]


def blocked_of(answer: Recommendation) -> Blocked:
    assert answer.blocked is not None
    assert answer.count == 0
    return answer.blocked


def changes(blocked: Blocked) -> list[tuple[dict[str, object], int]]:
    return [(dict(one.change), one.paths) for one in blocked.relaxations if one.change]


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
        ({"min_fov_deg": 200.0}, {"fov_deg": "120"}, [{"half_fov_deg": None}], 120.0),
        # a pipeline that seldom answers has no error that could be asked for
        ({"max_error_deg": 0.1}, {}, [{"available": False}, {"rms_deg": 0.9}], 0.9),
        ({"max_error_deg": 0.1}, {}, [{"available": False}], None),
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
    facts = facts_of([{**PATH, **{name: [number] for name, number in numbers.items()}}])
    measured = [score(**row) for row in rows]
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
            {**PATH, "accuracy_deg": ["0.01"], "fov_deg": ["60"]},
            {**PATH, "accuracy_deg": ["0.5"], "fov_deg": ["120"]},
            {**PATH, "accuracy_deg": ["0.7"], "fov_deg": ["140"]},
        ]
    )
    blocked = blocked_of(recommend({"max_error_deg": 0.1, "min_fov_deg": 120.0}, facts=facts))
    assert blocked.constraints == ("max_error_deg",)  # of equals the first that can be asked
    assert ({"max_error_deg": 0.5}, 1) in changes(blocked)
    assert ({"min_fov_deg": 60.0}, 1) in changes(blocked)
    assert len(changes(blocked)) == 2


def test_other_values_are_offered_by_how_many_paths_they_give_and_five_at_most(
    survey: Facts, facts_of: Callable[[Rows], Facts]
) -> None:
    masks = [mask for mask in survey.taxonomy.values("mask") if mask != "Lens"]
    extractors = ["BCTM", "BCM", "Direct"]
    table = [{**PATH, "mask": [mask]} for mask in masks]
    table += [{**PATH, "mask": [masks[3]], "extractor": [one]} for one in extractors]
    table += [{**PATH, "mask": [masks[-1]], "extractor": ["Direct"]}]
    blocked = blocked_of(recommend({"mask": "Lens"}, facts=facts_of(table)))
    found = [(change["mask"], paths) for change, paths in changes(blocked)]
    assert found[:2] == [((masks[3],), 3), ((masks[-1],), 2)]
    assert [paths for _, paths in found] == [3, 2, 1, 1, 1]
    assert len(found) == MOST_CHANGES == 5
    assert blocked.relaxations[0].paths == len(masks) + 3
    assert blocked.detail == f"no path meets mask = Lens; without it {len(masks) + 3} would"


def test_values_excluded_are_offered_back_one_by_one(
    facts_of: Callable[[Rows], Facts],
) -> None:
    facts = facts_of(
        [PATH, {**PATH, "mask": ["Lens"]}, {**PATH, "mask": ["Lens"], "model": ["LUT"]}]
    )
    blocked = blocked_of(recommend({"exclude_mask": ["Slit", "Lens"]}, facts=facts))
    assert changes(blocked) == [
        ({"exclude_mask": ("Slit",)}, 2),
        ({"exclude_mask": ("Lens",)}, 1),
    ]
    assert blocked.detail == "no path meets exclude_mask = Slit or Lens; without it 3 would"
    alone = blocked_of(recommend({"exclude_detector": "CMOS"}, facts=facts))
    assert changes(alone) == []  # none left to exclude is dropping it
    assert [one.to_dict() for one in alone.relaxations] == [
        {"constraint": "exclude_detector", "drop": {"exclude_detector": ["CMOS"]}, "paths": 3}
    ]


def test_of_several_ways_out_the_one_that_gives_most_is_first(
    facts_of: Callable[[Rows], Facts],
) -> None:
    facts = facts_of(
        [PATH, {**PATH, "detector": ["PD"], "mask": ["Lens"]}, {**PATH, "mask": ["Encoded"]}]
    )
    blocked = blocked_of(recommend({"detector": "CMOS", "mask": "Lens"}, facts=facts))
    assert blocked.constraints == ("mask",)
    assert [(one.constraint, one.paths) for one in blocked.relaxations[:2]] == [
        ("mask", 2),
        ("detector", 1),
    ]
    assert blocked.detail == (
        "no path meets mask = Lens beside the other requirements; without it 2 would"
    )


def test_two_that_must_go_together_are_named_together(
    facts_of: Callable[[Rows], Facts],
) -> None:
    ask = {"detector": "PD", "mask": "Lens", "max_error_deg": 0.25, "task": "Cost"}
    facts = facts_of([{**PATH, "accuracy_deg": ["0.25"]}])
    blocked = blocked_of(recommend(ask, facts=facts))
    assert blocked.constraint == "detector + mask"
    assert blocked.detail == (
        "no path meets detector = PD and mask = Lens beside the other requirements; "
        "without them 1 would"
    )
    assert [one.to_dict() for one in blocked.relaxations] == [
        {
            "constraint": "detector + mask",
            "drop": {"detector": ["PD"], "mask": ["Lens"]},
            "paths": 1,
        }
    ]


def test_what_nothing_tells_of_is_said_of_that_alone(
    facts_of: Callable[[Rows], Facts],
) -> None:
    hint = ". Nothing measured or stated tells of "
    plain = facts_of([PATH])
    both = blocked_of(recommend({"max_error_deg": 1.0, "min_fov_deg": 10.0}, facts=plain))
    assert both.detail.endswith(f"would{hint}max_error_deg or min_fov_deg")
    stated = facts_of([{**PATH, "accuracy_deg": ["2"]}])
    assert hint not in blocked_of(recommend({"max_error_deg": 1.0}, facts=stated)).detail
    rows = [score(rms_deg=2.0)]
    assert hint not in blocked_of(recommend({"max_error_deg": 1.0}, rows, facts=plain)).detail
    assert hint in blocked_of(recommend({"max_error_deg": 1.0}, facts=plain)).detail
    assert hint not in blocked_of(recommend({"mask": "Lens"}, facts=plain)).detail
