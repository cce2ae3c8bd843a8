"""Editions that there are not are refused; a study may be in no table yet."""

from __future__ import annotations

import pytest

from registry.studies import facts, study_from
from registry.taxonomy import InvalidValueError

STUDY = {
    "key": "Doe2030", "title": "T", "authors": "Jane Doe", "year": "2030", "venue": "",
    "type": "thesis", "doi": "10.1234/x", "url": "", "identity": "confirmed", "note": "",
}  # fmt: skip


def cell(attribute: str, value: str) -> dict[str, str]:
    of = {"study": "Doe2030", "attribute": attribute, "value": value}
    return of | {"basis": "title", "source": "", "note": ""}


def test_an_edition_that_there_is_not_is_named_with_those_that_there_are() -> None:
    with pytest.raises(InvalidValueError, match=r"edition: .*survey.*all.*got 'al'; did you mean"):
        facts("al")  # type: ignore[arg-type]


def test_a_study_that_is_in_no_table_yet_has_what_its_rows_say() -> None:
    found = study_from({"studies": [STUDY], "attributes": [cell("mask", "Slit")]})
    assert (found.key, found.edition, found.of("mask")) == ("Doe2030", "extension", ("Slit",))
