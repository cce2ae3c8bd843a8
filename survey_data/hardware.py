"""Built sensors and their published figures, without pandas: `hardware` by row, `products`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from statistics import median
from types import MappingProxyType

from files.strict_csv import read_records
from survey_data.descriptor import DATA_DIRECTORY, column_types, file_name
from survey_data.problems import SurveyDataError
from survey_data.reported import reported_accuracies

_TABLE = "hardware"
SELF_POWERED = "self-powered"
"""The supply of a sensor that runs on solar cells of its own."""


@dataclass(frozen=True)
class Hardware:
    """One built sensor; None and empty text where nothing was seen (see ``datapackage.json``)."""

    id: str
    group: str
    study: str
    name: str
    family: str
    detector: str
    mask: str
    fov_full_deg: float | None
    accuracy_deg: float | None
    accuracy_kind: str
    precision_deg: float | None
    update_hz: float | None
    power_mw: float | None
    supply: str
    mass_g: float | None
    basis: str
    source: str

    @property
    def accuracy_rms_deg(self) -> float | None:
        """The accuracy as a root mean square, degrees, by the rule of its kind."""
        if self.accuracy_deg is None:
            return None
        return reported_accuracies("accuracy", self.accuracy_deg, self.accuracy_kind).rms_deg


@dataclass(frozen=True)
class Product:
    """The rows of one family: one unit, or variants of one model.

    Rate, power and mass are medians of the distinct values that its rows state; None where none
    states one. A self-powered product draws nothing: its ``power_mw`` is None, ``supply`` says so.
    """

    family: str
    names: tuple[str, ...]
    ids: tuple[str, ...]
    studies: tuple[str, ...]
    detector: str
    mask: str
    fov_full_deg: float | None
    """The widest of its rows."""
    accuracy_rms_deg: float | None
    """The smallest of its rows."""
    update_hz: float | None
    power_mw: float | None
    supply: str
    mass_g: float | None


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
            group=row["group"],
            study=row["study"],
            name=row["name"],
            family=row["family"],
            detector=row["detector"],
            mask=row["mask"],
            fov_full_deg=_number(row["fov_full_deg"]),
            accuracy_deg=_number(row["accuracy_deg"]),
            accuracy_kind=row["accuracy_kind"],
            precision_deg=_number(row["precision_deg"]),
            update_hz=_number(row["update_hz"]),
            power_mw=_number(row["power_mw"]),
            supply=row["supply"],
            mass_g=_number(row["mass_g"]),
            basis=row["basis"],
            source=row["source"],
        )
    return MappingProxyType(found)


@cache
def products() -> tuple[Product, ...]:
    """Return the distinct products whose detector and mask are known, by family."""
    rows: dict[tuple[str, str, str], list[Hardware]] = {}
    for one in hardware().values():
        if one.detector and one.mask:
            rows.setdefault((one.family, one.detector, one.mask), []).append(one)
    return tuple(_product(rows[key]) for key in sorted(rows))


def _product(rows: Sequence[Hardware]) -> Product:
    supply = next((one.supply for one in rows if one.supply), "")
    return Product(
        family=rows[0].family,
        names=tuple(one.name for one in rows),
        ids=tuple(one.id for one in rows),
        studies=tuple(dict.fromkeys(one.study for one in rows if one.study)),
        detector=rows[0].detector,
        mask=rows[0].mask,
        fov_full_deg=max(_known(one.fov_full_deg for one in rows), default=None),
        accuracy_rms_deg=min(_known(one.accuracy_rms_deg for one in rows), default=None),
        update_hz=_median(one.update_hz for one in rows),
        power_mw=None if supply == SELF_POWERED else _median(one.power_mw for one in rows),
        supply=supply,
        mass_g=_median(one.mass_g for one in rows),
    )


def _known(values: Iterable[float | None]) -> set[float]:
    return {value for value in values if value is not None}


def _median(values: Iterable[float | None]) -> float | None:
    known = _known(values)
    return median(known) if known else None


def _number(text: str) -> float | None:
    return float(text) if text else None
