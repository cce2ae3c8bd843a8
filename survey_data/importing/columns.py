"""Which column of another table is which of ours, by the names and by what the cells hold."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

import pandas as pd

from files.json_data import JsonData
from survey_data.importing.text_similarity import normalise, similarity
from survey_data.importing.values import UnreadableValueError, ValueReader, column_unit
from survey_data.nearest import nearest_name
from survey_data.problems import SurveyImportError
from survey_data.tables import SurveyTables

IGNORE = "-"
_LEAST_SCORE = 0.6
_NAME_WEIGHT = 0.4
# How tables of studies usually name their bibliographic columns.
_IDENTIFICATION = {
    "study": ("study", "key", "citation key", "cite key", "bibtex key", "reference", "ref", "id"),
    "title": ("title", "paper title", "publication title"),
    "authors": ("authors", "author", "author list", "first author"),
    "year": ("year", "publication year", "year published", "date"),
}


@dataclass(frozen=True)
class ColumnMatch:
    """A column and what it was taken for.

    `name_score` and `value_score` are from 0 to 1 (`value_score` is None where cells say nothing
    on the matter); `how` is ``similarity`` or ``override``.
    """

    column: str
    target: str
    score: float
    name_score: float
    value_score: float | None
    how: str


@dataclass(frozen=True)
class ColumnMapping(JsonData):
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


def targets(tables: SurveyTables) -> tuple[str, ...]:
    """Return what a column can be mapped to: study, title, authors, year and every attribute."""
    names = tables.attribute_definitions["attribute"]
    return (*_IDENTIFICATION, *(str(name) for name in names))


def match_columns(
    tables: SurveyTables, frame: pd.DataFrame, overrides: Mapping[str, str] | None = None
) -> ColumnMapping:
    """Match the columns of a table to studies and attributes.

    Parameters
    ----------
    tables : SurveyTables
        Ours: the attributes, their vocabulary and the studies.
    frame : pandas.DataFrame
        Theirs, as `read_table` returns it.
    overrides : mapping of str to str, optional
        Column -> target (see `targets`), or ``-`` to leave the column aside. Several columns may
        be given the same attribute; their values are united.

    Returns
    -------
    ColumnMapping
        Columns are matched one to one, the likeliest pair first; numbered columns (``Task 1``,
        ``Task 2``) follow the one that was matched.

    Raises
    ------
    SurveyImportError
        An override names an unknown column or target, or no column identifies the study, or
        none holds an attribute.
    """
    known = targets(tables)
    given = _check_overrides(frame, known, overrides or {})
    scorer = _Scorer(tables)
    taken: dict[str, ColumnMatch] = {}
    for column, target in given.items():
        if target != IGNORE:
            name, values = scorer.name(column, target), scorer.values(frame[column], target)
            taken[column] = ColumnMatch(column, target, 1.0, name, values, "override")
    for match in _candidates(frame, known, scorer):
        used = {other.target for other in taken.values()}
        if match.column not in given and match.column not in taken and match.target not in used:
            taken[match.column] = match
    _add_numbered(frame, given, taken, scorer)
    mapping = ColumnMapping(
        matches=tuple(taken[column] for column in frame.columns if column in taken),
        ignored=tuple(str(column) for column in frame.columns if column not in taken),
    )
    _check_sufficient(frame, mapping)
    return mapping


def _candidates(frame: pd.DataFrame, known: tuple[str, ...], scorer: _Scorer) -> list[ColumnMatch]:
    found = []
    for column in frame.columns:
        for target in known:
            name, values = scorer.name(column, target), scorer.values(frame[column], target)
            score = scorer.combine(target, name, values)
            if score >= _LEAST_SCORE:
                match = ColumnMatch(
                    str(column), target, round(score, 3), name, values, "similarity"
                )
                found.append(match)
    order = {str(column): position for position, column in enumerate(frame.columns)}
    found.sort(key=lambda m: (-m.score, -m.name_score, order[m.column], known.index(m.target)))
    return found


def _add_numbered(
    frame: pd.DataFrame,
    given: Mapping[str, str],
    taken: dict[str, ColumnMatch],
    scorer: _Scorer,
) -> None:
    stems = {
        _stem(match.column): match.target
        for match in taken.values()
        if match.target not in _IDENTIFICATION
    }
    for column in map(str, frame.columns):
        target = stems.get(_stem(column))
        if column in given or column in taken or target is None:
            continue
        name, values = scorer.name(column, target), scorer.values(frame[column], target)
        score = round(scorer.combine(target, name, values), 3)
        taken[column] = ColumnMatch(column, target, score, name, values, "similarity")


def _stem(column: str) -> str:
    return re.sub(r"\s*[0-9]+$", "", normalise(column))


def _check_overrides(
    frame: pd.DataFrame, known: tuple[str, ...], overrides: Mapping[str, str]
) -> dict[str, str]:
    for column, target in overrides.items():
        if column not in frame.columns:
            columns = [str(name) for name in frame.columns]
            raise SurveyImportError(
                f"no such column{_nearest(column, columns)}; there are {', '.join(columns)}",
                column=column,
            )
        if target not in known and target != IGNORE:
            raise SurveyImportError(
                f"cannot be mapped to {target!r}{_nearest(target, list(known))}; "
                f"expected {', '.join(known)} or {IGNORE}",
                column=column,
            )
    for target in _IDENTIFICATION:
        columns = [column for column, chosen in overrides.items() if chosen == target]
        if len(columns) > 1:
            raise SurveyImportError(f"{target} takes one column, got {columns}", column=columns[1])
    return dict(overrides)


def _nearest(text: str, names: list[str]) -> str:
    near = nearest_name(text, names, cutoff=0.5)
    return f" (did you mean {near!r}?)" if near else ""


def _check_sufficient(frame: pd.DataFrame, mapping: ColumnMapping) -> None:
    columns = ", ".join(map(str, frame.columns))
    has = {match.target for match in mapping.matches}
    if not ({"study", "title"} & has or {"authors", "year"} <= has):
        raise SurveyImportError(
            "no column identifies the study: expected a key, a title, or authors and year among "
            f"{columns}; name it with an override"
        )
    if not mapping.attributes:
        raise SurveyImportError(
            f"no column holds an attribute among {columns}; name it with an override"
        )


class _Scorer:
    """Scores a column for a target, remembering what the cells were read as."""

    def __init__(self, tables: SurveyTables) -> None:
        self._reader = ValueReader(tables)
        self._labels: dict[str, tuple[str, ...]] = dict(_IDENTIFICATION)
        for row in tables.attribute_definitions.to_dict("records"):
            spellings = (row["attribute"], row["name"], *str(row["synonyms"]).split(";"))
            self._labels[str(row["attribute"])] = tuple(map(str, spellings))
        self._categorical = {
            target
            for target in self._labels
            if target not in _IDENTIFICATION and not self._reader.is_numeric(target)
        }
        references = tables.references["key"].dropna()
        self._keys = {str(key).casefold() for key in [*tables.studies["key"], *references]}
        self._titles = {normalise(str(title)) for title in tables.studies["title"].dropna()}
        self._readable: dict[tuple[str, str, str], bool] = {}

    def name(self, column: object, target: str) -> float:
        """Return how much a column's name is like a target's names."""
        plain = normalise(str(column))
        best = 0.0
        for label in map(normalise, self._labels[target]):
            score = similarity(plain, label)
            if set(label.split()) <= set(plain.split()):
                score = max(score, 0.8)
            best = max(best, score)
        return round(best, 3)

    def values(self, cells: pd.Series, target: str) -> float | None:
        """Return the share of a column's cells that can be a target's; None: they say nothing."""
        texts = [str(cell) for cell in cells.dropna()]
        if not texts:
            return 0.0
        if target == "authors":
            return None
        unit = column_unit(str(cells.name))
        fitting = sum(self._fits(text, target, unit) for text in texts)
        return round(fitting / len(texts), 3)

    def _fits(self, text: str, target: str, unit: str) -> bool:
        if target == "study":
            return text.casefold() in self._keys
        if target == "title":
            return normalise(text) in self._titles
        if target == "year":
            return re.fullmatch(r"(19|20)[0-9]{2}", text) is not None
        if target == "accuracy" and re.match(r"[<≤±~]?\s*[0-9]", text):
            return False  # a number is the reported accuracy, not its class
        cell = (target, text, unit)
        if cell not in self._readable:
            try:
                self._readable[cell] = bool(self._reader.read(target, text, unit))
            except UnreadableValueError:
                self._readable[cell] = False
        return self._readable[cell]

    def combine(self, target: str, name: float, values: float | None) -> float:
        """Return the score of a column for a target."""
        identifies = target in {"study", "title"}
        if values is None:
            return name
        if identifies or target in self._categorical:
            score = _NAME_WEIGHT * name + (1 - _NAME_WEIGHT) * values
        else:
            score = name if values >= 0.5 else 0.0  # numbers fit many columns: the name decides
        # A column called as ours is not passed over for cells that cannot be read: they are shown.
        called_so = name == 1.0 and (values > 0 or identifies)
        return max(score, _LEAST_SCORE) if called_so else score
