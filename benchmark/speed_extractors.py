"""Extractors of single spots on the reference frames: ``python -m benchmark.speed_extractors``.

Error as a multiple of the Cramer-Rao bound, time as a multiple of a Python loop of OpenCV's
threshold and moments, both per axis and per frame. Methods and loop take turns in one process on
one thread; ratios are of the best times.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Extractor, Floats
from algorithms.extractors.balance import DoubleBalance
from algorithms.extractors.centroid import BasicCentroid, FilteredCentroid, ThresholdedCentroid
from algorithms.extractors.matched import GaussianFit, MatchedProfile
from algorithms.extractors.peak import PixelMax
from algorithms.extractors.template import TemplateMatch
from algorithms.extractors.threshold_average import MultipleThresholdCentroid
from benchmark.reference_frames import REFERENCE_SETS, ReferenceSet
from benchmark.runner_timing import one_thread

_THRESHOLD = 0.3
#: Frames that a peer of seconds a thousand is measured on.
_FEW = 40

Method = Callable[[NDArray[Any]], Floats]


@dataclass(frozen=True)
class Measured:
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
        How many frames.
    """

    set_name: str
    method: str
    error_px: float
    over_bound: float
    missing: float
    us: float
    over_opencv: float
    frames: int


def methods(chosen: ReferenceSet) -> dict[str, Method]:
    """Return the extractors measured, by name; TM's template is the spot at half its light."""
    half = chosen.scale_px * (np.sqrt(2 * np.log(2)) if chosen.shape == "gaussian" else 1.0)
    found: dict[str, Extractor] = {
        "bcm": BasicCentroid(),
        "bcm background=border": BasicCentroid(background="border"),
        "bctm": ThresholdedCentroid(),
        "ifm": FilteredCentroid(),
        "ifm background=border": FilteredCentroid(background="border"),
        "pm": PixelMax(),
        "dbcm": DoubleBalance(),
        "mt-acm": MultipleThresholdCentroid(),
        "mt-acm crossing=linear": MultipleThresholdCentroid(crossing="linear"),
        "tm": TemplateMatch(width_px=float(2 * half)),
        "tm binarise=no": TemplateMatch(width_px=float(2 * half), binarise=False),
        "matched-profile": MatchedProfile(),
        "matched-profile steps=2": MatchedProfile(steps=2),
        "gaussian-fit": GaussianFit(),
    }
    return {name: extractor.extract for name, extractor in found.items()}


def opencv_loop(frames: NDArray[Any]) -> Floats:
    """Return the moments (N, 2) of the pixels above a fraction of the maximum, by OpenCV."""
    found = np.empty((len(frames), 2))
    for k, frame in enumerate(frames):
        _, largest, _, _ = cv2.minMaxLoc(frame)
        _, above = cv2.threshold(frame, _THRESHOLD * largest, 0, cv2.THRESH_TOZERO)
        m = cv2.moments(above)
        found[k] = m["m10"] / m["m00"], m["m01"] / m["m00"]
    return found


def scipy_gaussian(frames: NDArray[Any]) -> Floats:
    """Return the centres (N, 2) of Gaussians fitted by SciPy's `curve_fit`, as peers do."""
    from scipy.optimize import curve_fit  # noqa: PLC0415 - only when measured

    rows, columns = (axis.ravel() for axis in np.indices(frames.shape[1:]))

    def model(_: object, *p: float) -> Floats:
        across = np.exp(-(((columns - p[1]) / p[3]) ** 2) / 2)
        along = np.exp(-(((rows - p[2]) / p[4]) ** 2) / 2)
        return np.asarray(p[5] + p[0] * across * along, dtype=np.float64)

    found = np.empty((len(frames), 2))
    for k, (frame, (x, y)) in enumerate(zip(frames, opencv_loop(frames), strict=True)):
        dark, peak = float(np.median(frame)), float(frame.max())
        start = (peak - dark, float(x), float(y), 4.0, 4.0, dark)
        light = frame.ravel().astype(np.float64)
        fitted, _ = curve_fit(model, columns.astype(np.float64), light, start)
        found[k] = fitted[1:3]
    return found


def measure(
    chosen: ReferenceSet, count: int, repeats: int, only: Sequence[str] | None = None
) -> list[Measured]:
    """Measure every method (or those named) on the first `count` frames of a set.

    ValueError for a name that is not measured.
    """
    frames, centres = chosen.frames(count)
    bound = chosen.bound_px(centres[:100])
    todo: dict[str, tuple[Method, int]] = {"opencv threshold + moments": (opencv_loop, count)}
    todo |= {name: (method, count) for name, method in methods(chosen).items()}
    todo["scipy curve_fit gaussian"] = (scipy_gaussian, min(count, _FEW))
    if only is not None:
        unknown = sorted(set(only) - set(todo))
        if unknown:
            raise ValueError(f"no method named {', '.join(unknown)}; there are {', '.join(todo)}")
        todo = {name: todo[name] for name in todo if name in only}
    rows = []
    with one_thread():
        for name, (method, number) in todo.items():
            part = frames[:number]
            method(part[:2])  # compiled, and warm
            best = reference = float("inf")
            for _ in range(repeats):
                reference = min(reference, _seconds(opencv_loop, part))
                best = min(best, _seconds(method, part))
            found = method(part)
            missing = np.isnan(found).any(axis=1)
            squares = (found[~missing] - centres[:number][~missing]) ** 2
            error = float(np.sqrt(squares.mean())) if squares.size else float("nan")
            rows.append(
                Measured(
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


def noise_range(
    chosen: ReferenceSet, method: Method, factors: Sequence[float], count: int
) -> dict[float, float]:
    """Return a method's error, px, with the set's read noise times each factor."""
    found = {}
    for factor in factors:
        noisy = replace(chosen, read_noise_e=chosen.read_noise_e * factor)
        frames, centres = noisy.frames(count)
        found[factor] = float(np.sqrt(np.nanmean((method(frames) - centres) ** 2)))
    return found


def _seconds(method: Method, frames: NDArray[Any]) -> float:
    started = time.perf_counter()
    method(frames)
    return time.perf_counter() - started


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print, and return the exit status."""
    parser = argparse.ArgumentParser(prog="python -m benchmark.speed_extractors")
    parser.add_argument("--sets", nargs="+", choices=REFERENCE_SETS, default=["disc", "gaussian"])
    parser.add_argument("--methods", nargs="+", help="only these (default: all)")
    parser.add_argument("--frames", type=int, default=1000, help="frames of a set (default 1000)")
    parser.add_argument("--repeats", type=int, default=5, help="turns of each (default 5)")
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
    if given.format == "json":
        print(json.dumps({"measured": [asdict(row) for row in rows]}, indent=2))
        return 0
    heads = ("error px", "x bound", "missing", "us", "x OpenCV")
    print(f"{'set':<10}{'method':<28}" + "".join(f"{head:>11}" for head in heads))
    for row in rows:
        print(
            f"{row.set_name:<10}{row.method:<28}{row.error_px:>11.5f}{row.over_bound:>11.3f}"
            f"{row.missing:>11.3f}{row.us:>11.2f}{row.over_opencv:>11.3f}"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
