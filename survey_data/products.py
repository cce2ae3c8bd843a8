"""Built sensors as distinct products, without pandas: `products` by family, `built_sensors` by row.

Apart from `survey_data.hardware`, whose code counts in the digest of every data set.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from statistics import median
from types import MappingProxyType

from survey_data.descriptor import DATA_DIRECTORY
from survey_data.hardware import Hardware, stated
from survey_data.reported import reported_accuracies
from survey_data.texts import load_texts

SELF_POWERED = "self-powered"
"""The supply of a sensor that runs on solar cells of its own."""


@dataclass(frozen=True)
class BuiltSensor(Hardware):
    """A built sensor with its study, its family, its rate and what feeds it."""

    group: str
    study: str
    family: str
    update_hz: float | None
    supply: str

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
def built_sensors(directory: Path | None = None) -> Mapping[str, BuiltSensor]:
    """Return the built sensors by id; parameters and errors as of `hardware`."""
    rows = load_texts(("hardware",), directory or DATA_DIRECTORY).hardware
    names = BuiltSensor.__match_args__
    return MappingProxyType({row["id"]: BuiltSensor(**stated(row, names)) for row in rows})


@cache
def products() -> tuple[Product, ...]:
    """Return the distinct products whose detector and mask are known, by family."""
    rows: dict[tuple[str, str, str], list[BuiltSensor]] = {}
    for one in built_sensors().values():
        if one.detector and one.mask:
            rows.setdefault((one.family, one.detector, one.mask), []).append(one)
    return tuple(_product(rows[key]) for key in sorted(rows))


def _product(rows: Sequence[BuiltSensor]) -> Product:
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
