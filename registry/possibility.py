"""Which two values cannot go together: what an extractor reads against what a sensor gives.

A detector gives some kinds of readings, and a mask leaves some of them with a direction in them; an
extractor reads the kinds that its implementations declare. Two of these are impossible together if
they share none. Models are not judged: which features one reads is a choice of the implementation,
and studies made others. A value without an implementation rules nothing out.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType

from registry.catalogue import Catalogue
from registry.taxonomy import NO_IMPLEMENTATION_STATED, attribute_of

Value = tuple[str, str]
"""Level and one of its values."""

GIVES: Mapping[str, frozenset[str]] = MappingProxyType(
    {
        **dict.fromkeys(("PD", "QPD", "PSD", "OI", "LTF", "PVA"), frozenset({"currents"})),
        **dict.fromkeys(("CCD", "CMOS"), frozenset({"frames", "profiles"})),
        "PDA": frozenset({"profiles", "currents"}),
        "Event": frozenset({"events"}),
    }
)
"""Detector -> the readings that it gives (`algorithms.about.Observation`)."""

TELLS: Mapping[str, frozenset[str]] = MappingProxyType({"Maskless": frozenset({"currents"})})
"""Mask -> the readings that tell a direction behind it; every reading where it is not named.

Without a mask all elements of an array see the same light: only currents of faces that look
different ways tell a direction.
"""

RULE = (
    "Impossible are a detector or a mask and an extractor that reads none of the readings which "
    "tell a direction there, an imager without a mask, and two categories that no value is of."
)


class Possibility:
    """Says of two values of a catalogue's taxonomy why they cannot go together."""

    def __init__(self, catalogue: Catalogue) -> None:
        self._catalogue = catalogue
        self._taxonomy = catalogue.taxonomy

    def why_not(self, row: Value, column: Value) -> str:
        """Return why two (level, value) cannot go together; "" where they can."""
        (rows, one), (columns, other) = row, column
        base = attribute_of(rows)
        if base == attribute_of(columns):
            shared = rows == columns or any(
                self._taxonomy.derived_values(rows, value) == one
                and self._taxonomy.derived_values(columns, value) == other
                for value in self._taxonomy.values(base)
            )
            return "" if shared else f"no {base} is of both"
        ours, theirs = self._readings(*row), self._readings(*column)
        if ours is None or theirs is None or ours & theirs:
            return ""
        return f"{_in_words(*row, ours)}; {_in_words(*column, theirs)}"

    def _readings(self, level: str, value: str) -> frozenset[str] | None:
        """Return the readings that a value goes with; None where it rules nothing out."""
        base = attribute_of(level)
        found: set[str] = set()
        for one in self._taxonomy.values(base):
            if self._taxonomy.derived_values(level, one) == value:
                readings = self._of(base, one)
                if readings is None:
                    return None
                found |= readings
        return frozenset(found)

    def _of(self, attribute: str, value: str) -> frozenset[str] | None:
        if attribute == "detector":
            return GIVES.get(value)
        if attribute == "mask":
            return TELLS.get(value)
        if attribute != "extractor" or value == NO_IMPLEMENTATION_STATED:
            return None
        found = (str(cls.about.observation) for cls in self._catalogue.extractors_for(value))
        return frozenset(found) or None


_VERBS = MappingProxyType({"detector": "gives", "mask": "has a direction in", "extractor": "reads"})


def _in_words(level: str, value: str, readings: Iterable[str]) -> str:
    return f"{value} {_VERBS[attribute_of(level)]} {' or '.join(sorted(readings))}"
