"""What one worker does: a network against the pipeline that leads, on units it has not seen."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from algorithms.chain import Scored
from algorithms.contract import Extractor, FeatureKind, Floats, UnusableDataError
from algorithms.pipeline import extract_features, in_detector_coordinates
from benchmark import datasets
from benchmark.datasets.preset import Preset
from benchmark.learned.centres import CentreReader, Look
from benchmark.learned.frames import Frames, Unit
from benchmark.learned.network import Network
from benchmark.metrics.score import is_available, score
from benchmark.metrics.separation import separation_deg, store
from benchmark.simulator.scene import Scene

#: Units that are scored; the standard one chose the pipelines.
UNITS = range(1, 6)
#: An answer that is off by more than so many own errors is wrong.
WRONG = 10.0
#: Frames of each trial of trust, those of whole cameras, and those of each mask not seen.
TRIED, TRIED_LARGE, UNSEEN_FRAMES = 1000, 300, 60
#: Masks whose frames a network is shown that learned another.
UNSEEN = ("cmos-single-aperture", "cmos-slit", "cmos-l-slit", "cmos-lens", "cmos-encoded")
#: What a network is tried with; without a Sun and under another mask every answer is wrong.
TRIALS = ("clean", "no Sun", "two Suns", "unseen mask")
_SUNLESS = frozenset({"no Sun", "unseen mask"})
#: Frames whose reading is timed, and how often.
_TIMED, _TIMES = 100, 5

#: Frames to detector coordinates (N, 2), or to directions (N, 3), and which have no flag.
Read = Callable[[Frames], tuple[Floats, Any]]


class Answers(Protocol):
    """What answers frames."""

    def answers(self, frames: Frames) -> tuple[Floats, Any]:
        """Return directions (N, 3), and which of them have no flag (N,)."""
        ...


@dataclass(frozen=True)
class CentreTask:
    """A data set, the pipeline that leads it with its bound, and networks by training seed.

    The network of the smallest seed decides; all are shown the same of a frame.
    """

    preset: Preset
    extractor: type[Extractor]
    model: Scored
    bound_deg: float
    look: Look
    networks: Mapping[int, Network]


def split_of(unit: Unit, split: str) -> Frames:
    """Return a split of a unit as it is scored, with its true Suns."""
    samples = unit.preset.generate(unit.preset.conditions[0], split)
    corrected = unit.correct(samples.observations, samples.origin_px)
    return Frames(corrected, samples.origin_px, np.asarray(samples.truth))


def by_network(reader: CentreReader) -> Read:
    """Return how a network reads frames."""

    def read(frames: Frames) -> tuple[Floats, Any]:
        centres, _ = reader.read(frames.corrected)
        moved = in_detector_coordinates(centres, FeatureKind.SPOT, frames.origin_px)
        return moved, np.isfinite(moved).all(axis=1)

    return read


def by_extractor(extractor: Extractor) -> Read:
    """Return how an extractor reads frames, and which answers have no flag."""

    def read(frames: Frames) -> tuple[Floats, Any]:
        found = extractor.measure(frames.corrected)
        moved = in_detector_coordinates(found.features, extractor.about.kind, frames.origin_px)
        return moved, np.isfinite(moved).all(axis=1) & (found.flags == 0)

    return read


@dataclass(frozen=True)
class Calibrated:
    """A way to read frames, and the calibration model behind it that was fitted to one unit."""

    read: Read
    model: Any

    def answers(self, frames: Frames) -> tuple[Floats, Any]:
        """Return directions (N, 3), and which of them have no flag (N,)."""
        features, stands = self.read(frames)
        return np.asarray(self.model.predict(features)), stands


def calibrated(task: CentreTask, read: Read, known: Frames) -> Calibrated | None:
    """Fit the task's model behind a reader; None where the model refuses."""
    geometry = task.preset.geometry_for(task.preset.conditions[0])
    model = task.model.for_sensor(geometry, task.extractor.about.kind)
    try:
        model.fit(read(known)[0], known.sun)
    except UnusableDataError:
        return None
    return Calibrated(read, model)


def measure(task: CentreTask) -> dict[str, Any]:
    """Return the row of a data set: errors of each way to read on each unit, times and trust."""
    geometry = task.preset.geometry_for(task.preset.conditions[0])
    extractor = task.extractor.for_sensor(geometry)
    # a chosen pipeline answers whatever its flags say, as the record scores it
    ways: dict[str, Read] = {"classical": found_by(extractor)}
    ways["centroid"] = by_network(CentreReader(None, task.look))
    for seed, made in sorted(task.networks.items()):
        ways[f"seed {seed}"] = by_network(CentreReader(made, task.look, made.card["limits"]))
    deciding = f"seed {min(task.networks)}"
    network = task.networks[min(task.networks)]
    errors: dict[str, list[float | None]] = {name: [] for name in ways}
    ratio, tried = 0.0, []
    for number in UNITS:
        unit = Unit(task.preset.for_unit(number))
        known, test = split_of(unit, "calibration"), split_of(unit, "test")
        fitted = {name: calibrated(task, read, known) for name, read in ways.items()}
        for name, one in fitted.items():
            errors[name].append(None if one is None else rms_error(one, test))
        if number == UNITS.start:
            ratio = times_slower(ways["classical"], ways[deciding], test)
            flagged = calibrated(task, by_extractor(extractor), known)
            tried = trust(unit, {deciding: fitted[deciding], "classical": flagged}, test)
    return {
        "dataset": task.preset.name,
        "network": "heat map",
        "extractor": task.extractor.about.name,
        "model": task.model.about.name,
        "bound_deg": task.bound_deg,
        "errors_deg": errors,
        "validation": network.card["validation_px"],
        "parameters": network.parameters,
        "frames": network.card["frames"],
        "times_slower": ratio,
        "trust": tried,
        "ablation": [],
    }


def found_by(extractor: Extractor) -> Read:
    """Return how an extractor reads frames, whatever its flags say."""

    def read(frames: Frames) -> tuple[Floats, Any]:
        found = extract_features(extractor, frames.corrected, frames.origin_px)
        return found, np.isfinite(found).all(axis=1)

    return read


def rms_error(one: Answers, test: Frames) -> float | None:
    """Return the RMS error over all answers; None below the availability that ranks."""
    answers, _ = one.answers(test)
    scored = score(answers, test.sun, None, np.ones(len(answers), dtype=np.bool_))
    if not is_available({"availability": scored.availability}):
        return None
    return store(scored.rms_all_answers_deg)


def times_slower(classical: Read, network: Read, test: Frames) -> float:
    """Return the network's time for a frame over the extractor's, the least of a few each."""
    origin = None if test.origin_px is None else test.origin_px[:_TIMED]
    part = Frames(test.corrected[:_TIMED], origin, test.sun[:_TIMED])
    least = []
    for read in (network, classical):
        spent = []
        for _ in range(_TIMES):
            begun = time.process_time()
            read(part)
            spent.append(time.process_time() - begun)
        least.append(min(spent))
    return float(f"{least[0] / least[1]:.3g}")


def trust(unit: Unit, ways: Mapping[str, Answers | None], test: Frames) -> list[dict[str, Any]]:
    """Count wrong answers without a Sun, under two, and under masks that were not seen."""
    count = TRIED if hasattr(unit.sensor, "lit") else TRIED_LARGE
    clean = unit.taken(unit.scene(count, "clean"), "clean")
    trials = {
        TRIALS[0]: [clean],
        TRIALS[1]: [unit.taken(_dark(unit.scene(count, "dark")), "dark")],
        TRIALS[2]: [_two(unit, count)],
        TRIALS[3]: [_unseen(name) for name in UNSEEN if name != unit.preset.name],
    }
    found = []
    for way, one in ways.items():
        if one is None:
            continue
        own = _rms(one, test)
        for name, frames in trials.items():
            counts = [_counted(one, part, own, sunless=name in _SUNLESS) for part in frames]
            answered, wrong = (sum(column) for column in zip(*counts, strict=True))
            total = sum(len(part.sun) for part in frames)
            found.append(
                {"way": way, "trial": name, "frames": total, "answered": answered, "wrong": wrong}
            )
    return found


def _rms(one: Answers, test: Frames) -> float:
    off = separation_deg(one.answers(test)[0], test.sun)
    return math.sqrt(float(np.nanmean(off**2)))


def _counted(one: Answers, frames: Frames, own: float, *, sunless: bool) -> tuple[int, int]:
    """Return how many frames are answered without a flag, and how many of these wrongly."""
    answers, stands = one.answers(frames)
    answered = np.isfinite(answers).all(axis=1) & stands
    off = separation_deg(answers, frames.sun)
    wrong = answered if sunless else answered & (off > WRONG * own)
    return int(answered.sum()), int(wrong.sum())


def _dark(scene: Scene) -> Scene:
    return replace(scene, irradiance=np.zeros(len(scene)))


def _two(unit: Unit, count: int) -> Frames:
    """Frames of two Suns; of cameras whose lens is not added to, the brighter of two frames."""
    scene = unit.scene(count, "two")
    if hasattr(unit.sensor, "lit"):
        return unit.taken(scene, "two", second=unit.placed(scene, "second"))
    both = [unit.taken(one, "two") for one in (scene, unit.scene(count, "second"))]
    return replace(both[0], corrected=np.maximum(*(one.corrected for one in both)))


def _unseen(name: str) -> Frames:
    """Frames of another data set's standard unit, corrected by its own references."""
    unit = Unit(datasets.get(name))
    return unit.taken(unit.scene(UNSEEN_FRAMES, "unseen"), "unseen")
