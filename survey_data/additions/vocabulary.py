"""The words that a template may use, as the tables and their descriptor have them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from survey_data.descriptor import DATA_DIRECTORY, descriptor
from survey_data.sources import Host
from survey_data.texts import load_texts
from survey_data.validation.extension import SURVEY_BASES

_TABLES = (
    *("studies", "extension_studies", "references"),
    *("taxonomy", "attribute_definitions", "bases", "aliases", "statistics", "sources"),
)


@dataclass(frozen=True)
class Definition:
    """An attribute: its words with their names, or the limits of its number.

    ``has_names`` says whether a study may have a name of its own for a value: the taxonomy's
    values.
    """

    attribute: str
    name: str
    description: str
    words: Mapping[str, str]
    multiple: bool
    complete: bool
    minimum: float
    maximum: float
    has_names: bool


@dataclass(frozen=True)
class Vocabulary:
    """What is allowed in a template.

    ``bases`` and ``words`` (by column of the study) are closed lists, ``patterns`` what a text has
    to match, ``forms`` the same for people, ``used_names`` keys and DOIs in lower case with whose
    they are, ``hosts`` who publishes where (`survey_data.sources`), ``spellings`` other names of an
    attribute's values, written ``spelling=value``.
    """

    definitions: Mapping[str, Definition]
    bases: Mapping[str, str]
    words: Mapping[str, Sequence[str]]
    patterns: Mapping[str, str]
    years: tuple[int, int]
    roles: Sequence[str]
    used_names: Mapping[str, str]
    hosts: Mapping[str, Host]
    spellings: Mapping[str, Sequence[str]]
    forms: Mapping[str, str] = field(
        default_factory=lambda: {
            "key": "letters, four digits of the year and at most one small letter",
            "doi": "a DOI such as 10.3390/s21010001",
            "url": "an address that starts with https:// or http://",
        }
    )


def vocabulary(directory: Path = DATA_DIRECTORY) -> Vocabulary:
    """Read the vocabulary.

    Raises
    ------
    SurveyDataError
        A table cannot be read.
    """
    tables = load_texts(_TABLES, directory)
    constraints = {
        name: {f["name"]: f.get("constraints", {}) for f in _fields(name)}
        for name in ("extension_studies", "extension_roles")
    }
    studies = constraints["extension_studies"]
    taken: dict[str, str] = {}
    for row in tables.references:
        taken[row["key"].casefold()] = "the survey cites another work under this key"
    for table, whose in (("studies", "of the survey"), ("extension_studies", "added already")):
        for row in getattr(tables, table):
            taken[row["key"].casefold()] = f"a study {whose} has this key"
            taken[row["doi"].casefold()] = f"{row['key']}, a study {whose}, has this DOI"
    taken.pop("", None)
    spellings: dict[str, list[str]] = {}
    for row in tables.aliases:
        spellings.setdefault(row["attribute"], []).append(f"{row['alias']}={row['value']}")
    for row in tables.taxonomy:
        spellings.setdefault(row["attribute"], []).append(f"{row['name']}={row['value']}")
    return Vocabulary(
        definitions={
            row["attribute"]: _definition(row, tables) for row in tables.attribute_definitions
        },
        bases={
            row["basis"]: row["description"]
            for row in tables.bases
            if row["basis"] not in SURVEY_BASES
        },
        words={name: found["enum"] for name, found in studies.items() if "enum" in found},
        patterns={name: found["pattern"] for name, found in studies.items() if "pattern" in found},
        years=(int(studies["year"]["minimum"]), int(studies["year"]["maximum"])),
        roles=constraints["extension_roles"]["role"]["enum"],
        used_names=taken,
        hosts={row["host"]: Host(**row) for row in tables.sources},
        spellings=spellings,
    )


def _fields(table: str) -> list[dict[str, Any]]:
    found = next(each for each in descriptor()["resources"] if each["name"] == table)
    fields: list[dict[str, Any]] = found["schema"]["fields"]
    return fields


def _words(row: Mapping[str, str], tables: Any) -> dict[str, str]:
    """Return the values of an attribute with their names; none of a number."""
    if row["kind"] == "statistic":
        return {each["kind"]: each["name"] for each in tables.statistics}
    attribute = row["attribute"]
    return {e["value"]: e["name"] for e in tables.taxonomy if e["attribute"] == attribute}


def _definition(row: Mapping[str, str], tables: Any) -> Definition:
    return Definition(
        attribute=row["attribute"],
        name=row["name"],
        description=row["description"],
        words=_words(row, tables),
        multiple=row["multiple"] != "false",
        complete=row["complete"] == "true",
        minimum=float(row["min"] or "-inf"),
        maximum=float(row["max"] or "inf"),
        has_names=row["kind"] == "categorical",
    )
