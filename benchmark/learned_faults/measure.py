"""What one worker does: network and pipeline on the same frames under every fault."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from algorithms.chain import Scored
from algorithms.contract import Extractor, FeatureKind, Floats
from algorithms.models.geometric.bare_detector import BareDetector
from benchmark.datasets.preset import Preset
from benchmark.learned.frames import Frames
from benchmark.learned.measure import (
    UNITS,
    WRONG,
    Answers,
    Calibrated,
    CentreTask,
    Read,
    by_extractor,
    calibrated,
    split_of,
)
from benchmark.learned_faults.deep import LOOK, DeepReader
from benchmark.learned_faults.frames import GROUP, FaultyUnit
from benchmark.learned_faults.rule import FAR_DEG, FAULTS, FRAMES
from benchmark.metrics.separation import separation_deg, store

#: Ways of reading.
WAYS = ("classical", "network")


@dataclass(frozen=True)
class FaultTask:
    """Faults, the pipeline that leads the data set, and the network."""

    faults: Sequence[str]
    preset: Preset
    extractor: type[Extractor]
    model: Scored
    reader: DeepReader


def by_reader(reader: DeepReader, geometry: Any) -> Read:
    """Return how a network's angles become places on the detector, for a model to calibrate."""
    scale = geometry.focal_length_mm / geometry.pixel_pitch_mm

    def read(frames: Frames) -> tuple[Floats, Any]:
        tangents, _ = reader.read(frames.corrected)
        places = np.asarray(tangents * scale + geometry.centre_px)
        return places, np.isfinite(places).all(axis=1)

    return read


def ways_of(task: FaultTask, unit: FaultyUnit) -> dict[str, Answers]:
    """Return both ways of reading, calibrated on clean poses of a unit."""
    geometry = task.preset.geometry_for(task.preset.conditions[0])
    known = split_of(unit, "calibration")
    behind = CentreTask(task.preset, task.extractor, task.model, 0.0, LOOK, {})
    classical = calibrated(behind, by_extractor(task.extractor.for_sensor(geometry)), known)
    if classical is None:
        raise ValueError(f"{task.model.about.name} refuses the calibration of unit {unit}")
    read = by_reader(task.reader, geometry)
    model = BareDetector.for_sensor(geometry, FeatureKind.SPOT).fit(read(known)[0], known.sun)
    return {WAYS[0]: classical, WAYS[1]: Calibrated(read, model)}


def errors_of(
    ways: Mapping[str, Answers], unit: FaultyUnit, fault: str, strength: float
) -> dict[str, Floats]:
    """By way, degrees (FRAMES,) that answers are off; NaN for none, and for one with a flag."""
    found: dict[str, list[Floats]] = {way: [] for way in ways}
    for group in range(FRAMES // GROUP):
        frames = unit.struck(fault, strength, GROUP, "score", group)
        for way, one in ways.items():
            answers, stands = one.answers(frames)
            found[way].append(np.where(stands, separation_deg(answers, frames.sun), np.nan))
    return {way: np.concatenate(parts) for way, parts in found.items()}


def measure(task: FaultTask) -> list[dict[str, Any]]:
    """Return the row of each fault: by way and strength what each unit's frames gave."""
    found: dict[tuple[str, str, float], list[dict[str, Any]]] = defaultdict(list)
    for number in UNITS:
        unit = FaultyUnit(task.preset.for_unit(number))
        ways = ways_of(task, unit)
        clean = errors_of(ways, unit, task.faults[0], 0.0)
        for fault in task.faults:
            for strength in (0.0, *FAULTS[fault]):
                off = errors_of(ways, unit, fault, strength) if strength else clean
                for way in ways:
                    own = float(np.sqrt(np.nanmean(clean[way] ** 2)))
                    found[way, fault, strength].append(_counted(off[way], own))
    card = task.reader.network.card
    return [
        {
            "dataset": task.preset.name,
            "network": "sscnn under faults",
            "fault": fault,
            "extractor": task.extractor.about.name,
            "model": task.model.about.name,
            "frames": FRAMES,
            "strengths": [0.0, *FAULTS[fault]],
            "ways": {
                way: {
                    name: [
                        [counts[name] for counts in found[way, fault, strength]]
                        for strength in (0.0, *FAULTS[fault])
                    ]
                    for name in ("answered", "wrong", "far", "rms_deg", "median_deg")
                }
                for way in WAYS
            },
            "validation": card["validation_deg"],
            "parameters": task.reader.network.parameters,
            "learned": card["frames"],
        }
        for fault in task.faults
    ]


def _counted(off: Floats, own: float) -> dict[str, Any]:
    """Count answers, wrong and far ones, and return their errors, None without any."""
    given = off[np.isfinite(off)]
    some = len(given) > 0
    return {
        "answered": len(given),
        "wrong": int((given > WRONG * own).sum()),
        "far": int((given > FAR_DEG).sum()),
        "rms_deg": store(float(np.sqrt(np.mean(given**2)))) if some else None,
        "median_deg": store(float(np.median(given))) if some else None,
    }
