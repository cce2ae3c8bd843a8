"""Accuracy and precision as studies report them, each with the statistic that it is."""

from __future__ import annotations

import math

import pytest

import survey_data
from registry.requirements import CLASSES_DEG
from registry.studies import facts
from survey_data.reported import KIND_OF, reported_accuracies, statistics


@pytest.mark.parametrize(
    ("kind", "value", "rms"),
    [
        ("1sigma", 0.1, 0.1),
        ("3sigma", 0.03, 0.01),
        ("p95", 0.196, 0.1),
        ("mean", math.sqrt(2 / math.pi), 1.0),  # mean of |error| of a normal error of RMS 1
        ("max", 3.0, 1.0),
        ("rms", 0.3, 0.3),
        ("unspecified", 0.5, 0.5),
        ("", 0.3, 0.3),
    ],
)
def test_a_figure_is_compared_as_the_rms_of_its_kind(kind: str, value: float, rms: float) -> None:
    assert reported_accuracies("accuracy", value, kind).rms_deg == pytest.approx(rms, rel=1e-3)


def test_a_one_sigma_precision_is_no_accuracy() -> None:
    """Wei2013 prints 1.1 arcsec, Wang2015 1.32 arcsec, both as precision and 1 sigma."""
    for key, arcsec in (("Wei2013", 1.1), ("Wang2015", 1.32)):
        study = facts().studies[key]
        assert study.report("accuracy") is None
        found = study.report("precision")
        assert found is not None
        assert found.label == "1-sigma precision"
        assert found.value_deg == pytest.approx(arcsec / 3600, rel=1e-3)


def test_every_number_of_the_mapping_has_a_kind() -> None:
    attributes = survey_data.load().attributes
    for number, kind in KIND_OF.items():
        with_number = {
            a: set(attributes.loc[attributes["attribute"] == a, "study"]) for a in KIND_OF
        }
        kinds = attributes.loc[attributes["attribute"] == kind]
        assert set(kinds["study"]) == with_number[number]
        assert set(kinds["value"]) <= set(statistics())


def test_cells_that_the_survey_tells_of_rest_on_its_text() -> None:
    studies = facts().studies
    cells = (
        studies["Pentke2022"].values["error"][0],
        studies["Bardallo2017a"].values["detector"][0],
    )
    assert [(c.value, c.basis) for c in cells] == [
        ("Electrical", "survey-text"), ("Event", "survey-text"),
    ]  # fmt: skip


def test_requirements_ask_by_the_limits_of_the_taxonomy() -> None:
    taxonomy = survey_data.load().taxonomy
    limits = taxonomy[taxonomy["attribute"] == "accuracy"].set_index("value")["max_deg"].dropna()
    least = taxonomy[taxonomy["attribute"] == "accuracy"].set_index("value")["min_deg"].to_dict()
    assert {name: low for name, (low, _) in CLASSES_DEG.items()} == pytest.approx(least)
    ends = {name: high for name, (_, high) in CLASSES_DEG.items() if high < math.inf}
    assert ends == pytest.approx(limits.to_dict())
