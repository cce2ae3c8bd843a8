"""Every study carries every cell of the survey's tables, with its provenance."""

from types import SimpleNamespace

import pandas as pd
import pytest

import survey_data
from registry.studies import Facts, facts_from, studies, study
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


def test_tables_that_contradict_each_other_are_refused() -> None:
    tables = survey_data.load()
    stranger = tables.attributes.copy()
    stranger.loc[0, "study"] = "Nobody1999"
    with pytest.raises(ValueError, match="Nobody1999"):
        facts_from(_tables(tables, attributes=stranger))
    wrong = tables.attributes.copy()
    at = wrong.index[wrong["attribute"] == "mask"][0]
    wrong.loc[at, "value"] = "Multi-App."
    with pytest.raises(InvalidValueError, match=r"did you mean 'Multi-Ap\.'"):
        facts_from(_tables(tables, attributes=wrong))
    twice = pd.concat([tables.studies, tables.studies.head(1)])
    with pytest.raises(ValueError, match="twice"):
        facts_from(_tables(tables, studies=twice))


def _tables(tables: survey_data.SurveyTables, **changed: pd.DataFrame) -> SimpleNamespace:
    names = (
        "studies",
        "attributes",
        "taxonomy",
        "roles",
        "architectures",
        "defaults",
        "model_families",
        "purposes",
        "compensated_models",
        "method_variants",
    )
    return SimpleNamespace(**{name: changed.get(name, getattr(tables, name)) for name in names})
