"""Facts that do not fit each other are refused by study and attribute; editions by their name."""

from __future__ import annotations

from dataclasses import fields
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


def test_tables_that_contradict_each_other_give_no_facts(
    texts: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    def strange(names: tuple[str, ...]) -> Any:
        assert {"studies", "attributes"} <= set(names)
        return SimpleNamespace(**{**vars(texts), "attributes": [cell("mask", "Slit")]})

    monkeypatch.setattr(studies, "load_texts", strange)
    monkeypatch.setattr(studies, "_facts", studies._facts.__wrapped__)  # keeps what is cached
    with pytest.raises(FactsError, match=r"contradict each other: attributes of .*Doe2030"):
        facts("survey")


def test_a_study_that_is_in_no_table_yet_has_what_its_rows_say() -> None:
    found = study_from({"studies": [STUDY], "attributes": [cell("mask", "Slit")]})
    assert (found.key, found.edition, found.of("mask")) == ("Doe2030", "extension", ("Slit",))


def test_confirmations_stand_with_their_study_in_their_order(texts: Any) -> None:
    rows = [
        {"study": "Doe2030", "name": name, "date": "2030-02-28", "confirms": said, "source": ""}
        for name, said in (("Jane Doe", "every cell"), ("Max Moe", "the mask"))
    ]
    found = facts_with(texts, verifications=rows).study("Doe2030").verifications
    assert [one.to_dict() for one in found] == [
        {name: row[name] for name in ("name", "date", "confirms", "source")} for row in rows
    ]
    assert [each.name for each in fields(found[0])] == ["name", "date", "confirms", "source"]
