"""Sources have names, and none is a raw address, a mirror or a document-sharing site."""

from __future__ import annotations

import csv
import re
from typing import Any

import pytest

from survey_data import sources
from survey_data.descriptor import DATA_DIRECTORY

#: Hosts that the survey's facts once linked to, and others of their kind.
_MIRRORS = (
    *("http://120.26.44.124:3004/details/1/897884438", "http://[2001:db8::1]/paper"),
    *("https://pdfslide.net/a.html", "https://www.scribd.com/doc/1", "https://ja.scribd.com/doc/2"),
    *("https://www.researchgate.net/p", "https://discovery.researcher.life/a", "https://zowya.com"),
)


def _cited() -> list[tuple[str, str]]:
    found = []
    for table, column in (
        *((name, "source") for name in ("attributes", "roles", "architectures", "hardware")),
        ("studies", "url"),
    ):
        with (DATA_DIRECTORY / f"{table}.csv").open(encoding="utf-8", newline="") as file:
            found += [(table, row[column]) for row in csv.DictReader(file) if row[column]]
    return found


@pytest.mark.parametrize("address", _MIRRORS)
def test_a_raw_address_or_a_mirror_is_no_source_and_no_link(address: str) -> None:
    assert sources.fault(address)
    assert not sources.source_named(address).link


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("https://a.example/x", "sources.csv"),
        ("https://doi.org/10.1/x; FOV: the survey text", "stands alone"),
        ("https://www.mdpi.com:8080/x", "by its name alone"),
        ("https://user@www.mdpi.com/x", "by its name alone"),
        ("https://localhost/x", "raw address"),
        ("data sheet at pdfslide.net/x", "pdfslide.net stands in a source"),
    ],
)
def test_what_cannot_be_cited_says_why(text: str, reason: str) -> None:
    assert reason in sources.fault(text)


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("https://doi.org/10.3390/s21041472", "doi:10.3390/s21041472"),
        ("https://www.mdpi.com/1424-8220/11/10/9764", "MDPI"),
        ("https://biomedicaloptics.spiedigitallibrary.org/x", "SPIE Digital Library"),
        ("tab:felit", "Table 3 “Overview of feature extraction literature”"),
        ("Chen2006", "Chen2006"),
        ("Solar MEMS Technologies, SSOC-D60 data sheet", ""),
        ("", ""),
    ],
)
def test_a_source_is_named(text: str, name: str) -> None:
    assert not sources.fault(text)
    assert sources.source_named(text).name == (name or text)


def test_every_source_of_ours_has_a_name_and_a_host_that_may_be_linked_to() -> None:
    cited = _cited()
    assert len(cited) > 800
    for table, text in cited:
        assert not sources.fault(text), (table, text)
        assert not re.match(r"https?:|www\.", sources.source_named(text).name), (table, text)


def test_notes_keep_where_a_copy_was_read_without_a_scheme_that_programs_would_link() -> None:
    notes = []
    for table in ("attributes", "roles", "studies", "hardware"):
        with (DATA_DIRECTORY / f"{table}.csv").open(encoding="utf-8", newline="") as file:
            notes += [row.get("note") or row.get("notes") or "" for row in csv.DictReader(file)]
    assert sum("read in a copy" in note or "record seen at" in note for note in notes) > 150
    assert not [note for note in notes if "://" in note or "www." in note]


@pytest.mark.parametrize(
    ("table", "column", "text"),
    [
        ("attributes", "source", "https://pdfslide.net/x"),
        ("studies", "url", "https://www.scribd.com/doc/1"),
        ("advice", "survey_section", "sec:nowhere"),
    ],
)
def test_validation_names_the_cell(copy: Any, table: str, column: str, text: str) -> None:
    copy.set(table, 5, column, text)
    found = [(p.row, p.column) for p in copy.found(f"{table}.csv")]
    assert (5, column) in found
