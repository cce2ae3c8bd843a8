"""The fidelity report: every number is counted from the tables at hand."""

from __future__ import annotations

import dataclasses
import json

import pytest

import survey_data


def test_129_studies_are_held_and_128_stated_and_the_difference_is_explained(
    tables: survey_data.SurveyTables,
) -> None:
    report = survey_data.fidelity(tables).to_dict()
    assert (report["studies"], report["stated"]) == (129, 128)
    for key in ("Liebe2001", "Mobasser2001", "TrebiOllennu2001", "Wu2001"):
        assert key in report["explanation"]
        assert key in report["early_keys"]
    assert report["case_references"] == ["Adatrao2016", "Bhanderi2006"]
    assert "Adatrao2016" in report["explanation"]
    assert len(report["findings"]) == 51
    assert report["problems"] == []
    assert json.loads(json.dumps(report)) == report


def test_completeness_adds_up_for_every_attribute(tables: survey_data.SurveyTables) -> None:
    report = survey_data.fidelity(tables)
    known = tables.attributes.dropna(subset=["value"])
    for attribute, entry in report.completeness.items():
        assert entry.known + entry.unknown == 129
        assert sum(entry.by_basis.values()) == entry.known
        assert entry.known == known.loc[known["attribute"] == attribute, "study"].nunique()
        assert "unknown" not in entry.by_basis
    by_name = report.completeness
    # Antonello2018, Lu2017a and OKeefe2017 are printed under parents alone: the kind is the text's.
    assert by_name["model"].by_basis == {"survey-table": 126, "survey-text": 3}
    assert by_name["extractor"].by_basis == {"survey-table": 129}
    assert by_name["accuracy"].known == 58


def test_the_strongest_basis_of_a_cell_is_counted(tables: survey_data.SurveyTables) -> None:
    attributes = tables.attributes.copy()
    rows = attributes.index[attributes.eval("study == 'Antonello2018' and attribute == 'task'")]
    attributes.loc[rows[1], "basis"] = "survey-text"
    before = survey_data.fidelity(tables)
    after = survey_data.fidelity(dataclasses.replace(tables, attributes=attributes))
    assert (
        after.completeness["task"].by_basis["survey-text"]
        == before.completeness["task"].by_basis["survey-text"] + 1
    )


def test_no_accuracy_is_outside_its_class(tables: survey_data.SurveyTables) -> None:
    assert survey_data.fidelity(tables).class_disagreements == ()


def test_a_printed_class_that_its_number_contradicts_stands_and_is_shown(
    tables: survey_data.SurveyTables,
) -> None:
    attributes = tables.attributes.copy()
    at = (attributes["study"] == "Wei2014") & (attributes["attribute"] == "accuracy")
    attributes.loc[at, "value"] = "VFSS"  # survey text; its 5 arcsec are ultra fine
    (found,) = survey_data.fidelity(
        dataclasses.replace(tables, attributes=attributes)
    ).class_disagreements
    assert (found.study, found.filed, found.by_limits, found.printed) == (
        "Wei2014", "VFSS", "UFSS", True,
    )  # fmt: skip


@pytest.mark.parametrize(("value", "count"), [("0.0167", 0), ("0.0166667", 0), ("0.0171", 1)])
def test_a_number_that_is_a_limit_as_rounded_contradicts_neither_class(
    tables: survey_data.SurveyTables, value: str, count: int
) -> None:
    """Rufino2008 states "better than 1 arcmin": one arcminute, in the class that is better."""
    attributes = tables.attributes.copy()
    at = (attributes["study"] == "Rufino2008") & (attributes["attribute"] == "accuracy_deg")
    assert attributes.loc[at, "value"].tolist() == ["0.0167"]
    attributes.loc[at, "value"] = value
    changed = dataclasses.replace(tables, attributes=attributes)
    assert len(survey_data.fidelity(changed).class_disagreements) == count
