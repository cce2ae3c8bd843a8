"""Every study carries every cell of the survey's tables, with its provenance."""

import pytest

import survey_data
from registry.studies import Facts, studies, study
from registry.taxonomy import ATTRIBUTES, InvalidValueError


def test_there_are_129_studies() -> None:
    assert len(studies()) == 129


def test_every_cell_of_the_attribute_table_is_in_its_study_and_no_other(survey: Facts) -> None:
    table = survey_data.load().attributes
    stated = table[table["value"].notna()]
    expected = sorted(
        zip(stated["study"], stated["attribute"], stated["value"], stated["basis"], strict=True)
    )
    found = sorted(
        (s.key, attribute, cell.value, cell.basis)
        for s in survey.studies.values()
        for attribute, cells in s.values.items()
        for cell in cells
    )
    assert found == expected
    empty = table[table["value"].isna()]
    assert {(s.key, a) for s in survey.studies.values() for a in s.unknown} == set(
        zip(empty["study"], empty["attribute"], strict=True)
    )


def test_an_attribute_is_stated_or_unknown_but_not_both(survey: Facts) -> None:
    for s in survey.studies.values():
        assert {*s.values, *s.unknown} >= set(ATTRIBUTES)
        assert not s.values.keys() & s.unknown.keys()


def test_an_unknown_study_names_the_nearest() -> None:
    with pytest.raises(InvalidValueError, match="did you mean 'Chang2008'"):
        study("Chng2008")
