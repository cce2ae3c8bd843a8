"""What the survey's tables say of studies beyond the mapping: purposes, variants, advice."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal, cast

from registry.taxonomy import Architecture

Purpose = Literal["albedo", "temperature", "flight"]

DIMENSIONS = "dimensions"
"""Value of the departure of a sensor whose dimensions are not known."""

DRAWN = "drawn"
"""How a study comes by its constants that takes them from its drawing."""

Conditions = tuple[tuple[str, str], ...]
"""Attributes with the values that a study must have, all of them."""


@dataclass(frozen=True)
class PurposeRule:
    """What a study is run for that meets every condition of `given` and not all of `unless`."""

    id: str
    given: Conditions
    unless: Conditions
    purpose: Purpose
    section: str
    rule: str


@dataclass(frozen=True)
class CompensatedModel:
    """The model that a compensation of a study belongs to.

    ``relation`` is ahead where it corrects what the model reads, within where the model carries it
    out itself.
    """

    study: str
    compensation: str
    model: str
    relation: str
    basis: str
    source: str
    note: str


@dataclass(frozen=True)
class MethodVariant:
    """How a study carries out one of its models.

    Implementations of the value ``runs_as`` do, where they read the extractor's features and, if
    ``context`` names one, that column beside them.
    """

    study: str
    model: str
    runs_as: str
    extractor: str
    context: str
    basis: str
    source: str
    note: str


@dataclass(frozen=True)
class RunFact:
    """Something that a run is judged by: how constants are had, what the sensor is like."""

    study: str
    fact: str
    value: str
    basis: str
    source: str
    note: str


#: Columns of `hardware.csv` by what a run is judged by.
_OF_HARDWARE = {
    "count_of_apertures": "openings",
    "aperture_or_slit_um": "opening_um",
    "focal_or_height_mm": "height_mm",
    "pixel_pitch_um": "pitch_um",
    "array_px": "array_px",
    "fov_full_deg": "fov_deg",
    "detector": "detector",
    "mask": "mask",
}


def hardware_facts(row: Mapping[str, str]) -> Iterable[RunFact]:
    """Give what a row of `hardware.csv` says of a study's sensor, if it was seen on a page."""
    if not row["study"] or row["basis"] != "page":
        return
    for column, fact in _OF_HARDWARE.items():
        value = row[column].partition("x")[0] if column == "array_px" else row[column]
        if value and not (fact == "openings" and float(value) == 0.0):
            yield RunFact(row["study"], fact, value, "page", row["source"], row["id"])


def conditions(text: str) -> Conditions:
    """Read `attribute=value` joined by `&`."""
    parts = (part.partition("=") for part in text.split("&") if part)
    return tuple((attribute, value) for attribute, _, value in parts)


def purpose_rule(row: Mapping[str, str]) -> PurposeRule:
    """Return a row of `purposes.csv`."""
    return PurposeRule(
        row["id"],
        conditions(row["given"]),
        conditions(row["unless"]),
        cast("Purpose", row["purpose"]),
        row["survey_section"],
        row["rule"],
    )


INCLUDES: Mapping[tuple[str, str], tuple[str, ...]] = MappingProxyType(
    {("detector", "PD"): ("QPD",), ("mask", "Slit"): ("L-Slit",)}
)
"""Values that the survey's advice means beside the one it names (notes of the table of advice)."""


@dataclass(frozen=True)
class Advice:
    """One piece of advice; an empty value leaves that open.

    ``requirement`` and ``value`` say what for; ``model_category`` and ``extractor`` are a category
    of models and one value or family of extractors.
    """

    id: str
    requirement: str
    value: str
    detector: str
    mask: str
    model_category: str
    extractor: str
    section: str
    note: str

    def means(self, architecture: Architecture) -> bool:
        """Say whether a detector and mask are among those that it names."""
        named = (("detector", self.detector), ("mask", self.mask))
        return all(
            not value or has in (value, *INCLUDES.get((attribute, value), ()))
            for (attribute, value), has in zip(named, architecture, strict=True)
        )

    def names(self, extractor: Iterable[str], categories: Iterable[str]) -> bool:
        """Say whether it names a calibration, by its extractor's value and family, and categories.

        Advice that leaves both open names none.
        """
        if not self.model_category and not self.extractor:
            return False
        return (not self.extractor or self.extractor in extractor) and (
            not self.model_category or self.model_category in categories
        )
