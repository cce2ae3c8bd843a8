"""Which column of another table is which of ours, by the names and by what the cells hold."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cache

import pandas as pd
from pydantic import BaseModel

from survey_data.importing.values import (
    UnreadableValueError,
    ValueReader,
    column_unit,
    normalise,
    similarity,
)
from survey_data.nearest import nearest_name
from survey_data.problems import SurveyImportError
from survey_data.tables import SurveyTables

IGNORE = "-"
_LEAST_SCORE = 0.6
_NAME_WEIGHT = 0.4
_MOST_READ = 500  # different cells of a column, enough to tell what it holds
# How tables of studies usually name their bibliographic columns.
_IDENTIFICATION = {
    "study": ("study", "key", "citation key", "cite key", "bibtex key", "reference", "ref", "id"),
    "title": ("title", "paper title", "publication title"),
    "authors": ("authors", "author", "author list", "first author"),
    "year": ("year", "publication year", "year published", "date"),
}


class ColumnMatch(BaseModel, frozen=True):
    """A column and what it was taken for.

    `name_score` and `value_score` are from 0 to 1 (`value_score` is None where cells say nothing
    on the matter); `how` is ``similarity`` or ``override``.
    """

    column: str
    target: str
    score: float
    name_score: float
    value_score: float | None
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

    Columns are matched one to one, the likeliest pair first; numbered columns (``Task 1``, ``Task
    2``) follow the one that was matched. `overrides` give a column's target: study, title, authors,
    year or an attribute, or ``-`` to leave it aside; values of several columns of one attribute are
    united.

    Raises
    ------
    SurveyImportError
        An override names an unknown column or target, or no column identifies the study, or none
        holds an attribute.
    """
    scorer = _Scorer(tables, frame)
    known = list(scorer.labels)
    given = dict(overrides or {})
    columns = [str(name) for name in frame.columns]
    _check_overrides(columns, known, given)
    taken = {
        column: scorer.match(column, target).model_copy(update={"score": 1.0, "how": "override"})
        for column, target in given.items()
        if target != IGNORE
    }
    found = [scorer.match(column, target) for column in columns for target in known]
    found = [match for match in found if match.score >= _LEAST_SCORE and match.column not in given]
    for match in sorted(found, key=lambda m: (-m.score, -m.name_score)):
        if match.column not in taken and match.target not in {m.target for m in taken.values()}:
            taken[match.column] = match
    stems = {_stem(m.column): m.target for m in taken.values() if m.target not in _IDENTIFICATION}
    for column in columns:  # numbered ones
        if column not in given and column not in taken and _stem(column) in stems:
            taken[column] = scorer.match(column, stems[_stem(column)])
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


class _Scorer:
    """Scores columns of a table for targets, remembering what the cells were read as."""

    def __init__(self, tables: SurveyTables, frame: pd.DataFrame) -> None:
        self._frame = frame
        reader = ValueReader(tables)
        self.labels: dict[str, tuple[str, ...]] = dict(_IDENTIFICATION)
        self._numeric, self._words = set(), set()
        for row in tables.attribute_definitions.to_dict("records"):
            attribute = str(row["attribute"])
            self.labels[attribute] = (attribute, row["name"], *str(row["synonyms"]).split(";"))
            if reader.is_numeric(attribute):
                self._numeric.add(attribute)
            elif row["kind"] == "categorical":
                self._words.add(attribute)
        references = tables.references["key"].dropna()
        self._keys = {str(key).casefold() for key in [*tables.studies["key"], *references]}
        self._titles = {normalise(str(title)) for title in tables.studies["title"].dropna()}

        @cache
        def is_value(target: str, text: str, unit: str) -> bool:
            try:
                return bool(reader.read(target, text, unit))
            except UnreadableValueError:
                return False

        self._is_value = is_value

    def match(self, column: str, target: str) -> ColumnMatch:
        """Return how well a column fits a target."""
        name, values = max(self._names(column, target)), self._values(column, target)
        identifies = target in {"study", "title"}
        if values is None:
            score = name
        elif identifies or target not in {*_IDENTIFICATION, *self._numeric}:
            score = _NAME_WEIGHT * name + (1 - _NAME_WEIGHT) * values
        else:
            score = name if values >= 0.5 else 0.0  # numbers fit many columns: the name decides
        # A column called as ours is not passed over for cells that cannot be read: they are shown.
        if name == 1.0 and values is not None and (values > 0 or identifies):
            score = max(score, _LEAST_SCORE)
        return ColumnMatch(
            column=column,
            target=target,
            score=round(score, 3),
            name_score=round(name, 3),
            value_score=values,
        )

    def _names(self, column: str, target: str) -> Iterator[float]:
        plain = normalise(column)
        for label in map(normalise, self.labels[target]):
            yield similarity(plain, label)
            if set(label.split()) <= set(plain.split()):
                yield 0.8

    def _values(self, column: str, target: str) -> float | None:
        """Return the share of a column's cells that can be a target's; None: they say nothing."""
        counts = self._frame[column].dropna().value_counts(sort=False)[:_MOST_READ]
        if counts.empty:
            return 0.0
        if target == "authors":
            return None
        unit = column_unit(column)
        fitting = sum(n for text, n in counts.items() if self._fits(str(text), target, unit))
        return round(fitting / int(counts.sum()), 3)

    def _fits(self, text: str, target: str, unit: str) -> bool:
        if target == "study":
            return text.casefold() in self._keys
        if target == "title":
            return normalise(text) in self._titles
        if target == "year":
            return re.fullmatch(r"(19|20)[0-9]{2}", text) is not None
        if target == "accuracy" and re.match(r"[<≤±~]?\s*[0-9]", text):
            return False  # a number is the reported accuracy, not its class
        if target in self._words and re.fullmatch(r"[-+0-9.,e]+", text):
            return False
        return self._is_value(target, text, unit)
