"""What may be asked of a sun sensor, where its limits are, and how it is said again."""

import math

import pytest

from registry.recommendation import recommend
from registry.requirements import (
    LIMITS,
    MISSIONS,
    PARAMETERS,
    Requirements,
    light_at,
)
from registry.studies import Facts
from registry.taxonomy import InvalidValueError
from tests.registry.drawn_questions import drawn_questions


def parse(survey: Facts, **asked: object) -> Requirements:
    return Requirements.parse(asked, survey.taxonomy, survey.properties)


def test_requirements_are_given_back_as_they_can_be_given_again(survey: Facts) -> None:
    for ask in drawn_questions(50, 4, survey):
        asked = Requirements.parse(ask, survey.taxonomy, survey.properties)
        mission = MISSIONS.get(ask.get("mission", ""), {})
        expected = {**mission, **ask}
        assert asked.to_dict() == {
            name: list(value) if isinstance(value, tuple) else value
            for name, value in expected.items()
        }
        assert Requirements.parse(asked.to_dict(), survey.taxonomy, survey.properties) == asked
        assert set(asked.names) == expected.keys() & {*PARAMETERS, "sun_distance_au"}


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        ({"tsk": "Accuracy"}, "did you mean 'task'"),
        ({"exclude_detektor": "PD"}, "did you mean 'exclude_detector'"),
        ({"benchdeg": 0.1}, "did you mean 'bench_deg'"),
        ({"mask": ["Encodd"]}, "mask: .*did you mean 'Encoded'"),
        ({"exclude_mask": ["Encodd"]}, "exclude_mask: .*did you mean 'Encoded'"),
        ({"mask": 3}, "a value of the taxonomy"),
        ({"mask": [3]}, "a value of the taxonomy"),
        ({"tolerate": "albdo"}, "tolerate: .*did you mean 'albedo'"),
        ({"exclude_needs": "nadr"}, "exclude_needs: .*did you mean 'nadir'"),
        ({"properties": ["Robustnes"]}, "properties: "),
        ({"tolerate": 3}, "a list of them; got 3"),
        ({"mission": "deep-spac"}, "mission: .*did you mean 'deep-space'"),
        ({"evidence": "mesured"}, "evidence: .*did you mean 'measured'"),
    ],
)
def test_unknown_names_are_refused_with_the_nearest(
    survey: Facts, ask: dict[str, object], message: str
) -> None:
    with pytest.raises(InvalidValueError, match=message):
        recommend(ask, facts=survey)


@pytest.mark.parametrize("name", LIMITS)
@pytest.mark.parametrize("wrong", [0, -1e-9, math.inf, math.nan, True, "1", [1.0]])
def test_a_limit_is_a_positive_finite_number(survey: Facts, name: str, wrong: object) -> None:
    with pytest.raises(InvalidValueError, match=name):
        parse(survey, **{name: wrong})


@pytest.mark.parametrize(
    ("name", "least", "most"),
    [
        ("min_fov_deg", 5e-324, 360.0),
        ("min_availability", 5e-324, 1.0),
        ("bench_deg", 0.0, None),
        ("confidence", 0.5, 0.999),
        ("sun_distance_au", 0.05, 100.0),
        ("max_mass_g", 5e-324, None),
    ],
)
def test_numbers_are_taken_up_to_the_ends_of_their_range_and_not_beyond(
    survey: Facts, name: str, least: float, most: float | None
) -> None:
    for end, beyond in ((least, -math.inf), (most or 1e300, math.inf)):
        assert parse(survey, **{name: end}).to_dict() == {name: end}
        out = math.nextafter(end, beyond) if end == most or beyond < 0 else math.inf
        with pytest.raises(InvalidValueError, match=name):
            parse(survey, **{name: out})


def test_values_are_asked_once_each_in_the_order_given(survey: Facts) -> None:
    asked = parse(
        survey, mask=["Slit", "Lens", "Slit"], exclude_task=("Cost",), exclude_detector=[],
        model=None, detector="CMOS", tolerate=("spin", "albedo", "spin"),
    )  # fmt: skip
    assert dict(asked.include) == {"mask": ("Slit", "Lens"), "detector": ("CMOS",)}
    assert dict(asked.exclude) == {"task": ("Cost",)}
    assert asked.tolerate == ("spin", "albedo")
    assert asked.names == ("detector", "mask", "exclude_task", "tolerate")


def test_what_is_left_out_or_changed_leaves_the_rest(survey: Facts) -> None:
    for ask in drawn_questions(50, 6, survey):
        asked = Requirements.parse(ask, survey.taxonomy, survey.properties)
        whole = asked.to_dict()
        for name in asked.names:
            rest = {n: value for n, value in whole.items() if n != name}
            assert asked.without(name).to_dict() == rest
            assert asked.without(name).with_value(name, asked.value_of(name)) == asked


def test_a_mission_is_a_set_of_requirements_that_others_replace(survey: Facts) -> None:
    for name, of_mission in MISSIONS.items():
        alone = parse(survey, mission=name).to_dict()
        assert alone.pop("mission") == name
        assert alone == parse(survey, **of_mission).to_dict()
        changed = parse(survey, mission=name, max_error_deg=0.25, mask="Slit").to_dict()
        assert changed == {**alone, "mission": name, "max_error_deg": 0.25, "mask": ["Slit"]}


@pytest.mark.parametrize(
    ("distance", "hazard"),
    [(0.05, "saturation"), (0.56, "saturation"), (0.57, ""), (1.0, ""), (1.77, ""),
     (1.79, "noise"), (100.0, "noise")],
)  # fmt: skip
def test_light_is_judged_by_the_condition_nearest_in_ratio(distance: float, hazard: str) -> None:
    """Ten times the light of 1 au is at 0.316 au, a tenth at 3.16: half way is 0.562 and 1.778."""
    light = light_at(distance)
    assert light.hazard == hazard
    assert light.flux == pytest.approx(1 / distance**2)
    assert (hazard or "nominal") in light.words
    assert Requirements(sun_distance_au=distance).hazards == ((hazard,) if hazard else ())
