"""References to studies, read back by programs that are not ours."""

from __future__ import annotations

import json
from typing import Any

import bibtexparser
import pytest
import rispy
from bibtexparser.middlewares import LatexDecodingMiddleware, SeparateCoAuthors, SplitNameParts

from api.citations import FORMS, bibtex, csl_json, ris

STUDY = {
    "key": "A2020",
    "title": "Cost & 50% of_it {x} ~ a\\b, 1 < 2",
    "authors": "N. van der Heiden; He Liang (as printed); José Pérez; et al.",
    "year": "2020",
    "venue": "J. Sun #1",
    "type": "journal",
    "doi": "10.1000/a_b(c)<d>",
    "url": "",
    "identity": "recalled",
}
#: What each type of publication is in BibTeX, RIS and CSL, and where its venue goes.
KINDS = {
    "journal": (("article", "journal"), "JOUR", ("article-journal", "container-title")),
    "conference": (
        *(("inproceedings", "booktitle"), "CPAPER"),
        ("paper-conference", "container-title"),
    ),
    "preprint": (("misc", "howpublished"), "UNPB", ("article", "publisher")),
    "thesis": (("phdthesis", "school"), "THES", ("thesis", "publisher")),
    "report": (("techreport", "institution"), "RPRT", ("report", "publisher")),
    "unknown": (("misc", "howpublished"), "GEN", ("document", "container-title")),
}


def read_bibtex(text: str) -> list[Any]:
    library = bibtexparser.parse_string(
        text, append_middleware=[SeparateCoAuthors(), LatexDecodingMiddleware(), SplitNameParts()]
    )
    assert library.failed_blocks == []
    return list(library.entries)


def test_latex_signs_come_back_as_they_were() -> None:
    (entry,) = read_bibtex(bibtex([STUDY]))
    found = {field.key: field.value for field in entry.fields}
    assert found["title"].strip("{}") == STUDY["title"]
    assert found["journal"] == STUDY["venue"]
    assert [(name.von, name.last, name.first) for name in found["author"]] == [
        (["van", "der"], ["Heiden"], ["N."]),
        ([], ["Liang"], ["He"]),
        ([], ["Pérez"], ["José"]),
        ([], ["others"], []),
    ]
    assert found["doi"] == STUDY["doi"]
    assert "identified from memory" in found["note"]


@pytest.mark.parametrize("kind", KINDS)
def test_every_type_has_its_entry_and_its_venue(kind: str) -> None:
    (entry_type, venue), ris_type, (csl_type, csl_venue) = KINDS[kind]
    study = {**STUDY, "type": kind, "venue": "Where"}
    (entry,) = read_bibtex(bibtex([study]))
    assert (entry.entry_type, entry[venue]) == (entry_type, "Where")
    (reference,) = rispy.loads(ris([study]))
    assert reference["type_of_reference"] == ris_type
    assert "Where" in reference.values()
    assert not reference.get("unknown_tag")
    (item,) = json.loads(csl_json([study]))
    assert (item["type"], item[csl_venue]) == (csl_type, "Where")


def test_ris_is_read_back() -> None:
    (reference,) = rispy.loads(ris([{**STUDY, "title": "Two\nlines"}]))
    assert reference["id"] == "A2020"
    assert reference["title"] == "Two lines"
    assert reference["authors"] == ["van der Heiden, N.", "Liang, He", "Pérez, José", "et al."]
    assert (reference["year"], reference["doi"]) == ("2020", STUDY["doi"])


def test_an_arxiv_number_is_named_as_one() -> None:
    study = {**STUDY, "type": "preprint", "doi": "10.48550/arXiv.2508.00918"}
    (entry,) = read_bibtex(bibtex([study]))
    assert (entry["eprint"], entry["archiveprefix"]) == ("2508.00918", "arXiv")


def test_braces_in_an_address_do_not_end_the_entry() -> None:
    other = {**STUDY, "key": "B2020"}
    text = bibtex([{**STUDY, "url": "https://a.org/{x}}"}, other])
    first, second = bibtexparser.parse_string(text).entries
    assert (first["url"], second.key) == ("https://a.org/%7Bx%7D%7D", "B2020")


def test_the_unidentified_are_left_out() -> None:
    nobody = {**STUDY, "title": ""}
    assert bibtex([nobody]) == ris([nobody]) == ""
    assert json.loads(csl_json([nobody])) == []
    assert set(FORMS) == {"bibtex", "ris", "csl"}
