"""Writing a study's template: empty, with every word that may stand in it."""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from survey_data.additions.offered import Row
from survey_data.descriptor import DATA_DIRECTORY, column_types, descriptor
from survey_data.texts import load_texts
from survey_data.validation.extension import SURVEY_BASES

_HEAD = """\
# A study for `sunatlas survey add FILE`. Fill in what you know and take away the rest: an attribute
# without a [[table]] is unknown, and so is one with the basis "unknown" (its note says why).
# Lines that start with # say nothing; take the # away where a line shall count.
"""
_PUBLICATION = {
    "key": "surname of the first author (plain letters), year, a letter where the key is taken",
    "title": "as printed",
    "authors": 'a list: ["First Last", "First Last"]',
    "year": "as in the key",
    "venue": "journal, conference, repository or school, then volume and pages",
    "doi": "without https://doi.org/; a DOI or a url is needed",
    "url": "page of the publisher or the repository, no mirror",
    "note": "a remark",
}
_IDENTITIES = "confirmed: you saw the page; recalled: from memory"
_EVIDENCE = """\
# ---- The attributes: one [[table]] a value, as many as there are.
#   value     from the list above it, or a number
#   basis     {bases}
#   source    address or DOI of what was read; needed with full-text and abstract
#   note      the words or the reason; needed with inferred and recalled
#   name      what the study calls it, where that is not the name in the list (optional)
#   nearest   true where the list has no such value and this one is only the nearest: then `name`
#             is needed, and nothing that runs this value counts as the study's own (optional)
#   role      of a model or an extractor: {roles}; role_note says why (optional)
"""
_SENSORS = """\
# ---- Only where a study has several detectors and several masks: which goes with which.
# [[architecture]]
# detector = ""
# mask = ""
# basis = ""
# source = ""
# note = ""
"""


def empty_template(directory: Path = DATA_DIRECTORY, publication: Row | None = None) -> str:
    """Return an empty template, with the words that our tables allow in comments.

    `publication` is what is known of it already, by column of the table of studies.
    """
    tables = load_texts(("attribute_definitions", "bases", "taxonomy", "statistics"), directory)
    enums = {
        (resource["name"], field["name"]): field.get("constraints", {}).get("enum", [])
        for resource in descriptor()["resources"]
        for field in resource["schema"]["fields"]
    }
    lines = [_HEAD, "# ---- The publication."]
    for column in column_types("extension_studies"):
        said = ", ".join(enums["extension_studies", column]) or _PUBLICATION.get(column, "")
        if column == "identity":
            said += f" ({_IDENTITIES})"
        value = _format_value(column, (publication or {}).get(column, ""))
        lines += [f"# {column}: {said}", f"{column} = {value}"]
    bases = "; ".join(
        f"{row['basis']} ({_first(row['description'])})"
        for row in tables.bases
        if row["basis"] not in SURVEY_BASES
    )
    wrapped = textwrap.wrap(bases, 81, break_on_hyphens=False, break_long_words=False)
    roles = ", ".join(enums["extension_roles", "role"])
    lines += ["", _EVIDENCE.format(bases="\n#             ".join(wrapped), roles=roles)]
    for row in tables.attribute_definitions:
        lines += [*_of_attribute(row, tables), ""]
    return "\n".join([*lines, _SENSORS])


def taken_by(key: str, directory: Path = DATA_DIRECTORY) -> str:
    """Say which study has a key already; empty where none has."""
    tables = load_texts(("studies", "extension_studies", "references"), directory)
    whose = {
        "references": "the survey cites another work under this key",
        "studies": "a study of the survey has this key",
        "extension_studies": "a study added already has this key",
    }
    for table, said in whose.items():
        if key.casefold() in {row["key"].casefold() for row in getattr(tables, table)}:
            return said
    return ""


def _of_attribute(row: Mapping[str, str], tables: Any) -> Iterator[str]:
    """Give the lines of one attribute: what it is, what it may be, an empty table."""
    attribute = row["attribute"]
    several = "" if row["multiple"] != "false" else "; one value"
    yield f"# {attribute}: {row['description']}{several}."
    words = [(r["value"], r["name"]) for r in tables.taxonomy if r["attribute"] == attribute]
    if row["kind"] == "statistic":
        words = [(each["kind"], each["name"]) for each in tables.statistics]
    for value, name in words:
        yield f"#   {value}" + ("" if name == value else f": {name}")
    if not words:
        yield f"#   a number from {float(row['min']):g} to {float(row['max']):g}"
    yield f"# [[{attribute}]]"
    yield '# value = ""' if words else "# value ="
    yield from ('# basis = ""', '# source = ""', '# note = ""')


def _format_value(column: str, value: str) -> str:
    """Return a column of the study as TOML, whose escapes of a text are those of JSON."""
    if column == "year" and re.fullmatch(r"[1-9][0-9]{0,3}", value):
        return value
    if column == "authors":
        return json.dumps([n for n in value.split("; ") if n], ensure_ascii=False)
    return json.dumps(value, ensure_ascii=False)


def _first(text: str) -> str:
    """Return the first part of a description, as it stands inside a sentence."""
    said = re.split(r"[;,]", text)[0]
    return said[:1].lower() + said[1:]
