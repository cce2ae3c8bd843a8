"""Built sensors and their published figures, without pandas: `hardware`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType

from survey_data.descriptor import DATA_DIRECTORY, column_types, file_name
from survey_data.problems import SurveyDataError
from survey_data.table_records import read_records

_TABLE = "hardware"


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
    """Return the built sensors by id.

    Parameters
    ----------
    directory : Path, optional
        Where the tables are; by default the package's own data.

    Raises
    ------
    SurveyDataError
        The table is missing or broken.
    """
    columns = list(column_types(_TABLE))
    records = read_records((directory or DATA_DIRECTORY) / file_name(_TABLE), columns)
    if records.problems:
        raise SurveyDataError(tuple(records.problems))
    found = {}
    for _, cells in records.rows:
        row = dict(zip(columns, cells, strict=True))
        found[row["id"]] = Hardware(
            id=row["id"],
            name=row["name"],
            detector=row["detector"],
            mask=row["mask"],
            fov_full_deg=_number(row["fov_full_deg"]),
            accuracy_deg=_number(row["accuracy_deg"]),
            accuracy_kind=row["accuracy_kind"],
            precision_deg=_number(row["precision_deg"]),
            power_mw=_number(row["power_mw"]),
            mass_g=_number(row["mass_g"]),
            basis=row["basis"],
            source=row["source"],
        )
    return MappingProxyType(found)


def _number(text: str) -> float | None:
    return float(text) if text else None
