"""Scores of a bundle, measured again from the samples that it holds, compared to the last digit.

The way from data to a score is the runner's own (`benchmark.running.task.measure`). Only where it
would simulate a data set, the bundle's arrays are read: directions, readings, flats, darks and
bounds. Scores of other conditions and of other units are of samples that are not in the bundle, and
two kinds need more than samples: calibrations on drawn benches, whose directions are simulated, and
methods in orbit that read other instruments, whose bound is.
"""

from __future__ import annotations

import csv
import hashlib
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from api.deposit.frames import FOLDER
from benchmark.contract import SPLITS, Cell
from benchmark.datasets.corrected import corrections
from benchmark.datasets.export import read_card
from benchmark.datasets.export_arrays import read_archive, samples_of
from benchmark.datasets.preset import Preset
from benchmark.plan.parts import Parts, installed_parts
from benchmark.results.store import NUMBERS
from benchmark.running.condition_data import forget
from benchmark.running.kept_stages import DATA, KeptStages
from benchmark.running.planned import numbers_of
from benchmark.running.stages import ConditionData, RenderedData, Task
from benchmark.running.task import measure

SCORES = Path("benchmark") / "scores.csv"


class RescoringError(ValueError):
    """Scores cannot be measured again; the message says why."""


@dataclass(frozen=True)
class Rescored:
    """A score measured again.

    Attributes
    ----------
    cell : what was measured
    stated : columns of the bundle's table, as text
    found : the same, measured from its samples
    seconds : since the cell before
    """

    cell: Cell
    stated: Mapping[str, str]
    found: Mapping[str, Any]
    seconds: float

    @property
    def differing(self) -> list[str]:
        """Columns whose values are not the same to the last digit that the table has."""
        return [name for name in NUMBERS if not _same(self.stated[name], self.found[name])]


def read_scores(bundle: Path) -> dict[Cell, dict[str, str]]:
    """Return the rows of a bundle's table of scores by cell; FileNotFoundError without one."""
    with (bundle / SCORES).open(encoding="utf-8", newline="") as file:
        return {
            Cell(
                row["dataset"], row["condition"], row["extractor"], row["model"], int(row["unit"])
            ): row
            for row in csv.DictReader(file)
        }


def repeatable(bundle: Path, scores: Mapping[Cell, Mapping[str, str]]) -> list[Cell]:
    """List the scores that can be measured from a bundle's samples alone, in order.

    Not those without a number, of models that refuse their calibration.

    Parameters
    ----------
    bundle : its directory
    scores : its rows by cell
    """
    known, whole = installed_parts(), _whole(bundle)
    return [
        cell
        for cell, row in scores.items()
        if row["status"] == "ok"
        and cell.unit == 0
        and whole.get(cell.dataset) == cell.condition
        and not _needs_flight(known, cell)
    ]


def draw(cells: Sequence[Cell], count: int, seed: int) -> list[Cell]:
    """Return cells drawn at random, sorted; each cell's lot is a digest of the seed and the cell.

    Raises
    ------
    RescoringError
        For a count below 1 or above the number of cells.
    """
    if not 1 <= count <= len(cells):
        raise RescoringError(
            f"{len(cells)} scores can be measured from the samples here; got {count} to draw"
        )

    def lot(cell: Cell) -> bytes:
        return hashlib.sha256(f"{seed} {cell}".encode()).digest()

    return sorted(sorted(cells, key=lot)[:count])


def rescore(bundle: Path, cells: Sequence[Cell]) -> Iterator[Rescored]:
    """Measure cells again from a bundle's samples; nothing is simulated.

    Parameters
    ----------
    bundle : its directory
    cells : of `repeatable`, sorted

    Raises
    ------
    FileNotFoundError
        Where the bundle has no table of scores.
    UnknownNameError
        For a data set or an algorithm that is not installed.
    """
    known, stated = installed_parts(), read_scores(bundle)
    data = cast("KeptStages", _Deposited(bundle, known))
    forget()  # what a process may have simulated before; and then what it read here
    try:
        started = time.perf_counter()
        for (dataset, condition, extractor), group in groupby(cells, key=_extraction):
            same = list(group)
            models = tuple(known.model(cell.model) for cell in same)
            task = Task(known.preset(dataset), condition, known.extractor(extractor), models)
            for cell, found in zip(same, numbers_of(measure(task, data)), strict=True):
                now = time.perf_counter()
                yield Rescored(cell, stated[cell], found, now - started)
                started = now
    finally:
        forget()


def _extraction(cell: Cell) -> tuple[str, str, str]:
    return cell.dataset, cell.condition, cell.extractor


def _same(stated: str, found: Any) -> bool:
    if found is None:
        return stated == ""
    return stated == found if isinstance(found, str) else stated != "" and float(stated) == found


def _whole(bundle: Path) -> dict[str, str]:
    """Return the condition by data set of which every split lies in a bundle, whole."""
    folder = bundle / FOLDER
    cards = [read_card(path) for path in sorted(folder.iterdir())] if folder.is_dir() else []
    return {
        card["name"]: card["exported"]["conditions"][0]
        for card in cards
        if set(card["exported"]["splits"]) == set(SPLITS)
        and card["exported"]["first_samples"] is None
    }


def _needs_flight(parts: Parts, cell: Cell) -> bool:
    """Say whether the bound of a cell is one over a flight, which samples alone do not give."""
    flies = hasattr(parts.preset(cell.dataset), "posterior_bound_deg")
    return flies and bool(parts.model(cell.model).about.context)


@dataclass(frozen=True)
class _Deposited:
    """Stands where a runner keeps stages of earlier runs, and has one: data, of a bundle."""

    bundle: Path
    parts: Parts

    def get(self, stage: str, cell: Cell) -> Any:
        """Return the data of a cell; nothing of what is to be measured."""
        return self._data(cell) if stage == DATA else None

    def has(self, stage: str, cell: Cell) -> bool:  # noqa: ARG002 - nothing is kept
        """Say that features are not known."""
        return False

    def put(self, stage: str, cell: Cell, value: Any) -> None:
        """Keep nothing."""

    def _data(self, cell: Cell) -> RenderedData:
        folder = self.bundle / FOLDER / cell.dataset / cell.condition
        arrays = {split: read_archive(folder / f"{split}.npz") for split in SPLITS}
        test, preset = arrays["test"], self.parts.preset(cell.dataset)
        data = ConditionData(
            preset,
            cast("Any", {split: samples_of(found) for split, found in arrays.items()}),
            test["bound_deg"],
            test.get("bound_unit_deg"),
            np.asarray(test["observable"], dtype=np.bool_),
            (),
        )
        path = folder / "references.npz"
        readings = read_archive(path) if path.is_file() else {}
        referred = cast("Preset", _Referred(preset, self.bundle, readings))
        return RenderedData(data, corrections(referred, cell.condition))


@dataclass(frozen=True)
class _Referred:
    """A data set whose flats and darks are those of a bundle."""

    preset: Preset
    bundle: Path
    readings: Mapping[str, NDArray[Any]]

    @property
    def streams(self) -> tuple[str | int, ...]:
        """Names of its own, so that corrections by simulated readings are not taken for these."""
        return (*self.preset.streams, str(self.bundle))

    def references(
        self,
        condition: str,  # noqa: ARG002 - one alone
        split: str = "calibration",  # noqa: ARG002 - not renewed under the first condition
    ) -> Mapping[str, NDArray[Any]]:
        """Return the readings."""
        return self.readings

    def __getattr__(self, name: str) -> Any:
        return getattr(self.preset, name)
