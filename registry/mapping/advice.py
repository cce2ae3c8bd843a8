"""What the survey's text advises: sensors and calibrations, for a task or a class of accuracy."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from registry.taxonomy import Architecture

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
