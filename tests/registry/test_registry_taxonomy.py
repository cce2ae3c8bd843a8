"""The vocabulary is the survey's, and a misspelt value names the nearest."""

import pytest

from registry.studies import Facts
from registry.taxonomy import InvalidValueError


def test_the_survey_has_33_models_20_extractors_and_ten_detectors(survey: Facts) -> None:
    sizes = {a: len(survey.taxonomy.values(a)) for a in survey.taxonomy.attributes}
    assert sizes == {
        "model": 33,
        "extractor": 20,
        "task": 7,
        "error": 7,
        "detector": 10,
        "mask": 10,
        "accuracy": 4,
    }


def test_none_is_a_value_and_not_a_missing_cell(survey: Facts) -> None:
    survey.taxonomy.require("model", "None")
    assert sum(s.of("model") == ("None",) for s in survey.studies.values()) == 12
    assert {k for k, s in survey.studies.items() if s.of("extractor") == ("None",)} == {
        "Duan2006",
        "Mobasser2001",
    }


@pytest.mark.parametrize(
    ("level", "text", "meant"),
    [
        ("mask", "multi-ap", "Multi-Ap."),
        ("detector", "cmso", "CMOS"),
        ("detector", "Quadrant photodiodes", "QPD"),
        ("extractor", "linear phase", "Linear-phase"),
        ("model_category", "geometrical", "Geometric"),
        ("task", "zzzzzz", None),
        ("detector", "zzzzzzc", None),  # a letter in common is not enough
    ],
)
def test_nearest_finds_values_by_spelling_and_by_name(
    survey: Facts, level: str, text: str, meant: str | None
) -> None:
    assert survey.taxonomy.nearest_value(level, text) == meant


def test_an_unknown_value_names_parameter_choices_and_nearest(survey: Facts) -> None:
    with pytest.raises(InvalidValueError, match="did you mean 'Encoded'") as caught:
        survey.taxonomy.require("mask", "encodd", parameter="exclude_mask")
    assert caught.value.to_dict() == {
        "parameter": "exclude_mask",
        "value": "encodd",
        "expected": "one of " + ", ".join(survey.taxonomy.values("mask")),
        "nearest": "Encoded",
    }
    with pytest.raises(InvalidValueError, match="did you mean 'detector'"):
        survey.taxonomy.values("detektor")


def test_parents_stand_for_their_kinds(survey: Facts) -> None:
    assert survey.taxonomy.kinds("model", "ECM") == ("ECM", "ECM/Noise", "ECM/Angular loss")
    assert survey.taxonomy.kinds("model", "ICM") == ("ICM", "ICM/Albedo", "ICM/Shadow")
    assert survey.taxonomy.kinds("model", "SPM") == ("SPM",)
