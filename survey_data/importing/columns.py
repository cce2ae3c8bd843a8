"""Which column of another table is which of ours, by the names of both."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import product

import pandas as pd
from pydantic import BaseModel

from survey_data.importing.values import normalise
from survey_data.nearest import nearest_name
from survey_data.problems import SurveyImportError
from survey_data.tables import SurveyTables

IGNORE = "-"
_NUMBER = r"[<≤±~]?\s*[0-9].*"
# How tables of studies usually name their bibliographic columns, alone or among other words.
_IDENTIFICATION = {
    "study": ("study", "key", "bibtex", "reference", "ref", "id"),
    "title": ("title",),
    "authors": ("authors",),
    "year": ("year", "date"),
}


class ColumnMatch(BaseModel, frozen=True):
    """A column and what it was taken for."""

    column: str
    target: str


class ColumnMapping(BaseModel):
    """Every column taken, in the order of the table, and the columns left aside."""

    matches: tuple[ColumnMatch, ...]
    ignored: tuple[str, ...]

    def columns(self, target: str) -> tuple[str, ...]:
        """Return the columns taken for a target."""
        return tuple(match.column for match in self.matches if match.target == target)

    @property
    def attributes(self) -> tuple[str, ...]:
        """Return the attributes that have a column, in the order of the table."""
        targets = (match.target for match in self.matches)
        return tuple(dict.fromkeys(name for name in targets if name not in _IDENTIFICATION))


def match_columns(
    tables: SurveyTables, frame: pd.DataFrame, overrides: Mapping[str, str] | None = None
) -> ColumnMapping:
    """Match the columns of a table, as `read_table` gives it, to studies and attributes.

    Columns are matched one to one: a name of the target is the column's name or, failing that, all
    of its words are in it; numbered columns (``Task 1``, ``Task 2``) follow the one that was
    matched. A column of accuracies holds classes or numbers, as most of its cells do. `overrides`
    give a column's target: study, title, authors, year or an attribute, or ``-`` to leave it aside;
    values of several columns of one attribute are united.

    Raises
    ------
    SurveyImportError
        An override names an unknown column or target, or no column identifies the study, or none
        holds an attribute.
    """
    labels = dict(_IDENTIFICATION)
    for row in tables.attribute_definitions.to_dict("records"):
        attribute = str(row["attribute"])
        labels[attribute] = (attribute, row["name"], *str(row["synonyms"]).split(";"))
    given = dict(overrides or {})
    columns = [str(name) for name in frame.columns]
    _check_overrides(columns, list(labels), given)
    taken = {column: target for column, target in given.items() if target != IGNORE}
    for is_named in (_is_one, _is_within):
        for column, (target, names) in product(columns, labels.items()):
            free = column not in {*given, *taken} and target not in taken.values()
            if free and is_named(column, names) and _can_hold(frame[column], target):
                taken[column] = target
    stems = {_stem(c): target for c, target in taken.items() if target not in _IDENTIFICATION}
    for column in columns:  # numbered ones
        if _stem(column) in stems and column not in given:
            taken.setdefault(column, stems[_stem(column)])
    mapping = ColumnMapping(
        matches=tuple(ColumnMatch(column=c, target=taken[c]) for c in columns if c in taken),
        ignored=tuple(column for column in columns if column not in taken),
    )
    targets = {match.target for match in mapping.matches}
    missing = "" if mapping.attributes else "no column holds an attribute"
    if not ({"study", "title"} & targets or {"authors", "year"} <= targets):
        missing = "no column identifies the study: expected a key, a title, or authors and year"
    if missing:
        listed = ", ".join(columns)
        raise SurveyImportError(f"{missing} among {listed}; name it with an override")
    return mapping


def _is_one(column: str, names: Sequence[str]) -> bool:
    return normalise(column) in map(normalise, names)


def _is_within(column: str, names: Sequence[str]) -> bool:
    words = set(normalise(column).split())
    return any(words.issuperset(normalise(name).split()) for name in names)


def _can_hold(cells: pd.Series, target: str) -> bool:
    """Say whether a column's cells are numbers where the target takes numbers, else words."""
    stated = cells.dropna().astype(str)
    if stated.empty or target in _IDENTIFICATION or target.endswith("_kind"):
        return not stated.empty or target in _IDENTIFICATION
    share = float(stated.str.fullmatch(_NUMBER).mean())
    return share >= 0.5 if target.endswith("_deg") else share < 0.5


def _stem(column: str) -> str:
    return re.sub(r"\s*[0-9]+$", "", normalise(column))


def _check_overrides(columns: list[str], known: list[str], given: Mapping[str, str]) -> None:
    for column, target in given.items():
        message = ""
        if column not in columns:
            message = f"no such column{_nearest(column, columns)}; there are {', '.join(columns)}"
        elif target not in known and target != IGNORE:
            listed = f"expected {', '.join(known)} or {IGNORE}"
            message = f"cannot be mapped to {target!r}{_nearest(target, known)}; {listed}"
        elif target in _IDENTIFICATION and list(given.values()).count(target) > 1:
            named = [name for name, chosen in given.items() if chosen == target]
            message = f"{target} takes one column, got {named}"
        if message:
            raise SurveyImportError(message, column=column)


def _nearest(text: str, names: list[str]) -> str:
    near = nearest_name(text, names, cutoff=0.5)
    return f" (did you mean {near!r}?)" if near else ""
