"""What may be asked of a sun sensor, where its limits are, and how it is said again."""

import math

import pytest

from registry.recommendation import recommend
from registry.requirements import LIMITS, Requirements
from registry.studies import Facts
from registry.taxonomy import InvalidValueError


def test_requirements_are_given_back_as_they_can_be_given_again(survey: Facts) -> None:
    one = next(iter(survey.properties))
    ask = {"task": "Cost", "exclude_mask": ["Lens", "Slit"], "max_error_deg": 2, "model": []}
    answer = recommend({**ask, "properties": one, "survive": []}, facts=survey)
    echo = answer.document["requirements"]
    assert echo == {
        "task": ["Cost"], "exclude_mask": ["Lens", "Slit"], "max_error_deg": 2.0,
        "properties": [one],
    }  # fmt: skip
    assert isinstance(echo, dict)
    assert recommend(echo, facts=survey) == answer


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        ({"tsk": "Accuracy"}, "did you mean 'task'"),
        ({"exclude_detektor": "PD"}, "did you mean 'exclude_detector'"),
        ({"mask": ["Encodd"]}, "mask: .*did you mean 'Encoded'"),
        ({"exclude_mask": ["Encodd"]}, "exclude_mask: .*did you mean 'Encoded'"),
        ({"mask": 3}, "a value of the taxonomy"),
        ({"mask": [3]}, "a value of the taxonomy"),
        ({"max_error_deg": 0}, r"max_error_deg.*degrees.* 0$"),
        ({"max_error_deg": math.nan}, r"max_error_deg.*degrees.* nan$"),
        ({"max_error_deg": "0.1"}, r"max_error_deg.*degrees.* '0\.1'$"),
        ({"max_latency_us": True}, r"max_latency_us.*microseconds.* True$"),
        ({"min_fov_deg": 361}, "at most 360; got 361"),
        ({"min_availability": 1.01}, "got 1.01"),
        ({"survive": "albdo"}, "survive: .*did you mean 'albedo'"),
        ({"properties": ["Robustnes"]}, "properties: "),
        ({"survive": 3}, "a list of them; got 3"),
    ],
)
def test_wrong_requirements_name_what_was_expected(
    survey: Facts, ask: dict[str, object], message: str
) -> None:
    with pytest.raises(InvalidValueError, match=message):
        recommend(ask, facts=survey)


def test_requirements_built_by_hand_are_checked_too(survey: Facts) -> None:
    with pytest.raises(InvalidValueError, match="did you mean 'CMOS'"):
        recommend(Requirements(include={"detector": ("CMOZ",)}), facts=survey)
    with pytest.raises(InvalidValueError, match="did you mean 'albedo'"):
        recommend(Requirements(survive=("albedoo",)), facts=survey)
    for wrong in ({"limit": 0}, {"calibrations": 0}):
        with pytest.raises(InvalidValueError, match="at least 1"):
            recommend({}, facts=survey, **wrong)
    with pytest.raises(InvalidValueError, match=r"sort: .*did you mean 'support'"):
        recommend({}, sort="suport", facts=survey)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", LIMITS)
@pytest.mark.parametrize("wrong", [0, 0.0, -1e-9, math.inf, -math.inf, math.nan, True, "1", [1.0]])
def test_a_limit_is_a_positive_finite_number(survey: Facts, name: str, wrong: object) -> None:
    with pytest.raises(InvalidValueError, match=name):
        Requirements.parse({name: wrong}, survey.taxonomy)


@pytest.mark.parametrize(
    ("name", "bound"),
    [
        ("max_error_deg", 5e-324),
        ("max_error_deg", 1e6),
        ("min_fov_deg", 0.5),
        ("min_fov_deg", 360),
        ("max_latency_us", 361.0),
        ("min_availability", 1.0),
    ],
)
def test_a_limit_at_the_end_of_its_range_is_taken_as_it_is(
    survey: Facts, name: str, bound: float
) -> None:
    asked = Requirements.parse({name: bound}, survey.taxonomy)
    assert asked.to_dict() == {name: float(bound)}
    assert isinstance(asked.limit(name), float)
    assert {asked.limit(other) for other in set(LIMITS) - {name}} == {None}


def test_the_field_of_view_ends_at_the_whole_turn(survey: Facts) -> None:
    with pytest.raises(InvalidValueError, match="at most 360; got 360"):
        Requirements.parse({"min_fov_deg": math.nextafter(360.0, 400.0)}, survey.taxonomy)
    with pytest.raises(InvalidValueError, match="at most 360"):
        recommend(Requirements(min_fov_deg=361.0), facts=survey)


def test_values_are_asked_once_each_in_the_order_given(survey: Facts) -> None:
    ask = {
        "mask": ["Slit", "Lens", "Slit"],
        "exclude_task": ("Cost",),
        "exclude_detector": [],
        "model": None,
        "max_latency_us": None,
        "detector": "CMOS",
        "survive": ("spin", "albedo", "spin"),
    }
    asked = Requirements.parse(ask, survey.taxonomy)
    assert dict(asked.include) == {"mask": ("Slit", "Lens"), "detector": ("CMOS",)}
    assert dict(asked.exclude) == {"task": ("Cost",)}
    assert asked.survive == ("spin", "albedo")
    assert asked.names == ("detector", "mask", "exclude_task", "survive")  # as they are reported


def test_what_is_left_out_or_changed_leaves_the_rest(survey: Facts) -> None:
    ask = {"mask": "Slit", "exclude_mask": ["Lens", "Encoded"], "max_error_deg": 1.0}
    asked = Requirements.parse({**ask, "min_fov_deg": 90.0}, survey.taxonomy)
    rest = {"exclude_mask": ["Lens", "Encoded"], "min_fov_deg": 90.0}
    assert asked.without("mask", "max_error_deg").to_dict() == rest
    assert asked.without("task").to_dict() == asked.to_dict()
    assert asked.with_value("exclude_mask", ("Lens",)).to_dict()["exclude_mask"] == ["Lens"]
    assert asked.with_value("exclude_mask", ("Lens",)).include == asked.include
    assert asked.with_value("exclude_mask", ()).names == ("mask", "max_error_deg", "min_fov_deg")
    assert asked.with_value("mask", ("Encoded",)).to_dict()["mask"] == ["Encoded"]
    assert asked.with_value("mask", ("Encoded",)).exclude == asked.exclude
    assert asked.with_value("max_error_deg", 2.0).limit("max_error_deg") == 2.0
    assert asked.with_value("survive", ("spin",)).names[-1] == "survive"
    assert asked.with_value("survive", ("spin",)).without("survive") == asked


def test_attributes_named_by_hand_are_checked_on_both_sides(survey: Facts) -> None:
    for made in (Requirements({"maks": ("Slit",)}), Requirements({}, {"maks": ("Slit",)})):
        with pytest.raises(InvalidValueError, match="did you mean 'mask'"):
            made.check(survey.taxonomy)
    with pytest.raises(InvalidValueError, match=r"exclude_mask: .*did you mean 'Slit'"):
        Requirements({}, {"mask": ("Slitt",)}).check(survey.taxonomy)
