"""What every CSV has in common: no word for what is not known, and a form for spreadsheets."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping
from typing import Any
from urllib.parse import quote, urlencode

from files.csv_writing import escape_formulas
from registry.taxonomy import NONE_STATED
from tests.api.conftest import Client

WORDS = frozenset({"none", "nan", "null", "n/a", "na", "<na>", "nat", "inf", "-inf", "undefined"})
#: A term of the glossary, and names of sensors in JSON, which has a null.
THINGS = {("/glossary.csv", "term", "NaN")}
PAGES = (
    *("/answer.csv", "/studies.csv", "/studies/Coutinho2022.csv", "/algorithms.csv"),
    *("/algorithms/weighted-spots.csv", "/datasets.csv", "/datasets/pd-slit.csv", "/claims.csv"),
    *("/leaderboard.csv", "/glossary.csv", "/detectors.csv", "/masks.csv", "/masks/Slit.csv"),
    *("/architectures/PD/Slit.csv", "/compare.csv", "/search.csv?q=None", "/figures.csv"),
    *("/figures/error.csv", "/claims/C04.csv"),
)
WHOLE = (
    *("/v1/studies?limit=500", "/v1/algorithms?limit=500", "/v1/results?limit=500"),
    *("/v1/leaderboard/cmos-single-aperture?limit=500", "/v1/datasets?limit=500"),
    *("/v1/studies/Duan2006", "/v1/figures/matrix", "/v1/recommendations?limit=100"),
)


def target(path: str, operation: Mapping[str, Any]) -> str:
    """Path with query of an operation's example."""
    given = [one for one in operation.get("parameters", ()) if "example" in one]
    for one in given:
        if one["in"] == "path":
            path = path.replace(f"{{{one['name']}}}", quote(str(one["example"]), safe=""))
    query = {one["name"]: one["example"] for one in given if one["in"] == "query"}
    return path + ("?" + urlencode(query, doseq=True) if query else "")


def tables(atlas: Client) -> list[str]:
    """Addresses of every table: each endpoint's example, whole lists, and pages."""
    paths = atlas.get("/openapi.json").json()["paths"]
    found = [
        target(path, methods["get"])
        for path, methods in paths.items()
        if "text/csv"
        in methods.get("get", {}).get("responses", {}).get("200", {}).get("content", {})
    ]
    assert len(found) > 25
    return [*found, *WHOLE, *PAGES]


def words_for_nothing(address: str, text: str) -> list[tuple[str, str, str]]:
    """Return (address, column, cell) of cells, or items of lists in them, that say "nothing"."""
    rows = csv.DictReader(io.StringIO(text, newline=""))
    cells = [(column, cell) for row in rows for column, cell in row.items()]
    return [
        (address, column, cell)
        for column, cell in cells
        if any(item.casefold() in WORDS for item in re.split("; ?", cell))
    ]


def test_the_survey_s_none_is_told_apart_from_what_is_unknown(atlas: Client) -> None:
    tables = {row["key"]: row for row in atlas.table("/v1/studies?limit=500")}
    listed = {item["key"]: item for item in atlas.get("/v1/studies?limit=500").json()["items"]}
    none = [key for key, item in listed.items() if item["values"]["model"] == ["None"]]
    unknown = [key for key, item in listed.items() if not item["values"].get("detector")]
    assert none
    assert unknown
    assert {tables[key]["model"] for key in none} == {NONE_STATED}
    assert {tables[key]["detector"] for key in unknown} == {""}


def test_safe_is_true_or_false(atlas: Client) -> None:
    for wrong in ("safe=maybe", "safe=", "safe=true&safe=false"):
        assert atlas.get(f"/v1/taxonomy?format=csv&{wrong}").status_code == 422, wrong


def test_every_table_has_no_word_for_what_is_not_known_and_a_form_for_spreadsheets(
    atlas: Client,
) -> None:
    found = set()
    for address in tables(atlas):
        plain = atlas.get(address, accept="text/csv")
        assert plain.status_code == 200, address
        found |= set(words_for_nothing(address, plain.text))
        there = plain.links["alternate"]["url"]
        assert plain.links["alternate"]["type"] == "text/csv"
        safe = atlas.get(there, accept="*/*" if ".csv" in address else "text/csv")
        assert safe.status_code == 200, there
        assert safe.headers["content-type"] == plain.headers["content-type"]
        assert safe.text == escape_formulas(plain.text)
        assert "alternate" not in safe.links
    assert found == THINGS


def with_format(command, path):
    """Give (path, command) of all commands below one that print tables."""
    if any("--format" in parameter.opts for parameter in command.params):
        yield path, command
    for name, member in getattr(command, "commands", {}).items():
        yield from with_format(member, (*path, name))
