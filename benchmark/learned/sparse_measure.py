"""SSCNN on the data set nearest to the sensor of its paper: errors, trust, and why so large."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from algorithms.chain import Scored
from algorithms.contract import Extractor, Floats
from benchmark.datasets.preset import Preset
from benchmark.learned.frames import Frames, Unit
from benchmark.learned.measure import (
    UNITS,
    Calibrated,
    CentreTask,
    Read,
    by_extractor,
    calibrated,
    found_by,
    rms_error,
    split_of,
    times_slower,
    trust,
)
from benchmark.learned.sparse import SparseReader
from benchmark.learned.sparse_training import LOOK, STEPS
from benchmark.metrics.separation import store

#: The paper's mean error of the two angles, degrees (Herman2025c, abstract).
PAPER_DEG = 0.005


@dataclass(frozen=True)
class SparseTask:
    """The data set, the pipeline that leads it with its bound, and networks.

    `reader` learned several units; `of_one` are networks that learned unit 1 itself, as the paper's
    did its one sensor, by the numbers of their frames and steps.
    """

    preset: Preset
    extractor: type[Extractor]
    model: Scored
    bound_deg: float
    reader: SparseReader
    of_one: Mapping[tuple[int, int], SparseReader]


@dataclass(frozen=True)
class Direct:
    """A network's own answers, without a calibration on the unit."""

    reader: SparseReader

    def answers(self, frames: Frames) -> tuple[Floats, Any]:
        """Return directions (N, 3), and which of them are answers (N,)."""
        tangents, _ = self.reader.read(frames.corrected, frames.origin_px)
        ahead = np.column_stack([tangents, np.ones(len(tangents))])
        found = ahead / np.linalg.norm(ahead, axis=1, keepdims=True)
        found[~np.isfinite(tangents).all(axis=1)] = np.nan
        return found, np.isfinite(found).all(axis=1)


def _as_spots(reader: SparseReader) -> Read:
    """Return how tangents become places on the detector, for a model that calibrates them."""

    def read(frames: Frames) -> tuple[Floats, Any]:
        tangents, _ = reader.read(frames.corrected, frames.origin_px)
        places = np.asarray(tangents * reader.scale_px + reader.centre_px)
        return places, np.isfinite(places).all(axis=1)

    return read


def measure(task: SparseTask) -> dict[str, Any]:
    """Return the row: errors of the classical pipeline, of the network alone and tuned, and why."""
    geometry = task.preset.geometry_for(task.preset.conditions[0])
    extractor = task.extractor.for_sensor(geometry)
    behind = CentreTask(task.preset, task.extractor, task.model, task.bound_deg, LOOK, {})
    errors: dict[str, list[float | None]] = {"classical": [], "alone": [], "tuned": []}
    means: dict[str, list[float]] = {name: [] for name in errors}
    ablation: list[dict[str, Any]] = []
    for number in UNITS:
        unit = Unit(task.preset.for_unit(number))
        known, test = split_of(unit, "calibration"), split_of(unit, "test")
        ways: dict[str, Calibrated | Direct | None] = {
            "classical": calibrated(behind, found_by(extractor), known),
            "alone": Direct(task.reader),
            "tuned": calibrated(behind, _as_spots(task.reader), known),
        }
        for name, one in ways.items():
            errors[name].append(None if one is None else rms_error(one, test))
            if one is not None:
                means[name].append(mean_of_angles(one, test))
        if number == UNITS.start:
            slower = times_slower(found_by(extractor), _as_spots(task.reader), test)
            flagged = calibrated(behind, by_extractor(extractor), known)
            tried = trust(unit, {"tuned": ways["tuned"], "classical": flagged}, test)
            for (frames, steps), reader in sorted(task.of_one.items()):
                answers, learned = Direct(reader), f"unit {number} itself"
                ablation.append(
                    {
                        "learned": learned,
                        "frames": frames,
                        "steps": steps,
                        "mean_deg": store(mean_of_angles(answers, test)),
                        "rms_deg": rms_error(answers, test),
                    }
                )
    trained = task.reader.network.card
    for name, found in means.items():
        ablation.append(
            {
                "learned": "no network" if name == "classical" else f"other units, {name}",
                "frames": 0 if name == "classical" else trained["frames"],
                "steps": 0 if name == "classical" else STEPS,
                "mean_deg": store(float(np.mean(found))),
                "rms_deg": store(float(np.sqrt(np.mean(np.square(errors[name]))))),  # type: ignore[arg-type]
            }
        )
    return {
        "dataset": task.preset.name,
        "network": "sscnn",
        "extractor": task.extractor.about.name,
        "model": task.model.about.name,
        "bound_deg": task.bound_deg,
        "errors_deg": errors,
        "validation": trained["validation_deg"],
        "parameters": task.reader.network.parameters,
        "frames": trained["frames"],
        "times_slower": slower,
        "trust": tried,
        "ablation": ablation,
    }


def mean_of_angles(one: Calibrated | Direct, test: Frames) -> float:
    """Return the mean absolute error of both angles, degrees, over all answers."""
    answers, _ = one.answers(test)
    off = [np.degrees(np.arctan(found[:, :2] / found[:, 2:])) for found in (answers, test.sun)]
    return float(np.nanmean(np.abs(off[0] - off[1])))
