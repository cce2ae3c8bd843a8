"""The published measurements: scores, leaderboard, sweeps, curves, the standard data sets."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from api.metadata.identity import version
from api.schema.samples import SampleError
from api.schema.table import columns_of
from benchmark.contract import Cell
from benchmark.datasets.pins import Pin
from benchmark.leaderboard.board import build
from benchmark.leaderboard.scope import Studied, studies_of_pipelines
from benchmark.learning_curves import record as curves
from benchmark.metrics.ranking import own_errors, spreads
from benchmark.results import record_manifest, samples
from benchmark.results.pipelines import pipelines, standard_benches
from benchmark.results.store import PUBLISHED, PUBLISHED_STUDIES, Store
from benchmark.results.times import Times, read_times
from benchmark.sweeps.record import swept
from files import manifest
from files.reading import read_bytes
from registry.measured_pipelines import MeasuredPipeline

if TYPE_CHECKING:
    import pandas as pd

    from benchmark.claims.ledger import Entry
    from benchmark.datasets import Preset

Row = Mapping[str, Any]


class Measurements:
    """Published measurements, each file read once; a directory may have none.

    Parameters
    ----------
    directory : of the published files
    """

    def __init__(self, directory: Path = PUBLISHED) -> None:
        self.directory = directory

    @cached_property
    def _store(self) -> Store:
        """The published files, which must be as commands wrote them."""
        record_manifest.require_unchanged(self.directory, required=self.directory == PUBLISHED)
        return Store(self.directory)

    @cached_property
    def digest(self) -> str | None:
        """SHA-256 of the manifest of the published files; None where there is none."""
        return manifest.manifest_digest(self._store.directory)

    @property
    def record(self) -> Mapping[str, str | None]:
        """Which record this is: version of the atlas, and `manifest_digest`."""
        return {"version": version(), "sha256": self.digest}

    @cached_property
    def _studies_store(self) -> Store:
        """The published files of the sensors of single studies, beside the others."""
        directory = self.directory.with_name(PUBLISHED_STUDIES.name)
        record_manifest.require_unchanged(directory, required=directory == PUBLISHED_STUDIES)
        return Store(directory)

    @cached_property
    def _every_unit(self) -> Sequence[Row]:
        return self._store.rows(unit=None)

    @cached_property
    def _with_studies(self) -> Sequence[Row]:
        """Score rows of all units, those on sensors of single studies too."""
        return [*self._every_unit, *self._studies_store.rows(unit=None)]

    @cached_property
    def scores(self) -> Sequence[Row]:
        """Score rows of the standard unit, sorted by data set, condition, extractor and model."""
        return [row for row in self._every_unit if row["unit"] == 0]

    @cached_property
    def directions(self) -> Sequence[Mapping[str, Any]]:
        """What came of the survey's future directions."""
        from benchmark.directions import outcomes as found  # noqa: PLC0415 - loads the simulator

        return found.outcomes(self._every_unit, found.read_trials(self._store.directory))

    @cached_property
    def score_of(self) -> Mapping[tuple[str, str, str, str], Row]:
        """Score of unit 0 by data set, condition, extractor and model.

        `own_error_deg` is the geometric mean over the units measured under the condition. Sensors
        of single studies are among the data sets.
        """
        own = spreads(self._with_studies)
        found = {}
        for row in self._with_studies:
            if row["unit"] != 0:
                continue
            cell = Cell(row["dataset"], row["condition"], row["extractor"], row["model"])
            place = (cell.dataset, cell.condition, cell.extractor, cell.model)
            found[place] = {**row, "own_error_deg": own[cell].own_error_deg}
        return found

    @cached_property
    def own_errors(self) -> Mapping[tuple[str, str, str, str], float | None]:
        """Own error by the same places, degrees; None where no score came of it."""
        return own_errors(self._with_studies)

    @cached_property
    def nominal(self) -> Mapping[tuple[str, str, str], Row]:
        """The same under the first condition of each data set, by data set, extractor and model."""
        first = {name: preset.conditions[0] for name, preset in self.presets.items()}
        return {
            (row["dataset"], row["extractor"], row["model"]): row
            for row in self.score_of.values()
            if row["condition"] == first.get(row["dataset"])
        }

    @cached_property
    def times(self) -> Times:
        """Running times of the pipelines, and the machine they were measured on."""
        return read_times(self.directory)

    @cached_property
    def pipelines(self) -> list[MeasuredPipeline]:
        """What is measured of every pipeline on every data set, for recommendations."""
        latency_us, benches = self.times.latency_us, standard_benches(self._store.pins())
        return pipelines(self._every_unit, latency_us, benches)

    @cached_property
    def leaderboard(self) -> Mapping[str, Any]:
        """The leaderboard of the published scores; without data sets where there are none."""
        pins = self._store.pins()
        board = build(self._every_unit, self.times, self.sweeps, self._studied, pins)
        return board if board["datasets"] else {"schema": None, "datasets": []}

    @property
    def _studied(self) -> Studied:
        """Studies by the pipelines they used; of nothing published, none, as that takes seconds."""
        return studies_of_pipelines() if self._every_unit else {}

    @cached_property
    def sweeps(self) -> Sequence[Row]:
        """Rows of the sweeps on reference features, in order."""
        return swept(self._store.directory)

    @cached_property
    def curves(self) -> Sequence[Row]:
        """Learning curves of the leaders, by data set and place."""
        return curves.published_curves(self._store.directory)

    @cached_property
    def curve_of(self) -> Mapping[tuple[str, ...], Row]:
        """Learning curve by data set, extractor and model."""
        return {(row["dataset"], row["extractor"], row["model"]): row for row in self.curves}

    @cached_property
    def assessment(self) -> Mapping[str, Any]:
        """The survey's assessment beside the measured one, with definitions and totals."""
        from benchmark.assessment import assess as assessment  # noqa: PLC0415 - imports every implementation

        directory = self._store.directory
        assessed = assessment.assess(directory, times=self.times.rows, scores=self.scores)
        return assessment.document(assessed)

    @cached_property
    def claims(self) -> Mapping[str, Entry]:
        """The survey's claims with their verdicts, by id."""
        from benchmark.claims.ledger import ledger  # noqa: PLC0415 - SciPy's distributions

        return {entry.claim.id: entry for entry in ledger(self._store.directory)}

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

    def preset(self, dataset: str) -> Preset:
        """Return a data set, a standard one or the sensor of a study."""
        from benchmark import datasets  # noqa: PLC0415 - as `presets`

        return datasets.get(dataset)

    @cached_property
    def pins(self) -> Mapping[tuple[str, str, str], Pin]:
        """Hashes and bounds of the published data by (data set, condition, split)."""
        return {**self._store.pins(), **self._studies_store.pins()}

    @cached_property
    def cards(self) -> Sequence[Row]:
        """Cards of the standard data sets, short: what a condition is in words, no parameters."""
        short = ("name", "version", "detector", "mask", "observation", "units")
        words = ("conditions", "bounds", "description", "follows", "represents", "splits")
        return [
            {
                **{name: card[name] for name in (*short, *words, "preview")},
                "setups": {
                    condition: {"description": setup["description"]}
                    for condition, setup in card["setups"].items()
                },
            }
            for card in self._whole_cards.values()
        ]

    @cached_property
    def _whole_cards(self) -> Mapping[str, dict[str, Any]]:
        """Cards by data set: of one in orbit it takes as long to make as a hundred answers."""
        return {name: self._card(name) for name in self.presets}

    def card(self, dataset: str) -> dict[str, Any]:
        """Return the whole card of a data set: conditions by name, what they are in `setups`.

        `bounds` are the published ones: the Cramer-Rao bound of the condition, as rms in degrees.
        `data` are the published hashes, and `preview` is where the picture is served.
        """
        if dataset in vars(self).get("_whole_cards", ()):
            return dict(self._whole_cards[dataset])
        return self._card(dataset)  # the only one that is asked for, as by the command line

    def _card(self, dataset: str) -> dict[str, Any]:
        preset = self.preset(dataset)
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
        return pin if pin and pin.version == self.preset(dataset).version else None

    def bounds(self, dataset: str) -> dict[str, float]:
        """Return the bound (rms, degrees) of each condition of a data set that has one pinned.

        Over all samples of the test split where the direction is observable; a score's bound is
        over those of them that its pipeline answered.
        """
        return {
            condition: pin.bound_deg
            for condition in self.preset(dataset).conditions
            if (pin := self._pin(dataset, condition, "test")) and pin.bound_deg is not None
        }

    def file(self, path: str) -> bytes:
        """Return the bytes of a published file; FileNotFoundError where there is none.

        Parameters
        ----------
        path : relative to the published files
        """
        return read_bytes(self._store.directory / path)

    @cached_property
    def sample_errors(self) -> Callable[[str], pd.DataFrame]:
        """Give a data set's errors with what its samples are; no rows where there are none.

        The last that was asked for stays in memory.
        """
        import pandas as pd  # noqa: PLC0415 - half a second that only this needs

        @lru_cache(1)
        def read(dataset: str) -> pd.DataFrame:
            directory = self._store.directory
            try:
                found = samples.read_samples(dataset, directory)
            except FileNotFoundError:
                return pd.DataFrame(columns=list(columns_of(SampleError)))
            return found.merge(samples.read_directions(dataset, directory), on="sample", how="left")

        return read

    def board_rows(self, dataset: str | None = None) -> Sequence[Row]:
        """Rows of the leaderboard, of one data set or of all."""
        return [
            row
            for board in self.leaderboard["datasets"]
            if dataset is None or board["name"] == dataset
            for row in board.get("rows", ())
        ]
