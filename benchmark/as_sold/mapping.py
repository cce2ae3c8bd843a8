"""How a built sensor is simulated: by a rule that stood before all of them were measured.

- **Data set**: the own sensor of a study that ``realism.csv`` pairs with it; else a standard data
  set of its detector and mask; else any that ``realism.csv`` pairs with it. Data sets in orbit are
  left out. Of several, the first in this order: half field at most 5 deg below the stated one
  (sensors with a mask), paired in ``realism.csv``, nearest field, name. Where the stated field is
  narrower, poses and tests are drawn within it.
  Heights and pixels are the data set's: the one height that is stated and measured is its own.
- **Depth** of calibration: what its row says (``readings.csv``), or that of its family. Assumed
  where nothing is said: uncalibrated for cells without a mask that are sold, which go by the
  cosine law; constants of a physical model for other sensors that are sold; a table for papers and
  prototypes, which publish their best. Constants are those of the most accurate physical model on
  the standard unit; a table is the most accurate calibration of any kind, tables and networks among
  them.
- **Bench**: the standard one, 0.016 deg; one of 0.001 deg where the stated accuracy is below what
  the standard one can show.
- **Statistic**: as stated; where nothing is said, the root mean square.
- **Level**: on the ground, as data sheets leave out albedo, heat and life; in flight where the
  row claims temperature and life.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Literal, cast, get_args

from benchmark import datasets
from benchmark.datasets.preset import Preset
from benchmark.datasets.realism import hardware_matches
from benchmark.results.csv_tables import StoreError
from survey_data.products import BuiltSensor, built_sensors
from survey_data.reported import UNSPECIFIED, reported_accuracies
from survey_data.table_records import read_records

Depth = Literal["uncalibrated", "constants", "table"]
Bench = Literal["standard", "fine"]
Level = Literal["ground", "flight"]
DEPTHS: tuple[Depth, ...] = get_args(Depth)

FILE = Path(__file__).parent / "readings.csv"
COLUMNS = ("hardware", "depth", "statistic", "level", "not_measured", "because")
#: Fixed error of the standard bench (`Preset.reference_error_deg`), root mean square.
STANDARD_BENCH_DEG = 0.016
#: A field that lacks no more than this serves.
NARROWER_DEG = 5.0


@dataclass(frozen=True)
class Reading:
    """What a row of the hardware table says in words; empty where it says nothing."""

    hardware: str
    depth: str = ""
    statistic: str = ""
    level: str = ""
    not_measured: str = ""
    because: str = ""


@dataclass(frozen=True)
class AsSold:
    """A built sensor with the data set and settings that simulate it.

    `half_fov_deg` is None where the data set's own stands. `depth_basis` is ``stated``, ``family``
    or ``assumed``.
    """

    sensor: BuiltSensor
    dataset: str
    half_fov_deg: float | None
    depth: Depth
    depth_basis: str
    bench: Bench
    statistic: str
    level: Level

    @property
    def cell(self) -> str:
        """Depth and bench in one word, as the record names its columns."""
        return self.depth if self.depth == "uncalibrated" else f"{self.depth}_{self.bench}"


@cache
def readings(path: Path = FILE) -> Mapping[str, Reading]:
    """Return what rows say in words, by sensor; StoreError for a broken table."""
    records = read_records(path, list(COLUMNS))
    if records.problems:
        raise StoreError("; ".join(map(str, records.problems)))
    found = [Reading(*cells) for _, cells in records.rows]
    for one in found:
        if one.hardware not in built_sensors() or one.depth not in {"", *DEPTHS}:
            raise StoreError(f"{path.name}: {one.hardware} {one.depth}: no such sensor or depth")
    return MappingProxyType({one.hardware: one for one in found})


@cache
def as_sold() -> Mapping[str, AsSold]:
    """Return how each built sensor with enough facts is simulated, by id."""
    return MappingProxyType(
        {name: _simulated(one) for name, one in built_sensors().items() if name not in left_out()}
    )


@cache
def left_out() -> Mapping[str, str]:
    """Return why a built sensor is not simulated, by id."""
    found = {}
    for name, one in built_sensors().items():
        reading = readings().get(name, Reading(name))
        if one.accuracy_deg is None:
            found[name] = "no accuracy is stated"
        elif reading.not_measured:
            found[name] = f"the figure was not measured ({reading.because})"
        elif not (one.detector and one.mask):
            found[name] = "detector or mask is not known"
        elif not _data_sets(one):
            found[name] = f"no data set has {one.detector} and {one.mask}"
    return MappingProxyType(found)


def _simulated(one: BuiltSensor) -> AsSold:
    reading = readings().get(one.id, Reading(one.id))
    name = _data_sets(one)[0]
    depth, basis = _depth(one)
    preset = datasets.get(name)
    own = preset.geometry.half_fov_deg
    stated = None if one.fov_full_deg is None else one.fov_full_deg / 2.0
    narrower = own is not None and stated is not None and stated < own
    statistic = reading.statistic or one.accuracy_kind or UNSPECIFIED
    rms = reported_accuracies("accuracy", one.accuracy_deg or 0.0, statistic).rms_deg
    return AsSold(
        sensor=one,
        dataset=name,
        half_fov_deg=stated if narrower else None,
        depth=depth,
        depth_basis=basis,
        bench="fine" if rms < STANDARD_BENCH_DEG else "standard",
        statistic=statistic,
        level="flight" if reading.level == "flight" else "ground",
    )


def _data_sets(one: BuiltSensor) -> list[str]:
    """Return the data sets that can simulate a sensor, the preferred one first."""
    paired = {
        name
        for name, match in hardware_matches().items()
        if one.id in {sensor.id for sensor in match.sensors}
    }
    own = [name for name in datasets.study_names() if name in paired]
    alike = [
        name
        for name in datasets.names()
        if (one.detector, one.mask) == (datasets.get(name).detector, datasets.get(name).mask)
    ]

    def place(name: str) -> tuple[bool, bool, float, str]:
        lacking = _beyond_deg(one, datasets.get(name))
        too_narrow = one.mask != "Maskless" and lacking > NARROWER_DEG
        return too_narrow, name not in paired, abs(lacking), name

    found = own or _on_ground(alike) or _on_ground(paired)
    return sorted(found, key=place)


def _on_ground(names: Iterable[str]) -> list[str]:
    return [name for name in names if not datasets.get(name).context_columns]


def _beyond_deg(one: BuiltSensor, preset: Preset) -> float:
    """Return how far the stated half field goes beyond a data set's; 0 where one is not known."""
    own = preset.geometry.half_fov_deg
    if one.fov_full_deg is None or own is None:
        return 0.0
    return one.fov_full_deg / 2.0 - own


def _depth(one: BuiltSensor) -> tuple[Depth, str]:
    said = readings()
    if one.id in said and said[one.id].depth:
        return cast("Depth", said[one.id].depth), "stated"
    family = [
        reading.depth
        for name, reading in said.items()
        if reading.depth and one.family and built_sensors()[name].family == one.family
    ]
    if len(set(family)) == 1:
        return cast("Depth", family[0]), "family"
    if one.group == "paper":
        return "table", "assumed"
    return ("uncalibrated" if one.mask == "Maskless" else "constants"), "assumed"
