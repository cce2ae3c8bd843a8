"""Measured performance as the registry sees it: rows handed in by whoever measured."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable
from dataclasses import dataclass

_NUMBERS = (
    *("rms_deg", "bound_deg", "over_bound", "half_fov_deg", "latency_us"),
    *("availability", "false_sun"),
)

Route = tuple[str, str, str, str]  # (detector, mask, extractor value, model value)


@dataclass(frozen=True)
class Measured:
    """The score of one pipeline on one dataset under one condition.

    Numbers are None where not measured; NaN and infinities are taken as None.

    Attributes
    ----------
    half_fov_deg
        Half the field of view of the dataset.
    availability, false_sun
        Answered shares of the samples whose direction is observable, and of the others.
    available
        Whether it answers often enough to be judged by its error.
    """

    dataset: str
    condition: str
    detector: str
    mask: str
    extractor: str
    extractor_taxonomy: str
    model: str
    model_taxonomy: str
    rms_deg: float | None
    bound_deg: float | None = None
    over_bound: float | None = None
    half_fov_deg: float | None = None
    latency_us: float | None = None
    availability: float | None = None
    false_sun: float | None = None
    available: bool = True

    def __post_init__(self) -> None:
        for name in _NUMBERS:
            value: float | None = getattr(self, name)
            if value is not None and not math.isfinite(value):
                object.__setattr__(self, name, None)

    def to_dict(self) -> dict[str, object]:
        """Return the row as in the HTTP answer."""
        return {
            "dataset": self.dataset,
            "condition": self.condition,
            "extractor": self.extractor,
            "model": self.model,
            "rms_deg": self.rms_deg,
            "bound_deg": self.bound_deg,
            "over_bound": self.over_bound,
            "half_fov_deg": self.half_fov_deg,
            "latency_us": self.latency_us,
            "availability": self.availability,
            "false_sun": self.false_sun,
        }


class Measurements:
    """Rows by route, best first; build once and hand in many times.

    Best is the most accurate; those that do not answer often enough come behind all others.

    Parameters
    ----------
    rows : iterable of Measured
        Rows without an RMS error (failed runs) are left out.
    """

    def __init__(self, rows: Iterable[Measured] = ()) -> None:
        by_route: dict[Route, list[tuple[bool, float, Measured]]] = {}
        for row in rows:
            if row.rms_deg is not None:
                route = (row.detector, row.mask, row.extractor_taxonomy, row.model_taxonomy)
                by_route.setdefault(route, []).append((not row.available, row.rms_deg, row))
        self._by_route: dict[Route, tuple[Measured, ...]] = {}
        for route, found in by_route.items():
            found.sort(key=lambda item: (*item[:2], _identity(item[2])))
            self._by_route[route] = tuple(row for *_, row in found)

    def on(self, route: Route) -> tuple[Measured, ...]:
        """Return the rows of a route, best first."""
        return self._by_route.get(route, ())


def _identity(row: Measured) -> tuple[str, ...]:
    return tuple(
        str(getattr(row, f.name)) for f in dataclasses.fields(row) if f.name not in _NUMBERS
    )
