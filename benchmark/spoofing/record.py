"""The published outcomes of lasers: a row a sensor and pipeline."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel, NonNegativeFloat, NonNegativeInt

from benchmark.results.row_file import Row, RowFile


class Level(BaseModel, extra="forbid"):
    """Readings under a laser of one level: how many are what."""

    sun: bool
    suns: NonNegativeFloat
    readings: NonNegativeInt
    answered: NonNegativeInt
    flagged: NonNegativeInt
    deceived: NonNegativeInt
    pull_deg: NonNegativeFloat | None
    turned: NonNegativeInt
    noticed: dict[str, NonNegativeInt]
    curve: list[NonNegativeInt]


class Rise(BaseModel, extra="forbid"):
    """Lasers that rise over so many readings, and how many a filter's innovation notices."""

    readings: NonNegativeInt
    draws: NonNegativeInt
    noticed: NonNegativeInt
    off_deg: NonNegativeFloat | None
    over_own: NonNegativeFloat | None


class Spoofed(BaseModel, extra="forbid"):
    """A sensor read by one pipeline."""

    dataset: str
    extractor: str
    model: str
    key: str
    has_pattern: bool
    own_error_deg: NonNegativeFloat
    setting: NonNegativeInt
    checking: NonNegativeInt
    answered: NonNegativeInt
    flagged: NonNegativeInt
    alarms: dict[str, NonNegativeInt]
    knowable: NonNegativeFloat | None
    levels: list[Level]
    rises: list[Rise]


def cell_of(row: Mapping[str, Any]) -> str:
    """Name a row: its data set, and the extractor where it is not the leader."""
    return f"{row['dataset']}/{row['extractor']}"


RECORD: RowFile[str] = RowFile("spoofing.json", "sensors", 1, cell_of, Spoofed)


def level_of(row: Mapping[str, Any], suns: float, *, sun: bool = True) -> Row:
    """Return what came of a laser of so many Suns beside the Sun, or alone."""
    return next(one for one in row["levels"] if (one["suns"], one["sun"]) == (suns, sun))
