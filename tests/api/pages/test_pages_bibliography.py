"""What pages link to and call sources; what is missing of the bibliography, and references."""

from __future__ import annotations

import csv
import re
from html import unescape
from pathlib import Path

import bibtexparser
import pytest

import survey_data
from survey_data.importing.bibliography import read_bibliography
from survey_data.labels import LABEL, labels
from survey_data.sources import fault
from tests.api.conftest import Client
from tests.api.pages.addresses import KINDS

_FOLDER = Path(survey_data.__file__).parent


def read(table: str) -> list[dict[str, str]]:
    with (_FOLDER / f"{table}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def every_page(atlas: Client) -> list[str]:
    """One of every kind of page, and those that show sources: studies and sensors."""
    values = {(row["attribute"], row["value"]) for row in read("taxonomy")}
    return [
        *KINDS.values(),
        *(f"/studies/{row['key']}" for row in read("studies")),
        *(f"/detectors/{value}" for attribute, value in values if attribute == "detector"),
        *(f"/masks/{value}" for attribute, value in values if attribute == "mask"),
        *(f"/datasets/{one['name']}" for one in atlas.walk("/v1/datasets")),
        *(f"/claims/{one['id']}" for one in atlas.walk("/v1/claims")),
        *(f"/algorithms/{one['name']}" for one in atlas.walk("/v1/algorithms")),
    ]


@pytest.mark.parametrize("step", [25, pytest.param(1, marks=pytest.mark.slow)])
def test_no_page_links_to_a_mirror_or_shows_a_label_of_the_latex_source(
    atlas: Client, step: int
) -> None:
    outside = 0
    kinds = len(KINDS)
    pages = every_page(atlas)
    for page in (*pages[:kinds], *pages[kinds::step]):
        text = atlas.get(page, accept="text/html").text
        for link in re.findall(r'href="(https?://[^"]+)"', text):
            outside += 1
            assert not fault(unescape(link)), (page, link)
        shown = re.sub(r"<(script|style)\b.*?</\1>|<[^>]*>", " ", text, flags=re.DOTALL)
        found = [label for label in LABEL.findall(unescape(shown)) if label in labels()]
        assert not found, (page, found)
    assert outside > 400 / step


def test_the_missing_is_counted_as_the_table_has_it(atlas: Client) -> None:
    document = atlas.get("/bibliography.json").json()
    rows = read("studies")
    for field in ("title", "authors", "venue", "doi"):
        assert document["missing"][field] == sum(not row[field] for row in rows)
    assert document["missing"]["type"] == sum(row["type"] == "unknown" for row in rows)
    assert document["missing"]["confirmation"] == sum(
        row["identity"] != "confirmed" for row in rows
    )
    text = atlas.get("/bibliography", accept="text/html").text
    for row in rows:
        incomplete = row["identity"] != "confirmed" or not row["doi"]
        assert not incomplete or f'href="/studies/{row["key"]}"' in text


def test_the_file_to_fill_in_has_every_incomplete_study_and_confirms_nothing(
    atlas: Client, tmp_path: Path
) -> None:
    answer = atlas.get("/bibliography.bib")
    assert answer.headers["content-type"].startswith("application/x-bibtex")
    library = bibtexparser.parse_string(answer.text)
    assert library.failed_blocks == []
    document = atlas.get("/bibliography.json").json()["items"]
    assert {entry.key for entry in library.entries} == {
        row["key"] for row in document if row["missing"]
    }
    path = tmp_path / "missing.bib"
    path.write_text(answer.text, encoding="utf-8")
    identity = {row["key"]: row["identity"] for row in read("studies")}
    for entry in read_bibliography(path):
        assert not entry.title or identity[entry.key] == "confirmed"
    plan = survey_data.import_bibliography(path)
    assert plan.edits == plan.settled == ()


@pytest.mark.parametrize(
    "page",
    ["/studies?detector=CMOS&q=sun&rows=all", "/studies/Liebe2002", "/architectures/CMOS/Encoded"],
)  # fmt: skip
def test_what_a_page_offers_to_cite_is_what_it_lists(atlas: Client, page: str) -> None:
    text = atlas.get(page, accept="text/html").text
    link = unescape(re.search(r'href="(/v1/studies[^"]*format=bibtex[^"]*)"', text)[1])  # type: ignore[index]
    cited = {entry.key for entry in bibtexparser.parse_string(atlas.get(link).text).entries}
    listed = set(re.findall(r'href="/studies/(\w+)"', text)) | {page.rpartition("/")[2]}
    known = {row["key"]: row["title"] for row in read("studies")}
    assert cited
    assert cited == {key for key in listed if known.get(key)}
