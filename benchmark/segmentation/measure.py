"""What one worker does: all methods on a data set's units under every fault."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from algorithms.contract import Floats
from benchmark import datasets
from benchmark.metrics.separation import separation_deg, store
from benchmark.segmentation.frames import FAULTS, UNANSWERABLE, Drawn, FaultyUnit
from benchmark.segmentation.masks import Pixels
from benchmark.segmentation.methods import BOARDS, Bench

#: Units: even ones choose, odd ones score.
UNITS = (0, 1, 2, 3, 4, 5, 7, 9)
#: An answer is wrong that is off by more than so many clean errors of the data set's leader.
WRONG = 10.0

_Errors = dict[tuple[str, str, int], Floats]


def measure(board: str) -> dict[str, Any]:
    """Return the row of a data set."""
    of = BOARDS[board]
    errors: _Errors = {}
    overlaps: dict[tuple[str, str], list[Floats]] = {}
    lights: dict[tuple[str, int], Floats] = {}
    names: dict[str, bool] = {}
    for number in UNITS:
        unit = FaultyUnit(datasets.get(board).for_unit(number))
        bench = Bench(unit)
        names = {method.name: method.learned for method in bench.methods}
        for fault in FAULTS:
            drawn = unit.drawn(fault, of.frames[number % 2 == 0])
            lights[fault, number] = np.minimum(drawn.light, 1.0)
            for name, read in bench.read(drawn.frames, drawn.origin).items():
                errors[fault, name, number] = _errors(fault, read.answers, drawn)
                if read.masks is not None and fault not in UNANSWERABLE:
                    shares = _overlap(read.masks, drawn.truth)
                    overlaps.setdefault((fault, name), []).append(shares)
    leader = of.leader.about.name
    clean = np.concatenate([errors["clean", leader, number] for number in UNITS])
    own = math.sqrt(float(np.nanmean(clean**2)))
    return {
        "dataset": board,
        "leader": leader,
        "model": of.model.about.name,
        "clean_error_deg": store(own),
        "units": list(UNITS),
        "frames": [of.frames[number % 2 == 0] for number in UNITS],
        "faults": [
            {
                "fault": fault,
                "methods": [
                    {
                        "method": name,
                        "learned": learned,
                        **_counted(fault, name, errors, lights, own),
                        "overlap": _mean(overlaps.get((fault, name))),
                    }
                    for name, learned in names.items()
                ],
            }
            for fault in FAULTS
        ],
    }


def _errors(fault: str, answers: Floats, drawn: Drawn) -> Floats:
    """Degrees (N,) that answers are off; infinite where there is nothing to answer."""
    if fault in UNANSWERABLE:
        return np.where(np.isfinite(answers[:, 0]), np.inf, np.nan)
    return separation_deg(answers, drawn.sun)


def _counted(
    fault: str,
    name: str,
    errors: _Errors,
    lights: Mapping[tuple[str, int], Floats],
    own: float,
) -> dict[str, Any]:
    """By unit: frames answered, those answered rightly, and the root mean square of the latter."""
    answered, found, size = [], [], []
    for number in UNITS:
        off = errors[fault, name, number]
        # noise alone errs at most as one over the light; no light is never right
        with np.errstate(divide="ignore"):
            right = off <= WRONG * own / lights[fault, number]
        right &= np.isfinite(off)
        answered.append(int((~np.isnan(off)).sum()))
        found.append(int(right.sum()))
        size.append(store(float(np.sqrt(np.mean(off[right] ** 2)))) if right.any() else None)
    return {"answered": answered, "found": found, "error_deg": size}


def _overlap(masks: Pixels, truth: Pixels) -> Floats:
    """(N,) intersection over union."""
    both, either = masks & truth, masks | truth
    return np.asarray(both.sum(axis=(1, 2)) / np.maximum(either.sum(axis=(1, 2)), 1))


def _mean(shares: list[Floats] | None) -> float | None:
    return None if shares is None else round(float(np.concatenate(shares).mean()), 4)
