"""The survey's vocabulary: the values each attribute may take, their names and categories.

A *level* is an attribute, or something every value of an attribute implies: a model's category
and whether its calibration runs online, an extractor's family.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from survey_data import labels
from survey_data.nearest import nearest_name

Architecture = tuple[str, str]
"""Detector and mask, as values of the taxonomy."""

Pair = tuple[str, str]
"""Extractor and model, or chain, by their names."""

Plan = Mapping[Architecture, Mapping[Pair, Sequence[str]]]
"""Of each architecture that is simulated, its pipelines, and the data sets each is scored on. The
caller hands it in: `benchmark.plan` knows it."""

ATTRIBUTES = ("task", "error", "accuracy", "detector", "mask", "model", "extractor")
"""The categorical attributes of the survey's mapping."""

NUMERIC_ATTRIBUTES = ("accuracy_deg", "precision_deg", "fov_deg")
"""Numbers that studies state: accuracy, precision and full field of view, in degrees."""

DERIVED_LEVELS: Mapping[str, str] = MappingProxyType(
    {"model_category": "model", "calibration": "model", "extractor_family": "extractor"}
)
"""Pseudo-level -> the attribute whose values imply it."""

LEVELS = (*ATTRIBUTES, *DERIVED_LEVELS)

#: Similarity from which a value is suggested; many of the vocabulary's are short words.
_ALIKE = 0.5

NO_IMPLEMENTATION_STATED = "None"
"""The taxonomy's own value for a study without a model, an extractor or an error."""
NONE_STATED = "none stated"
"""That value in tables for others: programs that read tables take the word None for no value."""
NOT_IN_SURVEY = "own method, not in the survey"
"""That value of an implementation, for people: the survey has no such method."""
_OF_IMPLEMENTATIONS = frozenset({"taxonomy", "extractor_taxonomy", "model_taxonomy", "category"})

_CALIBRATION_NAMES = {"offline": "Offline calibration", "online": "Online calibration"}


def taxonomy_rows(column: str, value: Any) -> Any:
    """Return a cell as a table for others writes it, so that nothing reads ``None``.

    That is `NONE_STATED` for the taxonomy's "None", which is a value; None in columns that say what
    an implementation is called in the survey, where it means that the survey has no such method;
    any other value as it is.
    """
    if value != NO_IMPLEMENTATION_STATED:
        return value
    return None if column in _OF_IMPLEMENTATIONS else NONE_STATED


def taxonomy_row(row: Mapping[str, Any]) -> dict[str, Any]:
    """Return a row with every cell as `taxonomy_rows` gives it."""
    return {column: taxonomy_rows(column, value) for column, value in row.items()}


class InvalidValueError(ValueError):
    """A value that is not what its parameter takes.

    `expected` says in words what would have been right; `nearest` is the most similar valid value,
    None if nothing is similar.
    """

    def __init__(
        self, parameter: str, value: object, expected: str, nearest: str | None = None
    ) -> None:
        self.parameter = parameter
        self.value = value
        self.expected = expected
        self.nearest = nearest
        hint = f"; did you mean {nearest!r}?" if nearest is not None else ""
        super().__init__(f"{parameter}: expected {expected}; got {value!r}{hint}")

    def to_dict(self) -> dict[str, object]:
        """`parameter`, `value`, `expected`, `nearest` as in a problem document."""
        return {
            "parameter": self.parameter,
            "value": self.value,
            "expected": self.expected,
            "nearest": self.nearest,
        }


@dataclass(frozen=True)
class TaxonomyEntry:
    """One value of one attribute."""

    attribute: str
    value: str
    name: str
    category: str
    section: str  # label in the survey, "" where it has none
    calibration: str = ""  # of a model: offline, online (the middle ring of the sunburst)

    def to_dict(self) -> dict[str, str]:
        """`value`, `name`, `category`, `section` and what that names."""
        return {
            "value": self.value,
            "name": self.name,
            "category": self.category,
            "section": self.section,
            "section_name": labels.name(self.section),
        }


class Taxonomy:
    """The values of every attribute, in the survey's order; ValueError for one given twice."""

    def __init__(self, entries: Iterable[TaxonomyEntry]) -> None:
        table: dict[str, dict[str, TaxonomyEntry]] = {}
        for entry in entries:
            values = table.setdefault(entry.attribute, {})
            if entry.value in values:
                raise ValueError(f"taxonomy has {entry.attribute} {entry.value!r} twice")
            values[entry.value] = entry
        self._entries = table
        self._kinds: dict[tuple[str, str], tuple[str, ...]] = {}
        self._levels = {level: self._level_names(level) for level in self.levels}

    @property
    def attributes(self) -> tuple[str, ...]:
        """The attributes that have values here."""
        return tuple(self._entries)

    @property
    def levels(self) -> tuple[str, ...]:
        """Attributes and the pseudo-levels their values imply."""
        derived = [level for level, base in DERIVED_LEVELS.items() if base in self._entries]
        return (*self._entries, *derived)

    def entries(self, attribute: str) -> tuple[TaxonomyEntry, ...]:
        """Every entry of `attribute`; InvalidValueError if there is no such attribute."""
        return tuple(self._values_of(attribute).values())

    def entry(self, attribute: str, value: str) -> TaxonomyEntry:
        """One entry; InvalidValueError with the nearest value if there is none."""
        found = self._values_of(attribute).get(value)
        if found is None:
            raise self._unknown_value(attribute, value)
        return found

    def values(self, level: str) -> tuple[str, ...]:
        """Return the values of an attribute or pseudo-level."""
        return tuple(self._names_of(level))

    def name(self, level: str, value: str) -> str:
        """Return the full name of `value`; InvalidValueError if it is not one of `level`."""
        self.require(level, value)
        return self._levels[level][value]

    def category(self, attribute: str, value: str) -> str:
        """Return the category of `value`; InvalidValueError if it is not one of `attribute`."""
        return self.entry(attribute, value).category

    def require(self, level: str, value: str, parameter: str | None = None) -> None:
        """Raise InvalidValueError, naming the nearest value, unless `level` has `value`."""
        if value not in self._names_of(level):
            raise self._unknown_value(level, value, parameter)

    def nearest_value(self, level: str, text: str) -> str | None:
        """Return the value of `level` most like `text`, by value or name; None if none is."""
        names = self._names_of(level)
        spelled = {name.casefold(): value for value, name in names.items()}
        spelled |= {value.casefold(): value for value in names}
        found = nearest_name(text, spelled, cutoff=_ALIKE)
        return spelled[found] if found else None

    def kinds(self, attribute: str, value: str) -> tuple[str, ...]:
        """`value` and, where it is a parent such as ECM or ICM, its kinds (ECM/Noise, ...)."""
        found = self._kinds.get((attribute, value))
        if found is None:
            self.require(attribute, value)
            prefix = f"{value}/"
            kinds = (v for v in self._entries[attribute] if v.startswith(prefix))
            found = self._kinds[attribute, value] = (value, *kinds)
        return found

    def derived_values(self, level: str, value: str) -> str:
        """Return what `value` of the level's attribute means at `level`."""
        if level not in DERIVED_LEVELS:
            return value
        if level == "calibration":
            if value == NO_IMPLEMENTATION_STATED:
                return NO_IMPLEMENTATION_STATED
            return self.entry("model", value).calibration or "offline"
        return self.category(DERIVED_LEVELS[level], value)

    def to_dict(self) -> dict[str, list[dict[str, str]]]:
        """Attribute -> its entries."""
        return {a: [e.to_dict() for e in values.values()] for a, values in self._entries.items()}

    def _values_of(self, attribute: str) -> dict[str, TaxonomyEntry]:
        if attribute not in self._entries:
            raise unknown_name("attribute", attribute, self._entries)
        return self._entries[attribute]

    def _names_of(self, level: str) -> dict[str, str]:
        if level not in self._levels:
            raise unknown_name("level", level, self._levels)
        return self._levels[level]

    def _unknown_value(
        self, level: str, value: str, parameter: str | None = None
    ) -> InvalidValueError:
        return InvalidValueError(
            parameter or level,
            value,
            f"one of {', '.join(self._names_of(level))}",
            self.nearest_value(level, str(value)),
        )

    def _level_names(self, level: str) -> dict[str, str]:
        if level not in DERIVED_LEVELS:
            return {value: entry.name for value, entry in self._entries[level].items()}
        base = self._entries[DERIVED_LEVELS[level]]
        implied = dict.fromkeys(self.derived_values(level, value) for value in base)
        return {value: _CALIBRATION_NAMES.get(value, value) for value in implied}


def attribute_of(level: str) -> str:
    """Return the attribute a level is read from: itself, or the one that implies it."""
    return DERIVED_LEVELS.get(level, level)


def unknown_name(
    parameter: str, value: object, names: Sequence[str] | Iterable[str]
) -> InvalidValueError:
    """Return the error for a name that is none of `names`."""
    known = list(names)
    return InvalidValueError(
        parameter,
        value,
        f"one of {', '.join(known)}",
        nearest_name(str(value), known, cutoff=_ALIKE),
    )
