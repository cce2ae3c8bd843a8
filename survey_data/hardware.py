"""Built sensors and their published figures, without pandas: `hardware`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

from survey_data.descriptor import DATA_DIRECTORY
from survey_data.texts import load_texts

_FIGURES = (*("fov_full_deg", "accuracy_deg", "precision_deg", "power_mw", "mass_g", "update_hz"),)


@dataclass(frozen=True)
class Hardware:
    """One built sensor; None and empty text where nothing was seen (see ``datapackage.json``)."""

    id: str
    name: str
    detector: str
    mask: str
    fov_full_deg: float | None
    accuracy_deg: float | None
    accuracy_kind: str
    precision_deg: float | None
    power_mw: float | None
    mass_g: float | None
    basis: str
    source: str


@cache
def hardware(directory: Path | None = None) -> Mapping[str, Hardware]:
    """Return the built sensors by id; SurveyDataError where the table cannot be read."""
    rows = load_texts(("hardware",), directory or DATA_DIRECTORY).hardware
    names = Hardware.__match_args__
    return MappingProxyType({row["id"]: Hardware(**stated(row, names)) for row in rows})


def stated(row: Mapping[str, str], columns: Iterable[str]) -> dict[str, Any]:
    """Return columns of a row of the table, figures as numbers or None."""
    figures = {name: float(row[name]) if row[name] else None for name in _FIGURES}
    return {name: figures.get(name, row[name]) for name in columns}
