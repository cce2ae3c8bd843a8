"""Which built sensors each data set represents, or why it represents none: ``realism.csv``.

The figures of the sensors are facts of `survey_data.hardware`; a data set's own are measured, and
`benchmark.leaderboard.realism` sets them beside. Typed here are the pairing, the sentence that
explains a difference, and the reason why a data set is an idealisation.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

from survey_data.hardware import Hardware, hardware
from survey_data.table_records import read_records

FILE = Path(__file__).parent / "realism.csv"
COLUMNS = ("dataset", "hardware", "idealisation", "sentence")

#: Said of a data set that the table does not have.
UNNAMED = "No built sensor is named for it."


class RealismError(ValueError):
    """The table is broken; the message names the line."""


@dataclass(frozen=True)
class HardwareMatch:
    """The built sensors that a data set represents, or why it represents none (`idealisation`).

    A sentence explains a difference from their figures; it is empty without a difference.
    """

    dataset: str
    sensors: tuple[Hardware, ...]
    idealisation: str
    sentence: str

    def card(self) -> dict[str, Any]:
        """As a data set's card says it: plain JSON values."""
        return {
            "idealisation": self.idealisation or None,
            "sensors": [figures(sensor) for sensor in self.sensors],
        }


def figures(sensor: Hardware) -> dict[str, Any]:
    """Return a built sensor's published figures as plain JSON values."""
    return {
        "id": sensor.id,
        "name": sensor.name,
        "fov_full_deg": sensor.fov_full_deg,
        "accuracy_deg": sensor.accuracy_deg,
        "accuracy_kind": sensor.accuracy_kind or None,
        "precision_deg": sensor.precision_deg,
        "basis": sensor.basis,
        "source": sensor.source,
    }


def hardware_match(dataset: str) -> HardwareMatch:
    """Return what a data set stands for; one that the table does not have is an idealisation."""
    return hardware_matches().get(dataset, HardwareMatch(dataset, (), UNNAMED, ""))


@cache
def hardware_matches(path: Path = FILE) -> Mapping[str, HardwareMatch]:
    """Return what each data set of the table stands for, by name.

    RealismError for a broken line, a data set that stands twice, an unknown sensor, and a line that
    has both sensors and a reason why it has none, or neither.
    """
    records = read_records(path, list(COLUMNS))
    if records.problems:
        raise RealismError("; ".join(map(str, records.problems)))
    found: dict[str, HardwareMatch] = {}
    for line, (dataset, ids, idealisation, sentence) in records.rows:
        unknown = [name for name in ids.split() if name not in hardware()]
        if unknown:
            raise RealismError(f"{path.name}, line {line}: no built sensor {', '.join(unknown)}")
        if dataset in found:
            raise RealismError(f"{path.name}, line {line}: {dataset} stands there already")
        if bool(ids) == bool(idealisation):
            raise RealismError(
                f"{path.name}, line {line}: {dataset} needs built sensors or a reason why it has "
                "none, and not both"
            )
        sensors = tuple(hardware()[name] for name in ids.split())
        found[dataset] = HardwareMatch(dataset, sensors, idealisation, sentence)
    return MappingProxyType(found)
