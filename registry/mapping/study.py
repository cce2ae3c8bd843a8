"""A study of the survey's mapping or after it: its values, with the provenance of each."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

from registry.taxonomy import NUMERIC_ATTRIBUTES, unknown_name
from survey_data.editions import SURVEY
from survey_data.json_data import JsonData
from survey_data.reported import KIND_OF, Quantity, ReportedAccuracy, reported_accuracies
from survey_data.sources import source_named

METHODS = ("model", "extractor")
"""Attributes whose values a study proposes, or only compares against."""


@dataclass(frozen=True)
class AttributeValue:
    """A value of one of a study's attributes, and where it comes from."""

    value: str
    basis: str  # of survey_data/bases.csv, such as survey-table, abstract, inferred
    source: str
    note: str


@dataclass(frozen=True)
class MethodRole:
    """Whether a study proposed a method or only compared another against it, and who says so."""

    role: str  # proposed, compared
    basis: str
    source: str
    note: str


@dataclass(frozen=True)
class NameInStudy:
    """What a study itself calls one of its values.

    ``is_nearest`` says that the taxonomy has no such value and that the one given is only the
    nearest to it: what runs that value is not the study's own.
    """

    name: str
    is_nearest: bool


@dataclass(frozen=True)
class Verification(JsonData):
    """Who confirmed what of a study, on which day, and where that can be seen."""

    name: str
    date: str
    confirms: str
    source: str


@dataclass(frozen=True)
class Study:
    """One study of the survey's mapping, or one after it (`edition`).

    ``values`` holds the stated values only; an attribute whose cell is empty is absent from it
    and stands in ``unknown`` with the note beside the empty cell. ``roles`` are those of
    (attribute, value), where one is known; ``combinations`` says which detector goes with which
    mask where not every one goes with every other. ``names`` are what a study outside the survey
    calls its values of (attribute, value); ``verifications`` who confirmed what is said here.
    """

    key: str
    title: str
    authors: str
    year: int | None
    venue: str
    doi: str
    url: str
    identity: str  # confirmed, recalled, ambiguous, unknown
    note: str
    values: Mapping[str, tuple[AttributeValue, ...]]
    unknown: Mapping[str, str]
    roles: Mapping[tuple[str, str], MethodRole] = field(default_factory=dict, hash=False)
    combinations: tuple[tuple[str, str], ...] = ()
    edition: str = SURVEY
    names: Mapping[tuple[str, str], NameInStudy] = field(default_factory=dict, hash=False)
    verifications: tuple[Verification, ...] = ()
    type: str = "unknown"  # journal, conference, preprint, thesis, ...

    def role(self, attribute: str, value: str) -> str:
        """Return `proposed`, `compared` or `unknown`, of a model or an extractor of the study."""
        known = self.roles.get((attribute, value))
        return "unknown" if known is None else known.role

    def has_value(self, attribute: str) -> tuple[str, ...]:
        """Return the stated values that the study stands for: those it only compared are not."""
        return tuple(v for v in self.of(attribute) if self.role(attribute, v) != "compared")

    def has_nearest(self, attribute: str, value: str) -> bool:
        """Say whether a value is only the nearest in the taxonomy to what the study has."""
        name = self.names.get((attribute, value))
        return name is not None and name.is_nearest

    @cached_property
    def architectures(self) -> tuple[tuple[str, str], ...]:
        """Detector and mask of each sensor that the study can have had; empty if one is unknown."""
        every = itertools.product(self.of("detector"), self.of("mask"))
        return self.combinations or tuple(every)

    def has_sensor(self, values: Mapping[str, str | None]) -> bool:
        """Say whether a sensor of the study can have these values of detector and mask."""
        pair = (values.get("detector"), values.get("mask"))
        return not self.combinations or None in pair or pair in self.combinations

    def of(self, attribute: str) -> tuple[str, ...]:
        """Return the stated values of an attribute, without repetition; empty if unknown."""
        return self._stated_values.get(attribute, ())

    @cached_property
    def _stated_values(self) -> Mapping[str, tuple[str, ...]]:
        return {a: tuple(dict.fromkeys(v.value for v in cells)) for a, cells in self.values.items()}

    def number(self, attribute: str) -> float | None:
        """Return a stated number of `NUMERIC_ATTRIBUTES` (the best of several); None if none."""
        if attribute not in NUMERIC_ATTRIBUTES:
            raise unknown_name("attribute", attribute, NUMERIC_ATTRIBUTES)
        numbers = [float(text) for text in self.of(attribute)]
        if not numbers:
            return None
        return max(numbers) if attribute == "fov_deg" else min(numbers)

    def report(self, quantity: Quantity) -> ReportedAccuracy | None:
        """Return the accuracy or precision that the study reports, with its kind; None if none."""
        attribute = f"{quantity}_deg"
        number = self.number(attribute)
        if number is None:
            return None
        return reported_accuracies(quantity, number, next(iter(self.of(KIND_OF[attribute])), None))

    def summary(self) -> dict[str, object]:
        """Identity and values, as in a list of studies."""
        return {
            "key": self.key,
            "title": self.title,
            "authors": self.authors,
            "year": self.year,
            "venue": self.venue,
            "type": self.type,
            "doi": self.doi,
            "url": self.url,
            "identity": self.identity,
            "edition": self.edition,
            "verified": [each.to_dict() for each in self.verifications],
            "values": {attribute: list(self.of(attribute)) for attribute in self.values},
        }

    def to_dict(self) -> dict[str, object]:
        """Return the summary and every cell with its provenance, empty cells included."""
        stated = [(a, cell) for a, cells in self.values.items() for cell in cells]
        empty = [(a, AttributeValue("", "unknown", "", note)) for a, note in self.unknown.items()]
        cells = [
            {
                "attribute": attribute,
                "value": cell.value,
                "basis": cell.basis,
                "source": cell.source,
                "source_name": source_named(cell.source).name,
                "note": cell.note,
                "role": self._role_of_method(attribute, cell.value),
                **self._name(attribute, cell.value),
            }
            for attribute, cell in (*stated, *empty)
        ]
        return {**self.summary(), "note": self.note, "attributes": cells}

    def _role_of_method(self, attribute: str, value: str) -> str:
        return self.role(attribute, value) if value and attribute in METHODS else ""

    def _name(self, attribute: str, value: str) -> dict[str, object]:
        """Return what the study calls a value, and whether the taxonomy has only the nearest."""
        found = self.names.get((attribute, value))
        return {
            "name_in_study": "" if found is None else found.name,
            "nearest": found is not None and found.is_nearest,
        }
