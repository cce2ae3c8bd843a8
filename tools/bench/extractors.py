"""Extractors of single spots beside other libraries: ``python -m tools.bench.extractors``.

Error as a multiple of the Cramer-Rao bound, time as a multiple of a Python loop of OpenCV's
threshold and moments, both per axis and per frame. Methods and loop take turns in one process on
one thread; ratios are of the best times. Exit status 1 when a limit that holds is broken.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Extractor, FeatureKind, Floats, Observation, SensorGeometry
from algorithms.discovery import discover_extractors
from algorithms.extractors.frames.centroid import BasicCentroid, FilteredCentroid
from algorithms.extractors.frames.template import TemplateMatch
from algorithms.extractors.frames.threshold_average import MultipleThresholdCentroid
from benchmark import datasets
from benchmark.running.threads import one_thread
from benchmark.synthetic_features.frames import REFERENCE_SETS, SyntheticSet
from tools.bench.extractor_limits import (
    NOISE_RANGE_E,
    OPENCV,
    Figures,
    over_noise,
    verdicts,
)
from tools.bench.extractor_peers import Method, opencv_loop, peers
from tools.bench.verdicts import Verdict, any_broken

#: Frames of many spots, which have no bound of their own here, and the methods for them.
MANY = "cmos-multi-aperture"
_MANY_SPOTS = frozenset({"MCAM", "FMMS", "FEIC"})
_MANY_FRAMES = 10
#: Frames of a set and turns of a method, where nothing else is asked for.
_FRAMES, _REPEATS = 1000, 5
#: Pitch of the sensor that the sets' spots are the shadow of; any will do.
_PITCH_MM = 0.01
#: Frames that tell how slow a method is, and seconds that one run of it may take.
_FIRST_FRAMES = 20
_SECONDS = 20.0
#: A run that takes longer is not repeated; shorter ones are until they took this together.
_LONG_S = 2.0
_SHORT_S = 0.1


@dataclass(frozen=True)
class ExtractorResult:
    """One method on one reference set.

    Attributes
    ----------
    set_name, method
        What was measured.
    error_px
        Root mean square error of an axis over the frames with a result; NaN where there is none.
    over_bound
        The same over the set's bound.
    missing
        Fraction of frames without a result.
    us, over_opencv
        Best time a frame, and over that of the OpenCV loop.
    frames
        How many frames: fewer for a peer that takes too long.
    """

    set_name: str
    method: str
    error_px: float
    over_bound: float
    missing: float
    us: float
    over_opencv: float
    frames: int


def methods(chosen: SyntheticSet) -> dict[str, Method]:
    """Return the extractors of single spots, by name, and their options of interest.

    Each is made for a sensor whose round aperture is as wide as the spot at half its light.
    """
    half = chosen.scale_px * (np.sqrt(2 * np.log(2)) if chosen.shape == "gaussian" else 1.0)
    return {name: made.extract for name, made in single_spot(half, chosen.size_px).items()}


def single_spot(half_px: float, size_px: int) -> dict[str, Extractor]:
    """Return the extractors of single spots, and their options of interest, by name.

    Made for a sensor with frames of this side and a round aperture of this half width.
    """
    middle = (size_px - 1) / 2.0
    sensor = SensorGeometry(
        focal_length_mm=1.0,
        pixel_pitch_mm=_PITCH_MM,
        centre_px=(middle, middle),
        aperture_width_mm=float(2 * half_px * _PITCH_MM),
        aperture_shape="round",
        half_fov_deg=30.0,
    )
    found: dict[str, Extractor] = {}
    for name, extractor in discover_extractors().items():
        if (
            extractor.about.observation is Observation.FRAMES
            and extractor.about.kind is FeatureKind.SPOT
        ):
            try:
                found[name] = extractor.for_sensor(sensor)
            except ValueError:  # not a method for one spot
                continue
    found |= {
        "bcm background=border": BasicCentroid(background="border"),
        "ifm background=border": FilteredCentroid(background="border"),
        "mt-acm crossing=linear": MultipleThresholdCentroid(crossing="linear"),
        "tm binarise=no": TemplateMatch(width_px=float(2 * half_px), binarise=False),
    }
    return {name: found[name] for name in sorted(found)}


def measure(
    chosen: SyntheticSet, count: int, repeats: int, only: Sequence[str] | None = None
) -> list[ExtractorResult]:
    """Measure every method and peer (or those named) on the first `count` frames of a set.

    ValueError for a name that is not measured.
    """
    frames, centres = chosen.frames(count)
    bound = chosen.bound_px(centres[:100])
    todo: dict[str, Method] = {OPENCV: opencv_loop, **methods(chosen), **peers()[0]}
    if only is not None:
        unknown = sorted(set(only) - set(todo))
        if unknown:
            raise ValueError(f"no method named {', '.join(unknown)}; there are {', '.join(todo)}")
        todo = {name: todo[name] for name in todo if name in only}
    rows = []
    with one_thread():
        for name, method in todo.items():
            method(frames[:2])  # compiled, and warm
            number = min(count, _FIRST_FRAMES)
            once, _ = _timed(method, frames[:number])
            number = max(min(count, int(_SECONDS * number / once)), number)
            part = frames[:number]
            best = reference = float("inf")
            turns, spent = 0, 0.0
            while turns < repeats or spent < _SHORT_S:
                reference = min(reference, _timed(opencv_loop, part)[0])
                seconds, found = _timed(method, part)
                best = min(best, seconds)
                turns, spent = turns + 1, spent + seconds
                if best > _LONG_S:
                    break
            missing = np.isnan(found).any(axis=1)
            squares = (found[~missing] - centres[:number][~missing]) ** 2
            error = float(np.sqrt(squares.mean())) if squares.size else float("nan")
            rows.append(
                ExtractorResult(
                    set_name=chosen.name,
                    method=name,
                    error_px=error,
                    over_bound=error / bound,
                    missing=float(missing.mean()),
                    us=1e6 * best / number,
                    over_opencv=best / reference,
                    frames=number,
                )
            )
    return rows


def measure_many_spots(count: int, repeats: int) -> list[ExtractorResult]:
    """Measure the time of the methods for many spots, on frames of `cmos-multi-aperture`.

    100 spots on 1024 x 1024 px. Of the errors the leaderboard tells; they are NaN here.
    """
    preset = datasets.get(MANY)
    frames = preset.generate("nominal", "test", count).observations
    rows = []
    with one_thread():
        for name, extractor in discover_extractors().items():
            if extractor.about.taxonomy not in _MANY_SPOTS:
                continue
            method = extractor.for_sensor(preset.geometry).extract
            method(frames[:1])
            best = reference = float("inf")
            for _ in range(repeats):
                reference = min(reference, _timed(opencv_loop, frames)[0])
                seconds, found = _timed(method, frames)
                best = min(best, seconds)
            rows.append(
                ExtractorResult(
                    set_name=MANY,
                    method=name,
                    error_px=float("nan"),
                    over_bound=float("nan"),
                    missing=float(np.isnan(found).any(axis=1).mean()),
                    us=1e6 * best / len(frames),
                    over_opencv=best / reference,
                    frames=len(frames),
                )
            )
    return rows


def noise_range(
    chosen: SyntheticSet, method: Method, factors: Sequence[float], count: int
) -> dict[float, float]:
    """Return a method's error, px, with the set's read noise times each factor."""
    found = {}
    for factor in factors:
        noisy = replace(chosen, read_noise_e=chosen.read_noise_e * factor)
        frames, centres = noisy.frames(count)
        found[factor] = float(np.sqrt(np.nanmean((method(frames) - centres) ** 2)))
    return found


def _timed(method: Method, frames: NDArray[Any]) -> tuple[float, Floats]:
    started = time.perf_counter()
    found = method(frames)
    return time.perf_counter() - started, found


def verdicts_of(rows: Sequence[ExtractorResult]) -> list[Verdict]:
    """Return the verdicts on what was measured, and on the templates' range of noise."""
    figures = {
        (row.set_name, row.method): Figures(
            row.error_px, row.over_bound, row.over_opencv, row.frames
        )
        for row in rows
    }
    found = verdicts(figures)
    disc = REFERENCE_SETS["disc"]
    factors = [noise / disc.read_noise_e for noise in NOISE_RANGE_E]
    for name in ("tm", "tm binarise=no"):
        if ("disc", name) in figures:
            count = figures["disc", name].frames
            errors = noise_range(disc, methods(disc)[name], factors, count)
            found.append(over_noise(name, [errors[factor] for factor in factors]))
    return found


def run() -> list[Verdict]:
    """Measure and print everything; return the verdicts."""
    rows = [row for chosen in REFERENCE_SETS.values() for row in measure(chosen, _FRAMES, _REPEATS)]
    rows += measure_many_spots(_MANY_FRAMES, _REPEATS)
    found = verdicts_of(rows)
    _print_table(rows, found, peers()[1])
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print, and return the exit status."""
    parser = argparse.ArgumentParser(prog="python -m tools.bench.extractors")
    parser.add_argument("--sets", nargs="+", choices=REFERENCE_SETS, default=[*REFERENCE_SETS])
    parser.add_argument("--methods", nargs="+", help="only these (default: all)")
    for name, default, what in (
        ("frames", _FRAMES, "frames of a set"),
        ("repeats", _REPEATS, "turns of each"),
    ):
        parser.add_argument(
            f"--{name}", type=int, default=default, help=f"{what} (default {default})"
        )
    parser.add_argument("--format", choices=("table", "json"), default="table")
    given = parser.parse_args(arguments)
    for name in ("frames", "repeats"):
        if getattr(given, name) < 1:
            parser.error(f"--{name} must be at least 1; got {getattr(given, name)}")
    rows = []
    for name in given.sets:
        try:
            rows += measure(REFERENCE_SETS[name], given.frames, given.repeats, given.methods)
        except ValueError as error:
            parser.error(str(error))
    if given.methods is None:
        rows += measure_many_spots(min(given.frames, _MANY_FRAMES), given.repeats)
    found, missing = verdicts_of(rows), peers()[1]
    if given.format == "json":
        limits = [{**asdict(verdict), "holds": verdict.holds} for verdict in found]
        measured = [asdict(row) for row in rows]
        print(json.dumps({"measured": measured, "limits": limits, "not_installed": missing}))
    else:
        _print_table(rows, found, missing)
    return 1 if any_broken(found) else 0


def _print_table(
    rows: Sequence[ExtractorResult], found: Sequence[Verdict], missing: Sequence[str]
) -> None:
    heads = ("error px", "x bound", "missing", "us", "x OpenCV", "frames")
    print(f"{'set':<20}{'method':<30}" + "".join(f"{head:>11}" for head in heads))
    for row in rows:
        print(
            f"{row.set_name:<20}{row.method:<30}{row.error_px:>11.5f}{row.over_bound:>11.3f}"
            f"{row.missing:>11.3f}{row.us:>11.2f}{row.over_opencv:>11.3f}{row.frames:>11d}"
        )
    for library in missing:
        print(f"{library}: not installed (make bench installs it)")
    print()
    for verdict in found:
        word = "holds" if verdict.holds else "does not hold" if verdict.cannot else "BROKEN"
        why = f" ({verdict.cannot})" if verdict.cannot and not verdict.holds else ""
        print(f"{verdict.what} {verdict.value:.3f}, limit {verdict.most:g}: {word}{why}")


if __name__ == "__main__":
    sys.exit(main())
