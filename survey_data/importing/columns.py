"""Which column of another table is which of ours, by the names of both."""

from __future__ import annotations

import re
from collections.abc import Mapping

import pandas as pd
from pydantic import BaseModel

from survey_data.importing.values import normalise, similarity
from survey_data.nearest import nearest_name
from survey_data.problems import SurveyImportError
from survey_data.tables import SurveyTables

IGNORE = "-"
_LEAST_SCORE = 0.8
_NUMBER = r"[<≤±~]?\s*[0-9].*"
# How tables of studies usually name their bibliographic columns, alone or among other words.
_IDENTIFICATION = {
    "study": ("study", "key", "bibtex", "reference", "ref", "id"),
    "title": ("title",),
    "authors": ("authors",),
    "year": ("year", "date"),
}


class ColumnMatch(BaseModel, frozen=True):
    """A column and what it was taken for; `how` is ``similarity`` or ``override``.

    `score` is the likeness of the names, from 0 to 1.
    """

    column: str
    target: str
    score: float
    how: str = "similarity"


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

    Columns are matched one to one by their names, the likeliest pair first; numbered columns
    (``Task 1``, ``Task 2``) follow the one that was matched. A column of accuracies holds classes
    or numbers, as most of its cells do. `overrides` give a column's target: study, title, authors,
    year or an attribute, or ``-`` to leave it aside; values of several columns of one attribute
    are united.

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
    taken = {
        column: ColumnMatch(column=column, target=target, score=1.0, how="override")
        for column, target in given.items()
        if target != IGNORE
    }
    found = [
        ColumnMatch(column=column, target=target, score=_score(column, names))
        for column in columns
        for target, names in labels.items()
        if column not in given and _can_hold(frame[column], target)
    ]
    for match in sorted(found, key=lambda m: -m.score):
        if match.score < _LEAST_SCORE:
            break
        if match.column not in taken and match.target not in {m.target for m in taken.values()}:
            taken[match.column] = match
    stems = {_stem(m.column): m.target for m in taken.values() if m.target not in _IDENTIFICATION}
    for column in columns:  # numbered ones
        target = stems.get(_stem(column))
        if target is not None and column not in given and column not in taken:
            score = _score(column, labels[target])
            taken[column] = ColumnMatch(column=column, target=target, score=score)
    mapping = ColumnMapping(
        matches=tuple(taken[column] for column in columns if column in taken),
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


def _score(column: str, names: tuple[str, ...]) -> float:
    """Return how like a column's name is to one of the names of a target."""
    plain = normalise(column)
    found = [0.0]
    for label in map(normalise, names):
        within = set(label.split()) <= set(plain.split())
        found.append(max(similarity(plain, label), 0.8 * within))
    return round(max(found), 3)


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
