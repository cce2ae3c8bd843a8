"""Writing a study's template: empty, with every word that may stand in it."""

from __future__ import annotations

import json
import re
import textwrap
from functools import partial
from pathlib import Path

from jinja2 import Environment, FileSystemLoader

from survey_data.additions.offered import Row
from survey_data.descriptor import DATA_DIRECTORY, column_types, descriptor
from survey_data.texts import load_texts
from survey_data.validation.extension import SURVEY_BASES

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
    said = {
        column: ", ".join(enums["extension_studies", column]) or _PUBLICATION.get(column, "")
        for column in column_types("extension_studies")
    }
    said["identity"] += f" ({_IDENTITIES})"
    bases = "; ".join(
        f"{row['basis']} ({_first(row['description'])})"
        for row in tables.bases
        if row["basis"] not in SURVEY_BASES
    )
    wrapped = textwrap.wrap(bases, 81, break_on_hyphens=False, break_long_words=False)
    statistics = [(each["kind"], each["name"]) for each in tables.statistics]
    words: dict[str, list[tuple[str, str]]] = {}
    for row in tables.taxonomy:
        words.setdefault(row["attribute"], []).append((row["value"], row["name"]))
    folder = Path(__file__).parent
    jinja = Environment(
        loader=FileSystemLoader(folder),
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,  # noqa: S701 - the text is TOML
    )
    jinja.filters["toml"] = partial(json.dumps, ensure_ascii=False)  # their escapes are alike
    return jinja.get_template("template.toml.jinja").render(
        publication=said,
        values={column: _stated(column, publication or {}) for column in said},
        bases="\n#             ".join(wrapped),
        roles=enums["extension_roles", "role"],
        attributes=[
            {
                **row,
                "words": statistics
                if row["kind"] == "statistic"
                else words.get(row["attribute"], []),
            }
            for row in tables.attribute_definitions
        ],
    )


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


def _stated(column: str, publication: Row) -> str | int | list[str]:
    """Return what is known of a column, as TOML has it."""
    value = publication.get(column, "")
    if column == "year" and re.fullmatch(r"[1-9][0-9]{0,3}", value):
        return int(value)
    return [n for n in value.split("; ") if n] if column == "authors" else value


def _first(text: str) -> str:
    """Return the first part of a description, as it stands inside a sentence."""
    said = re.split(r"[;,]", text)[0]
    return said[:1].lower() + said[1:]
