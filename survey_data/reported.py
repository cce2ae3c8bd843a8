"""Accuracy and precision as studies report them: a number, and which statistic of the error it is.

Without pandas. A figure is compared with another only as the root mean square that the rule of its
kind (``statistics.csv``) makes of it; a precision is never compared with an accuracy.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Literal

from files.reading import parse_decimal
from survey_data.descriptor import DATA_DIRECTORY
from survey_data.texts import load_texts

UNSPECIFIED = "unspecified"
"""The kind of a figure whose source does not say which statistic it is."""

Quantity = Literal["accuracy", "precision"]
QUANTITIES: tuple[Quantity, ...] = ("accuracy", "precision")
KIND_OF: Mapping[str, str] = MappingProxyType(
    {"accuracy_deg": "accuracy_kind", "precision_deg": "precision_kind"}
)
"""Attribute of a figure -> attribute that says which statistic it is."""


@dataclass(frozen=True)
class Statistic:
    """Which statistic of the error a figure is; an RMS is the figure over ``rms_divisor``."""

    kind: str
    name: str
    rms_divisor: float
    description: str


@dataclass(frozen=True)
class ReportedAccuracy:
    """An accuracy or a precision as published, in degrees."""

    quantity: Quantity
    value_deg: float
    statistic: Statistic

    @property
    def rms_deg(self) -> float:
        """The figure as a root mean square, degrees, by the rule of its kind."""
        return self.value_deg / self.statistic.rms_divisor

    @property
    def label(self) -> str:
        """What the number is: ``1-sigma precision``, or ``accuracy of unspecified kind``."""
        if self.statistic.kind == UNSPECIFIED:
            return f"{self.quantity} of unspecified kind"
        return f"{self.statistic.name} {self.quantity}"

    def to_dict(self) -> dict[str, object]:
        """Return number, kind and what the number is, as JSON data."""
        return {
            "value_deg": self.value_deg,
            "kind": self.statistic.kind,
            "label": self.label,
            "rms_deg": self.rms_deg,
        }


@cache
def statistics(directory: Path | None = None) -> Mapping[str, Statistic]:
    """Return the kinds of figures by name; SurveyDataError where the table cannot be read."""
    rows = load_texts(("statistics",), directory or DATA_DIRECTORY).statistics
    return MappingProxyType(
        {
            row["kind"]: Statistic(**{**row, "rms_divisor": parse_decimal(row["rms_divisor"])})
            for row in rows
        }
    )


def reported_accuracies(
    quantity: Quantity, value_deg: float, kind: str | None = None
) -> ReportedAccuracy:
    """Return a figure with its kind; without one it is unspecified.

    Raises
    ------
    KeyError
        For a kind that is not in the table.
    """
    return ReportedAccuracy(quantity, value_deg, statistics()[kind or UNSPECIFIED])
