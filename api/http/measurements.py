"""The published measurements: scores, leaderboard, sweeps and the standard data sets."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from benchmark.datasets.hazards import hazards
from benchmark.datasets.pins import Pin
from benchmark.leaderboard.board import build
from benchmark.metrics.rings import EDGES_DEG, field_error
from benchmark.metrics.score import is_available
from benchmark.results.store import PUBLISHED, Store
from registry.fitting import stages
from registry.measured import Measured, Score

if TYPE_CHECKING:
    from benchmark.datasets import Preset
    from benchmark.running.times import Place, Time
    from registry.catalogue import Catalogue

_PLAIN = tuple(f.name for f in dataclasses.fields(Score) if f.name not in {"available", "cones"})

Row = Mapping[str, Any]


class Measurements:
    """What has been measured, read once from published files; nothing where there are none.

    Parameters
    ----------
    directory : of the published files
    times_directory : of running times of this machine (`benchmark.running.times`), which are no
        part of what is published; None for none
    """

    def __init__(self, directory: Path = PUBLISHED, times_directory: Path | None = None) -> None:
        self.directory = directory
        self.times_directory = times_directory

    @cached_property
    def _every_unit(self) -> Sequence[Row]:
        return Store(self.directory).rows(unit=None)

    @cached_property
    def scores(self) -> Sequence[Row]:
        """Score rows of the standard unit, sorted by data set, condition, extractor and model."""
        return [row for row in self._every_unit if row["unit"] == 0]

    @cached_property
    def nominal(self) -> Mapping[tuple[str, str, str], Row]:
        """Score under the first condition of each data set, by data set, extractor and model."""
        first = {name: preset.conditions[0] for name, preset in self.presets.items()}
        return {
            (row["dataset"], row["extractor"], row["model"]): row
            for row in self.scores
            if row["condition"] == first.get(row["dataset"])
        }

    @cached_property
    def times(self) -> Mapping[Place, Time]:
        """Times of this machine that are of the code as it is."""
        if self.times_directory is None:
            return {}
        from benchmark.running import times  # noqa: PLC0415 - slow, and of no use without times

        return times.times_of_code(self.times_directory)

    def pipelines(self, catalogue: Catalogue) -> list[Measured]:
        """Return what is measured of every pipeline on every data set, for recommendations.

        Parameters
        ----------
        catalogue : says what compensations and model a pipeline's name stands for
        """
        by: dict[tuple[str, str, str], dict[tuple[str, int], Row]] = {}
        for row in self._every_unit:
            pipeline = (row["dataset"], row["extractor"], row["model"])
            by.setdefault(pipeline, {})[row["condition"], row["unit"]] = row
        known = {name: stages(scored) for name, scored in catalogue.models.items()}
        found = []
        for (dataset, extractor, model), rows in by.items():
            conditions = self.presets[dataset].conditions if dataset in self.presets else ()
            first = rows.get((conditions[0], 0)) if conditions else None
            if first is None or model not in known:
                continue
            time = self.times.get((dataset, extractor, model))
            tried = hazards(conditions)
            found.append(
                Measured(
                    dataset=dataset,
                    detector=first["detector"],
                    mask=first["mask"],
                    extractor=extractor,
                    extractor_taxonomy=first["extractor_taxonomy"],
                    model=model,
                    stages=known[model],
                    nominal=_score(first),
                    hazards={
                        hazard: tuple(_score(rows[name, 0]) for name in names if (name, 0) in rows)
                        for hazard, names in tried.items()
                    },
                    half_fov_deg=first["half_fov_deg"],
                    latency_us=time.latency_us if time else None,
                    unit_rms_deg=tuple(
                        row["rms_deg"]
                        for (condition, unit), row in sorted(rows.items())
                        if condition == conditions[0] and unit and row["rms_deg"] is not None
                    ),
                )
            )
        return found

    @cached_property
    def leaderboard(self) -> Mapping[str, Any]:
        """The leaderboard of the published scores; without data sets where there are none."""
        times = {
            pipeline: {"latency_us": time.latency_us, "time_ratio": time.time_ratio}
            for pipeline, time in self.times.items()
        }
        board = build(self._every_unit, times, self.sweeps)
        return board if board["datasets"] else {"schema": None, "datasets": []}

    @cached_property
    def sweeps(self) -> Sequence[Row]:
        """Rows of the sweeps on reference features, in order."""
        return Store(self.directory).swept()

    @cached_property
    def assessment(self) -> Mapping[str, Any]:
        """The survey's assessment beside the measured one, with definitions and totals."""
        from benchmark.assessment import assess as assessment  # noqa: PLC0415 - imports every implementation

        return assessment.document(assessment.assess(self.directory, times=self.times))

    @cached_property
    def realism(self) -> Sequence[Row]:
        """Data sets beside the built sensors that they stand for."""
        from benchmark.leaderboard.realism import realism  # noqa: PLC0415 - as presets

        nominal = {name: preset.conditions[0] for name, preset in self.presets.items()}
        return realism(self.scores, nominal)

    @cached_property
    def presets(self) -> Mapping[str, Preset]:
        """The standard data sets by name. The first use loads the simulator."""
        from benchmark import datasets  # noqa: PLC0415 - slow, and not needed to make the service

        return {name: datasets.get(name) for name in datasets.names()}

    @cached_property
    def pins(self) -> Mapping[tuple[str, str, str], Pin]:
        """Hashes and bounds of the published data by (data set, condition, split)."""
        return Store(self.directory).pins()

    @cached_property
    def cards(self) -> Sequence[Row]:
        """Cards of the standard data sets, short: what a condition is in words, no parameters."""
        short = ("name", "version", "detector", "mask", "observation", "units")
        words = ("conditions", "bounds", "description", "follows", "stands_for", "splits")
        return [
            {
                **{name: card[name] for name in (*short, *words, "preview")},
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
        """Return the bound (rms, degrees) of each condition of a data set that has one pinned.

        Over all samples of the test split where the direction is observable; a score's bound is
        over those of them that its pipeline answered.
        """
        return {
            condition: pin.bound_deg
            for condition in self.presets[dataset].conditions
            if (pin := self._pin(dataset, condition, "test")) and pin.bound_deg is not None
        }

    def board_rows(self, dataset: str | None = None) -> Sequence[Row]:
        """Rows of the leaderboard, of one data set or of all."""
        return [
            row
            for board in self.leaderboard["datasets"]
            if dataset is None or board["name"] == dataset
            for row in board.get("rows", ())
        ]


def _score(row: Row) -> Score:
    """Return a score as recommendations take it; without an error where the run was refused."""
    half = row["half_fov_deg"]
    cones: list[tuple[float, float | None]] = []
    if half is not None:
        # The last ring may reach beyond the field; all its samples lie within.
        for edge in EDGES_DEG[1:]:
            cones.append((min(float(edge), half), field_error(row, edge)))
            if edge >= half:
                break
    plain: dict[str, Any] = {name: row[name] for name in _PLAIN}
    return Score(**plain, available=is_available(row), cones=tuple(cones))
