"""Whether stated covariances are those of the errors: ``python -m tools.bench.covariances``.

Frames are those of `tools.bench.robustness`, under a seed that is drawn and printed, but for those
that faults leave no answer to. Every extractor of ours that states a covariance somewhere is
measured: the mean of the errors' squares in units of it, an axis, is one where it is right. Exit
status 1 where it is not.
"""

from __future__ import annotations

import argparse
import math
import secrets
import sys
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from algorithms.contract import Extractor
from algorithms.extractors.frames.mirror.extractor import MirrorRegistration
from benchmark.running.threads import one_thread
from benchmark.synthetic_features.frame_sets import FRAME_SETS, FrameSet
from tools.bench.extractors import single_spot
from tools.bench.robustness import frames_of, grid_extractors
from tools.bench.robustness_grids import GRID_SETS, GridSet
from tools.bench.verdicts import Verdict, any_broken

#: How far the mean square may be from one, and how many answers tell it well enough to be judged:
#: it scatters by one over the root of their number.
OFF, TOLD = 0.10, 1000
#: Frames of a set of 64 x 64 px; sets of larger frames and grids have fewer, and are not judged.
_FRAMES = 2000


@dataclass(frozen=True)
class CovarianceResult:
    """One method's covariances on one set.

    Attributes
    ----------
    group, set_name, method
        What was measured.
    squares
        Mean of the errors' squares over what is stated, an axis; NaN where nothing is stated.
    answered, stated
        Frames with an answer, and those of them with a covariance.
    """

    group: str
    set_name: str
    method: str
    squares: float
    answered: int
    stated: int


def extractors(chosen: FrameSet | GridSet) -> dict[str, Extractor]:
    """Return our extractors that read a set's frames, by name, each made for their sensor.

    The estimator that is held to the bound is made without one.
    """
    if isinstance(chosen, FrameSet):
        made = single_spot(chosen.shape.half_px, chosen.size_px)
        made[MirrorRegistration.about.name] = MirrorRegistration()
    else:
        made = grid_extractors(chosen)
    return {name: one for name, one in made.items() if one.about.origin == "ours"}


def measure(chosen: FrameSet | GridSet, seed: int, asked: int) -> list[CovarianceResult]:
    """Return how right every method's covariances are on frames of a set under a seed."""
    scenes = chosen.draw(seed, frames_of(chosen, asked))
    rows = []
    with one_thread():
        for name, extractor in extractors(chosen).items():
            found = extractor.measure(scenes.frames)
            errors = found.features - scenes.centres
            answered = np.isfinite(errors).all(axis=1)
            stated = answered & np.isfinite(found.covariance).all(axis=(1, 2))
            squares = math.nan
            if stated.any():
                inverse = np.linalg.inv(found.covariance[stated])
                own = errors[stated]
                squares = float(np.einsum("ni,nij,nj->n", own, inverse, own).mean()) / 2.0
            rows.append(
                CovarianceResult(
                    group=chosen.group,
                    set_name=chosen.name,
                    method=name,
                    squares=squares,
                    answered=int(answered.sum()),
                    stated=int(stated.sum()),
                )
            )
    return rows


def verdicts(rows: Sequence[CovarianceResult]) -> list[Verdict]:
    """Return a verdict on each covariance that enough answers tell of."""
    return [
        Verdict(
            f"{row.method} on {row.set_name}, {row.group}: squares of errors over the covariance, "
            f"off from one, {row.stated} answers",
            abs(row.squares - 1.0),
            OFF,
        )
        for row in rows
        if row.stated >= TOLD
    ]


def sets() -> list[FrameSet | GridSet]:
    """Return the sets whose frames have an answer that can be right."""
    spoilt = ("dark edge", "double edge")
    grids = [chosen for chosen in GRID_SETS if chosen.spoilt not in spoilt]
    return [*(chosen for chosen in FRAME_SETS if chosen.sun), *grids]


def print_table(rows: Sequence[CovarianceResult]) -> None:
    """Print the mean squares of every method that states a covariance somewhere."""
    methods = {row.method for row in rows if row.stated}
    silent = sorted({row.method for row in rows} - methods)
    print(
        "mean squares of errors over the stated covariance, an axis, +- what chance leaves open;\n"
        "of how many answers, and the share of answers with a covariance\n"
    )
    for row in rows:
        if row.method not in methods or not row.answered:
            continue
        where = f"{row.group:<26} {row.set_name:<16} {row.method:<16}"
        share = row.stated / row.answered
        if row.stated:
            chance = 1.0 / math.sqrt(row.stated)
            print(f"{where} {row.squares:6.2f} +- {chance:.2f} of {row.stated:5d} {share:5.0%}")
        else:
            print(f"{where} none stated of {row.answered}")
    if silent:
        print(f"\nstates no covariance: {', '.join(silent)}")
    print()


def run(seed: int, frames: int = _FRAMES) -> list[Verdict]:
    """Measure and print everything under a seed; return the verdicts."""
    print(f"seed {seed}\n")
    rows = [row for chosen in sets() for row in measure(chosen, seed, frames)]
    print_table(rows)
    found = verdicts(rows)
    for verdict in found:
        if verdict.breaks:
            print(f"BROKEN {verdict.what}: {verdict.value:.3f}, limit {verdict.most:g}")
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print, and return the exit status."""
    parser = argparse.ArgumentParser(prog="python -m tools.bench.covariances")
    parser.add_argument("--seed", type=int, help="of the frames (default: a new one)")
    parser.add_argument("--frames", type=int, default=_FRAMES, help="frames of a set of 64 px")
    given = parser.parse_args(arguments)
    if given.frames < 1:
        parser.error(f"--frames must be at least 1; got {given.frames}")
    seed = secrets.randbelow(10**6) if given.seed is None else given.seed
    return 1 if any_broken(run(seed, given.frames)) else 0


if __name__ == "__main__":
    sys.exit(main())
