"""The published measurements: scores, running times, leaderboard and the standard data sets."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from benchmark import sweeps
from benchmark.store import PUBLISHED, Pin, Store, StoreError
from registry.measured import Measured

if TYPE_CHECKING:
    from benchmark.datasets import Preset

_TAKEN = tuple(f.name for f in dataclasses.fields(Measured) if f.name != "latency_us")

Row = Mapping[str, Any]


class Measurements:
    """What has been measured, read once from published files; nothing where there are none.

    Parameters
    ----------
    directory : of the published files
    """

    def __init__(self, directory: Path = PUBLISHED) -> None:
        self.directory = directory

    @cached_property
    def scores(self) -> Sequence[Row]:
        """Score rows, sorted by data set, condition, extractor and model."""
        return Store(self.directory).rows()

    @cached_property
    def runs(self) -> Mapping[str, Row]:
        """Running times by key of the score they belong to."""
        return Store(self.directory).runs()

    def comparable(self, condition: str) -> list[Measured]:
        """Return the scores of a condition as recommendations take them, failures left out."""
        found = []
        for row in self.scores:
            if row["condition"] == condition and row["status"] == "ok":
                taken: dict[str, Any] = {name: row[name] for name in _TAKEN}
                latency_us = self.runs.get(row["key"], {}).get("latency_us")
                found.append(Measured(**taken, latency_us=latency_us))
        return found

    @cached_property
    def leaderboard(self) -> Mapping[str, Any]:
        """The published leaderboard; without data sets where none is published.

        Raises
        ------
        StoreError
            Where the file is not a JSON object.
        """
        path = self.directory / "leaderboard.json"
        if not path.is_file():
            return {"schema": None, "datasets": []}
        board = json.loads(path.read_bytes())
        if not isinstance(board, dict):
            raise StoreError(f"{path}: expected a JSON object, got {type(board).__name__}")
        return board

    @cached_property
    def sweeps(self) -> Sequence[Row]:
        """Rows of the sweeps on reference features, in order."""
        return sweeps.read(self.directory)

    @cached_property
    def assessment(self) -> Mapping[str, Any]:
        """The survey's assessment beside the measured one, with definitions and totals."""
        from benchmark import assessment  # noqa: PLC0415 - imports every implementation

        return assessment.document(assessment.assess(self.directory))

    @cached_property
    def assessed_methods(self) -> tuple[str, ...]:
        """Methods of the survey's assessment."""
        return tuple(method["method"] for method in self.assessment["methods"])

    @cached_property
    def presets(self) -> Mapping[str, Preset]:
        """The standard data sets by name. The first use loads the simulator."""
        from benchmark import datasets  # noqa: PLC0415 - slow, and not needed to make the service

        return {name: datasets.get(name) for name in datasets.names()}

    @cached_property
    def dataset_names(self) -> tuple[str, ...]:
        """Names of the standard data sets."""
        return tuple(self.presets)

    @cached_property
    def pins(self) -> Mapping[tuple[str, str, str], Pin]:
        """Hashes and bounds of the published data by (data set, condition, split)."""
        return Store(self.directory).pins()

    @cached_property
    def cards(self) -> Sequence[Row]:
        """Cards of the standard data sets, short: what a condition is in words, no parameters."""
        short = ("name", "version", "detector", "mask", "observation", "units")
        words = ("conditions", "bounds", "description", "follows", "splits", "preview")
        return [
            {
                **{name: card[name] for name in (*short, *words)},
                "setups": {
                    condition: {"description": setup["description"]}
                    for condition, setup in card["setups"].items()
                },
            }
            for card in map(self.card, self.presets)
        ]

    def card(self, dataset: str) -> dict[str, Any]:
        """Return the whole card of a data set: conditions by name, what they are in `setups`.

        `bounds` are the published ones: the Cramer-Rao bound of the condition, as rms in degrees.
        `data` are the published hashes, and `preview` is where the picture is served.
        """
        preset = self.presets[dataset]
        card = preset.card()
        card["setups"] = card["conditions"]
        card["conditions"] = list(preset.conditions)
        card["bounds"] = self.bounds(dataset)
        card["preview"] = f"/v1/datasets/{dataset}/preview.png"
        card["data"] = [
            {
                "condition": condition,
                "split": split,
                "samples": about["samples"],
                "data_hash": pin.data_hash
                if (pin := self._pin(dataset, condition, split))
                else None,
                "bound_deg": pin.bound_deg if pin else None,
            }
            for condition in preset.conditions
            for split, about in card["splits"].items()
        ]
        return card

    def _pin(self, dataset: str, condition: str, split: str) -> Pin | None:
        """Return a pin; None where there is none, or it is of another version of the data."""
        pin = self.pins.get((dataset, condition, split))
        return pin if pin and pin.version == self.presets[dataset].version else None

    def bounds(self, dataset: str) -> dict[str, float]:
        """Return the bound (rms, degrees) of each condition of a data set that has one published.

        Over all samples of the test split where the direction is observable. Where the data are
        not pinned, that of the pipeline that found most: a score's bound is over the samples its
        pipeline found.
        """
        pinned = {
            condition: pin.bound_deg
            for condition in self.presets[dataset].conditions
            if (pin := self._pin(dataset, condition, "test")) and pin.bound_deg is not None
        }
        return {**self._scored_bounds(dataset), **pinned}

    def _scored_bounds(self, dataset: str) -> dict[str, float]:
        best: dict[str, tuple[float, float]] = {}
        for row in self.scores:
            if row["dataset"] == dataset and row["status"] == "ok" and row["bound_deg"] is not None:
                found = (row["found_fraction"], row["bound_deg"])
                best[row["condition"]] = max(best.get(row["condition"], found), found)
        return {condition: bound for condition, (_, bound) in best.items()}

    def board_rows(self, dataset: str | None = None) -> Sequence[Row]:
        """Rows of the leaderboard, of one data set or of all."""
        return [
            row
            for board in self.leaderboard["datasets"]
            if dataset is None or board["name"] == dataset
            for row in board.get("rows", ())
        ]

    @cached_property
    def conditions(self) -> tuple[str, ...]:
        """Conditions that any standard data set has, in order of appearance."""
        presets = self.presets.values()
        return tuple(dict.fromkeys(name for preset in presets for name in preset.conditions))

    @cached_property
    def architectures(self) -> frozenset[tuple[str, str]]:
        """The (detector, mask) pairs that a standard data set simulates."""
        return frozenset((preset.detector, preset.mask) for preset in self.presets.values())

    def simulating(self, detector: str, mask: str) -> list[str]:
        """Return the names of the data sets of an architecture."""
        presets = self.presets.values()
        return [p.name for p in presets if (p.detector, p.mask) == (detector, mask)]
