"""Studies read from templates and bibliographies as they were written."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import pytest

import survey_data
from survey_data.additions.offered import Addition, FaultsError, Row, parse_toml, read_addition
from survey_data.additions.writing import choose, read_publications, read_study
from survey_data.problems import SurveyImportError
from survey_data.texts import load_texts
from tests.survey_data.additions.offered_study import content, offered

PLACE = ("study", "attribute")
TABLES = ("studies", "attributes", "roles", "architectures", "names")
#: The escapes of a TOML string are those of JSON.
quoted = partial(json.dumps, ensure_ascii=False)


def by_value(rows: Sequence[Row]) -> dict[tuple[str, str], Mapping[str, str]]:
    return {(row["attribute"], row["value"]): row for row in rows}


def cell(column: str, value: str) -> str:
    if column == "year" and re.fullmatch(r"[1-9][0-9]{0,3}", value):
        return value
    return quoted([n for n in value.split("; ") if n] if column == "authors" else value)


def filled(addition: Addition) -> str:
    """A template that is read into exactly these rows."""
    study = addition.study
    lines = [f"{column} = {cell(column, study[column])}" for column in study if study[column]]
    roles, names = (by_value(addition.rows[table]) for table in ("roles", "names"))
    for row in addition.rows["attributes"]:
        attribute, at = row["attribute"], (row["attribute"], row["value"])
        if not any(row[column] for column in ("value", "source", "note")):
            continue  # unknown, which is said best by saying nothing
        lines += ["", f"[[{attribute}]]"]
        lines += [f"{c} = {quoted(v)}" for c, v in row.items() if v and c not in PLACE]
        if at in names:
            lines.append(f"name = {quoted(names[at]['name'])}")
            lines += ["nearest = true"] * (names[at]["nearest"] == "true")
        if at in roles:
            lines.append(f"role = {quoted(roles[at]['role'])}")
            lines.append(f"role_note = {quoted(roles[at]['note'])}")
    for row in addition.rows["architectures"]:
        lines += ["", "[[architecture]]"]
        lines += [f"{c} = {quoted(v)}" for c, v in row.items() if v and c != "study"]
    return "\n".join(lines) + "\n"


KEYS = survey_data.load().extension_studies["key"]


@pytest.mark.parametrize(
    "key", [pytest.param(key, marks=[pytest.mark.slow] * (n % 4 > 0)) for n, key in enumerate(KEYS)]
)
def test_a_template_of_a_shipped_study_gives_back_its_rows(copy: Any, key: str) -> None:
    tables = load_texts([f"extension_{table}" for table in TABLES])
    rows = {
        name: tuple(row for row in getattr(tables, f"extension_{name}") if key in row.values())
        for name in TABLES
    }
    text = filled(Addition(key, rows))
    for name in TABLES:
        copy.edit(f"extension_{name}", lambda cells: cells.__delitem__(slice(1, None)))
    again = read_addition(parse_toml(text, "study.toml"), copy.directory)
    for name in TABLES:
        assert sorted(map(str, again.rows[name])) == sorted(map(str, rows[name]))


BIBTEX = """@phdthesis{doe, title = {A sun sensor that nobody built}, author = {Doe, Jane and
M{\\"u}ller, Max}, year = 2030, school = {Made-up University}, doi = {10.1234/made.up}}"""
RIS = """TY  - THES
AU  - Doe, Jane
AU  - Müller, Max
TI  - A sun sensor that nobody built
PY  - 2030/01/02
PB  - Made-up University
DO  - 10.1234/made.up
ER  -
"""


@pytest.mark.parametrize(("suffix", "text"), [("bib", BIBTEX), ("ris", RIS)])
def test_a_publication_is_read_from_each_kind_of_bibliography(
    tmp_path: Path, suffix: str, text: str
) -> None:
    (found,) = read_publications(offered(tmp_path, text, f"refs.{suffix}"))
    assert found == {
        "key": "Doe2030",
        "title": "A sun sensor that nobody built",
        "authors": "Jane Doe; Max Müller",
        "year": "2030",
        "venue": "Made-up University",
        "type": "thesis",
        "doi": "10.1234/made.up",
        "url": "",
    }
    assert choose([found], "Doe2030b", "refs") == {**found, "key": "Doe2030b"}


def test_one_of_several_publications_is_chosen_by_its_key(tmp_path: Path) -> None:
    other = BIBTEX.replace("{doe,", "{roe,").replace("Jane", "Ann").replace("made.up", "other")
    text = BIBTEX + "\n" + other.replace("Doe,", "Roe,")
    found = read_publications(offered(tmp_path, text, "refs.bib"))
    assert choose(found, "Roe2030", "refs.bib")["doi"] == "10.1234/other"
    with pytest.raises(FaultsError, match=r"holds 2 publications.*did you mean Roe2030"):
        choose(found, "Row2030", "refs.bib")


@pytest.mark.parametrize("text", ["", "{", '{"a": 1}', "[1]", "TY  - JOUR\n", "\x00\xff", "@x{,}"])
@pytest.mark.parametrize("suffix", ["bib", "ris", "toml", "pdf"])
def test_what_is_no_study_is_refused(recorded: Path, suffix: str, text: str) -> None:
    before = content(recorded)
    path = offered(recorded, text, f"refs.{suffix}")
    with pytest.raises(SurveyImportError):
        read_publications(path) if suffix in {"bib", "ris"} else read_study(path, recorded)
    assert content(recorded) == before
