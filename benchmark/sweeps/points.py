"""What a sweep measures: one extractor at one point of a series."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, order=True)
class Point:
    """One extractor at one point of a series, by names; sweep and point empty for all of them."""

    series: str
    sweep: str
    point: str
    extractor: str

    def __str__(self) -> str:
        return f"{self.series}/{self.sweep}/{self.point}/{self.extractor}"
