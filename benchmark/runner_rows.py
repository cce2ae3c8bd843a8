"""The rows a result is stored as, and their keys."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from functools import cache, partial

from algorithms.contract import Extractor, Model, SensorGeometry
from benchmark.content_key import (
    HARNESS_VERSION,
    SCHEMA_VERSION,
    Specifications,
    cell_key,
    digest,
    implementation_key,
    joined_hash,
    seed,
)
from benchmark.content_key_closure import closure_digest
from benchmark.plan import Cell
from benchmark.plan_parts import SPLITS, Parts
from benchmark.runner_unit import Outcome, UnitResult
from benchmark.scoring import METRIC_VERSION, METRICS, stored
from benchmark.store import Pin, Row


class Keys:
    """Keys of cells; digests of code are computed once for each part."""

    def __init__(self, parts: Parts, specifications: Specifications | None = None) -> None:
        self._parts = parts
        self._specifications = specifications or Specifications()
        self._code = cache(closure_digest)
        self._implementations: dict[Hashable, str] = {}
        self._geometries: dict[int, SensorGeometry] = {}

    def pinned_hash(self, cell: Cell, pins: Mapping[tuple[str, str, str], Pin]) -> str | None:
        """Hash of the cell's data, trusted because code and parameters are those it was pinned for.

        None where a split has no pin or was pinned for other code.
        """
        specification = self._specification(cell.dataset, cell.condition)
        found = {}
        for split in SPLITS:
            pin = pins.get((cell.dataset, cell.condition, split))
            if pin is None or pin.specification != specification:
                return None
            found[split] = pin.data_hash
        return joined_hash(found)

    def joined(self, split_hashes: Mapping[str, str]) -> str | None:
        """One hash for all splits; None where one is missing."""
        return joined_hash(split_hashes) if set(split_hashes) == set(SPLITS) else None

    def key(self, cell: Cell, data_hash: str | None) -> str:
        """Key of a cell's result, given the hash of its data.

        An implementation that cannot be built for the sensor enters without parameters; what is
        measured then is its failure.
        """
        geometry = self._parts.preset(cell.dataset).geometry_for(cell.condition)
        extractor = self._parts.extractor(cell.extractor)
        model = self._parts.model(cell.model)
        self._geometries[id(geometry)] = geometry  # kept, so that no other takes its identity
        place = (id(geometry), extractor)
        return cell_key(
            self._specification(cell.dataset, cell.condition),
            data_hash,
            self._implementation(place, extractor, partial(extractor.for_sensor, geometry)),
            self._implementation(
                (id(geometry), model, extractor.kind),
                model,
                partial(model.for_sensor, geometry, extractor.kind),
            ),
            seed(cell.dataset, cell.condition, cell.extractor, cell.model),
        )

    def _implementation(
        self,
        place: Hashable,
        implementation: type[Extractor | Model],
        build: Callable[[], Extractor | Model],
    ) -> str:
        """Digest of an implementation as built for one geometry."""
        if place not in self._implementations:
            key = implementation_key(implementation, build, self._code)
            self._implementations[place] = digest(key)
        return self._implementations[place]

    def _specification(self, dataset: str, condition: str) -> str:
        return self._specifications.of(self._parts.preset(dataset), condition)


def score_row(key: str, data_hash: str | None, result: UnitResult, outcome: Outcome) -> Row:
    """Make the row of scores.jsonl: depends on code and data only."""
    unit = result.unit
    model = next(model for model in unit.models if model.name == outcome.model)
    metrics: Mapping[str, float | None] = (
        outcome.score.row() if outcome.score else dict.fromkeys(METRICS)
    )
    return {
        "schema": SCHEMA_VERSION,
        "key": key,
        "dataset": unit.preset.name,
        "dataset_version": unit.preset.version,
        "condition": unit.condition,
        "detector": unit.preset.detector,
        "mask": unit.preset.mask,
        "half_fov_deg": unit.preset.geometry_for(unit.condition).half_fov_deg,
        "extractor": unit.extractor.name,
        "extractor_taxonomy": unit.extractor.taxonomy,
        "extractor_version": unit.extractor.version,
        "model": model.name,
        "model_taxonomy": model.taxonomy,
        "model_version": model.version,
        "status": "ok" if outcome.score else "refused" if outcome.refused else "failed",
        "reason": outcome.reason,
        "n_calibration": result.n_calibration,
        "n_test": result.n_test,
        **metrics,
        "data_hash": data_hash,
        "harness_version": HARNESS_VERSION,
        "metric_version": METRIC_VERSION,
    }


def run_row(key: str, cell: Cell, result: UnitResult, outcome: Outcome, environment: Row) -> Row:
    """Make the row of runs.jsonl: times of this run on this machine.

    ``latency_us`` is extraction and prediction of one test sample, taken in batch;
    ``time_ratio`` the same divided by `benchmark.runner_unit.reference` on the same observations.
    """
    row: Row = {
        "key": key,
        "dataset": cell.dataset,
        "condition": cell.condition,
        "extractor": cell.extractor,
        "model": cell.model,
        "extract_calibration_s": stored(result.extract_calibration_s),
        "fit_s": stored(outcome.fit_s),
        "extract_s": None,
        "predict_s": None,
        "reference_s": None,
        "latency_us": None,
        "time_ratio": None,
        "environment": environment,
    }
    if result.extract is not None and outcome.predict_s is not None:
        spent = result.extract.seconds + outcome.predict_s
        reference = result.extract.reference_s
        row |= {
            "extract_s": stored(result.extract.seconds),
            "predict_s": stored(outcome.predict_s),
            "reference_s": stored(reference),
            "latency_us": stored(1e6 * spent / result.n_test),
            "time_ratio": stored(spent / reference),
        }
    return row
