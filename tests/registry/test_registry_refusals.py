"""Facts that do not fit each other are refused by study and attribute; editions by their name."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from registry import studies
from registry.studies import Facts, FactsError, facts, facts_from, study_from
from registry.taxonomy import InvalidValueError
from survey_data.texts import load_texts

Rows = list[dict[str, str]]

STUDY = {
    "key": "Doe2030", "title": "T", "authors": "Jane Doe", "year": "2030", "venue": "",
    "type": "thesis", "doi": "10.1234/x", "url": "", "identity": "confirmed", "note": "",
}  # fmt: skip


def cell(attribute: str, value: str) -> dict[str, str]:
    of = {"study": "Doe2030", "attribute": attribute, "value": value}
    return of | {"basis": "title", "source": "", "note": ""}


@pytest.fixture(scope="module")
def texts() -> Any:
    """The tables that facts are made from, without a study."""
    tables = load_texts(studies._TABLES)
    for name in ("studies", "attributes", "roles", "architectures"):
        setattr(tables, name, [])
    return tables


def facts_with(texts: Any, **tables: Rows) -> Facts:
    return facts_from(SimpleNamespace(**{**vars(texts), "studies": [STUDY], **tables}))


def test_an_edition_that_there_is_not_is_named_with_those_that_there_are() -> None:
    with pytest.raises(InvalidValueError, match=r"edition: .*survey.*all.*got 'al'; did you mean"):
        facts("al")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("attribute", "value", "said"),
    [
        ("mask", "Slitt", r"Doe2030 mask: .*did you mean 'Slit'"),
        ("accuracy_deg", "0,5", "Doe2030 accuracy_deg: expected a number in degrees; got '0,5'"),
        ("fov_deg", "1e999", "Doe2030 fov_deg: expected a number in degrees; got '1e999'"),
        ("accuracy_kind", "best", "Doe2030 accuracy_kind: expected one of 1sigma, .*got 'best'"),
    ],
)
def test_a_value_that_is_none_of_its_attribute_names_the_study(
    texts: Any, attribute: str, value: str, said: str
) -> None:
    with pytest.raises(InvalidValueError, match=said):
        facts_with(texts, attributes=[cell(attribute, value)])
    with pytest.raises(FactsError, match=f"the tables contradict each other: {said}"):
        study_from({"studies": [STUDY], "attributes": [cell(attribute, value)]})


def test_tables_that_contradict_each_other_are_refused(texts: Any) -> None:
    with pytest.raises(ValueError, match="study 'Doe2030' stands twice"):
        facts_with(texts, studies=[STUDY, STUDY])
    stranger = cell("mask", "Slit") | {"study": "Nobody1999"}
    with pytest.raises(ValueError, match=r"attributes of studies not in the table.* Nobody1999"):
        facts_with(texts, attributes=[stranger])


def test_a_study_that_is_in_no_table_yet_has_what_its_rows_say() -> None:
    found = study_from({"studies": [STUDY], "attributes": [cell("mask", "Slit")]})
    assert (found.key, found.edition, found.of("mask")) == ("Doe2030", "extension", ("Slit",))
