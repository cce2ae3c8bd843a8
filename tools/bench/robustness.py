"""Extractors beside other libraries on frames drawn afresh: ``python -m tools.bench.robustness``.

Error as a multiple of the Cramer-Rao bound and the share of confident wrong answers, on frames of
other shapes and sizes, in stray light, with broken pixels, two lights or no Sun, and of many spots.
A seed is drawn and printed; ``--seed`` repeats its frames, of which slow methods that no limit is
for see as many as the time allows. Peers are called with their defaults. Exit status 1 when a limit
is broken.
"""

from __future__ import annotations

import argparse
import json
import math
import secrets
import sys
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Extractor, Floats, Observation
from algorithms.discovery import discover_extractors
from algorithms.extractors.frames.mirror.extractor import MirrorRegistration
from benchmark.running.threads import one_thread
from benchmark.synthetic_features.frame_sets import FRAME_SETS, FrameSet, Scenes
from benchmark.synthetic_features.series import WRONG_PX
from tools.bench.extractor_limits import OPENCV
from tools.bench.extractor_peers import REACH, Method, opencv_loop, peers
from tools.bench.extractors import single_spot
from tools.bench.robustness_grids import GRID_SETS, GridSet
from tools.bench.robustness_limits import LONGEST_PX, SIZE_PX, RobustnessResult, verdicts
from tools.bench.verdicts import Verdict, any_broken

#: Frames of a set of single spots of 64 x 64 px, where nothing else is asked for; sets of faults
#: have `_MORE` times as many, larger frames and grids are fewer.
_FRAMES, _MORE = 1000, 2
_FEWER = {64: 1.0, 256: 0.25, 512: 0.12}
_GRID_SHARE = 0.3
#: Seconds that a method that no limit is for may take for a set, and frames that it always sees.
_SECONDS, _LEAST = 0.25, 8
#: Frames and turns from which the time is measured; a run that takes longer is not repeated.
_TIMED_FRAMES, _TURNS, _LONG_S = 100, 5, 0.05
#: Cut-outs for fits hold this many times the spot's longest axis.
_CUT_OUT = 1.6


def methods(chosen: FrameSet) -> dict[str, Method]:
    """Return the methods for one spot, and peers, by name.

    Each is made for a sensor whose aperture is as wide as the spot, but for the one that is held to
    the bound: frames of a shape alone have no sensor, so it is made without one, and again with.
    """
    made = single_spot(chosen.shape.half_px, chosen.size_px)
    found: dict[str, Method] = {name: extractor.extract for name, extractor in made.items()}
    found["mirror for_sensor"] = found["mirror"]
    found["mirror"] = MirrorRegistration().extract
    reach = max(REACH, math.ceil(_CUT_OUT * chosen.shape.longest_px) + 8)
    return {**{name: found[name] for name in sorted(found)}, OPENCV: opencv_loop, **peers(reach)[0]}


def grid_methods(chosen: GridSet) -> dict[str, Method]:
    """Return the methods that know a pattern of apertures, by name; no peer does."""
    return {name: made.extract for name, made in grid_extractors(chosen).items()}


def grid_extractors(chosen: GridSet) -> dict[str, Extractor]:
    """Return the extractors that know a pattern of apertures, by name, made for a set's sensor."""
    found = {}
    for name, extractor in discover_extractors().items():
        if extractor.about.observation is not Observation.FRAMES:
            continue
        try:
            made = extractor.for_sensor(chosen.geometry())
        except ValueError:  # not a method for many spots
            continue
        if hasattr(made, "apertures_px"):
            found[name] = made
    return found


def ours() -> frozenset[str]:
    """Return the names of the extractors that are not the survey's."""
    found = discover_extractors().items()
    return frozenset(name for name, extractor in found if extractor.about.origin == "ours")


def frames_of(chosen: FrameSet | GridSet, asked: int) -> int:
    """Return how many frames of a set are drawn where so many are asked for."""
    if isinstance(chosen, GridSet):
        share = _GRID_SHARE * min(1.0, (150.0 / chosen.size_px) ** 2)
    else:
        share = _FEWER[chosen.size_px] * (_MORE if chosen.kind == "fault" else 1)
    return max(round(share * asked), _LEAST)


def measure(
    chosen: FrameSet | GridSet, seed: int, asked: int, only: Collection[str] | None = None
) -> list[RobustnessResult]:
    """Measure every method, or those named, on frames of a set under a seed.

    What is held to limits sees every frame, whatever it takes, so that a seed settles its verdicts.
    """
    scenes = chosen.draw(seed, frames_of(chosen, asked))
    todo = methods(chosen) if isinstance(chosen, FrameSet) else grid_methods(chosen)
    if isinstance(chosen, FrameSet):
        kind = chosen.kind
        timed = kind == "symmetric" and chosen.size_px == SIZE_PX
        timed = timed and chosen.shape.longest_px <= LONGEST_PX
    else:
        kind, timed = "fault" if chosen.spoilt else "grid", False
    rows, held = [], ours()
    with one_thread():
        for name, method in todo.items():
            if only is not None and name not in only:
                continue
            every = name.partition(" ")[0] in held
            found, seconds = _answers(method, scenes.frames, every=every)
            error, wrong, missing = error_and_shares(found, scenes)
            repeat = kind == "symmetric"
            us, over_opencv = _times(method, scenes.frames, seconds, repeat=repeat)
            rows.append(
                RobustnessResult(
                    group=chosen.group,
                    set_name=chosen.name,
                    kind=kind,
                    method=name,
                    over_bound=error / scenes.bound_px,
                    wrong=wrong,
                    missing=missing,
                    us=us,
                    over_opencv=over_opencv,
                    frames=len(found),
                    timed=timed,
                )
            )
    return rows


def error_and_shares(found: Floats, scenes: Scenes) -> tuple[float, float, float]:
    """Return the root mean square error px of answers, and shares of wrong and missing ones.

    Every finite answer is meant: `extract` has no other way to raise a flag. Where there is
    no spot every answer is wrong, and with two equal lights that at the one which is not the Sun.
    """
    answered = np.isfinite(found).all(axis=1)
    off = found[answered] - scenes.centres[: len(found)][answered]
    wrong = ~(np.hypot(*off.T) <= WRONG_PX)
    # without a spot there is nothing that an answer could be off from
    known = np.isfinite(off).all(axis=1)
    error = float(np.sqrt(np.mean(off[known] ** 2))) if known.any() else math.nan
    return error, float(wrong.sum() / len(found)), float(1.0 - answered.mean())


def _answers(method: Method, frames: NDArray[Any], *, every: bool) -> tuple[Floats, float]:
    """Answers (n, 2) to every frame, or to as many as the time allows, and seconds a frame."""
    method(frames[:1])  # compiled, and warm
    number = len(frames)
    if not every:
        seconds = min(_timed(method, frames[:_LEAST])[0] for _ in range(2))
        number = max(int(min(number, _LEAST * _SECONDS / seconds)), min(number, _LEAST))
    seconds, found = _timed(method, frames[:number])
    return found, seconds / len(found)


def _times(
    method: Method, frames: NDArray[Any], seconds: float, *, repeat: bool
) -> tuple[float, float]:
    """Best time a frame, us, and over that of OpenCV's loop in turns with it.

    `seconds` a frame are the method's time where it is not repeated, or too slow to be.
    """
    frames = frames[:_TIMED_FRAMES]
    repeat = repeat and seconds * len(frames) < _LONG_S
    best, reference = seconds, math.inf
    turns, spent = 0, 0.0
    while turns < _TURNS or (repeat and spent < _LONG_S):
        reference = min(reference, _timed(opencv_loop, frames)[0] / len(frames))
        if repeat:
            again = _timed(method, frames)[0]
            best, spent = min(best, again / len(frames)), spent + again
        turns += 1
    return 1e6 * best, best / reference


def _timed(method: Method, frames: NDArray[Any]) -> tuple[float, Floats]:
    started = time.perf_counter()
    found = method(frames)
    return time.perf_counter() - started, found


def cell(row: RobustnessResult) -> str:
    """Return what the table says of one method on one set."""
    if math.isnan(row.over_bound):
        said = "-"
    else:
        said = f"{row.over_bound:.2f}" if row.over_bound < 100.0 else f"{row.over_bound:.0f}"
    said += f" !{100.0 * row.wrong:.3g}" if row.wrong else ""
    return said + (f" ?{100.0 * row.missing:.3g}" if row.missing else "")


def print_tables(rows: Sequence[RobustnessResult]) -> None:
    """Print a table for each group of sets, and one of times."""
    groups: dict[str, list[RobustnessResult]] = {}
    for row in rows:
        groups.setdefault(row.group, []).append(row)
    print(
        "error over the Cramer-Rao bound; !: % of frames answered more than a pixel off, or where "
        "there is nothing to find; ?: % not answered\n"
    )
    for group, some in groups.items():
        _print_table(group, some, cell)
    symmetric = [row for row in rows if row.kind == "symmetric"]
    if symmetric:
        _print_table("time over OpenCV's", symmetric, lambda row: f"{row.over_opencv:.2f}")


def _print_table(
    title: str, rows: Sequence[RobustnessResult], said: Callable[[RobustnessResult], str]
) -> None:
    sets = list(dict.fromkeys(row.set_name for row in rows))
    cells: dict[str, dict[str, str]] = {}
    for row in rows:
        cells.setdefault(row.method, {})[row.set_name] = said(row)
    width = {
        name: max(len(name), *(len(line.get(name, "")) for line in cells.values())) for name in sets
    }
    first = max(len(title), *map(len, cells))
    print(f"{title:<{first}}" + "".join(f"  {name:>{width[name]}}" for name in sets))
    most: Mapping[str, int] = {
        name: max(row.frames for row in rows if row.set_name == name) for name in sets
    }
    for method, line in cells.items():
        found = (f"  {line.get(name, ''):>{width[name]}}" for name in sets)
        print(f"{method:<{first}}" + "".join(found))
    frames = "".join(f"  {most[name]:>{width[name]}}" for name in sets)
    print(f"{'frames at most':<{first}}{frames}\n", flush=True)


def run(seed: int) -> list[Verdict]:
    """Measure and print everything under a seed; return the verdicts."""
    print(f"seed {seed}")
    rows = [row for chosen in (*FRAME_SETS, *GRID_SETS) for row in measure(chosen, seed, _FRAMES)]
    return _reported(rows)


def _reported(rows: Sequence[RobustnessResult]) -> list[Verdict]:
    print_tables(rows)
    for library in peers()[1]:
        print(f"{library}: not installed (make bench installs it)")
    found = verdicts(rows, ours())
    for verdict in found:
        word = "kept" if verdict.holds else "BROKEN"
        print(f"{verdict.what}: {verdict.value:.4g}, limit {verdict.most:g}: {word}")
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print, and return the exit status."""
    groups = list(dict.fromkeys(chosen.group for chosen in (*FRAME_SETS, *GRID_SETS)))
    parser = argparse.ArgumentParser(prog="python -m tools.bench.robustness")
    parser.add_argument("--seed", type=int, help="of the frames (default: a new one)")
    parser.add_argument("--groups", nargs="+", choices=groups, default=groups, metavar="GROUP")
    parser.add_argument("--sets", nargs="+", metavar="SET", help="only these (default: all)")
    parser.add_argument("--methods", nargs="+", metavar="METHOD", help="only these (default: all)")
    parser.add_argument(
        "--frames", type=int, default=_FRAMES, help=f"frames of a set (default {_FRAMES})"
    )
    parser.add_argument("--format", choices=("table", "json"), default="table")
    given = parser.parse_args(arguments)
    if given.frames < 1:
        parser.error(f"--frames must be at least 1; got {given.frames}")
    seed = secrets.randbelow(10**6) if given.seed is None else given.seed
    chosen = [
        one
        for one in (*FRAME_SETS, *GRID_SETS)
        if one.group in given.groups and (given.sets is None or one.name in given.sets)
    ]
    if not chosen:
        names = ", ".join(dict.fromkeys(one.name for one in (*FRAME_SETS, *GRID_SETS)))
        parser.error(f"no set named {', '.join(given.sets)} in these groups; there are {names}")
    if given.format == "table":
        print(f"seed {seed}")
    rows = [row for one in chosen for row in measure(one, seed, given.frames, given.methods)]
    if given.methods is not None and not rows:
        parser.error(f"no method named {', '.join(given.methods)}")
    if given.format == "table":
        return 1 if any_broken(_reported(rows)) else 0
    found = verdicts(rows, ours())
    limits = [{**asdict(verdict), "holds": verdict.holds} for verdict in found]
    measured = [asdict(row) for row in rows]
    print(json.dumps({"seed": seed, "measured": measured, "limits": limits}))
    return 1 if any_broken(found) else 0


if __name__ == "__main__":
    sys.exit(main())
