"""Metadata name authors as schema.org does, and refuse a document whose names are ambiguous."""

from __future__ import annotations

import dataclasses

import pytest

from api.metadata.citation import Author
from api.metadata.croissant import DatasetDescription, File, Table, cite_as, croissant
from api.metadata.identity import Identity, identity

WHAT = DatasetDescription("Atlas: pd-slit", "A data set.", None, "1.0.0", ("sun sensor",))
ORCID = "0000-0002-1825-0097"
PERSON = Author(family="Sun", given="Ada", orcid=ORCID, affiliation="A University")
ALONE = Author(family="Plato")
TEAM = Author(name="The Atlas Team")
COLUMNS = (("sample", "integer", "Number of the sample."),)


@pytest.fixture
def who() -> Identity:
    """The project as if three had made it."""
    return dataclasses.replace(identity(), authors=(PERSON, ALONE, TEAM))


def file(name: str) -> File:
    return File.of(b"a", name, f"../{name}", ("text/csv",), "A table.")


def table(name: str, of: str) -> Table:
    return Table(name, of, "A sample.", COLUMNS, ("sample",))


@pytest.mark.parametrize(
    ("files", "tables", "says"),
    [
        (
            [file("a.csv"), file("b.csv")],
            [table("t", "a.csv"), table("u", "c.csv")],
            r"table u: expected a file among a\.csv, b\.csv",
        ),
        ([], [table("t", "a.csv")], "table t: expected a file among "),
        ([file("a.csv"), file("a.csv")], [], r"^a\.csv: two files or tables of that name"),
        (
            [file("a.csv")],
            [table("t", "a.csv"), table("t", "a.csv")],
            "^t: two files or tables of that name",
        ),
        ([file("a.csv")], [table("a.csv", "a.csv")], r"^a\.csv: two files or tables of that name"),
    ],
)
def test_a_document_whose_names_do_not_tell_things_apart_is_refused(
    who: Identity, files: list[File], tables: list[Table], says: str
) -> None:
    with pytest.raises(ValueError, match=says):
        croissant(WHAT, who, files, tables)
    assert croissant(WHAT, who, [file("a.csv")], [table("t", "a.csv")])["recordSet"]


def test_croissant_tells_persons_from_organisations(who: Identity) -> None:
    creators = croissant(WHAT, who, [], [])["creator"]
    assert creators == [
        {
            "@type": "sc:Person",
            "name": "Ada Sun",
            "givenName": "Ada",
            "familyName": "Sun",
            "url": f"https://orcid.org/{ORCID}",
        },
        {"@type": "sc:Person", "name": "Plato", "givenName": "", "familyName": "Plato"},
        {"@type": "sc:Organization", "name": "The Atlas Team"},
    ]
    assert "author = {Sun, Ada and Plato and {The Atlas Team}}" in cite_as(WHAT, who)
