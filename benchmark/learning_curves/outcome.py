"""What is said of a learning curve: its floor, the poses to be near it, and the curve in short."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from algorithms.contract import Floats
from benchmark import seeds
from benchmark.learning_curves.floor import NEAR, Flags, Floor, floor_of, reached_from
from benchmark.learning_curves.measure import CurveErrors
from benchmark.learning_curves.reading import Row
from benchmark.metrics.score import AVAILABLE
from benchmark.metrics.separation import store

#: Digits of errors along a curve, and of shares; floors have those of scores.
_CURVE_DIGITS, _SHARE_DIGITS = 4, 3


def row_of(learnt: CurveErrors, bound_deg: float, bench_deg: float | None) -> Row:
    """Say what is kept of one pipeline's errors.

    A draw is near the floor where its error is at most `NEAR` floors of its unit and it answers as
    often as a ranked pipeline must; the poses it needs are those from which on it stays so.

    Returns
    -------
    dict
        ``dataset`` to ``model``, ``poses`` (all of them), ``in_order``; ``floor`` (``fitted``,
        ``all`` or, where there is none, ``none``), ``floor_error_deg`` with ``floor_low_deg`` and
        ``floor_high_deg`` (of both units, root mean square), ``exponent``, ``misfit``,
        ``bound_deg``, ``bench_deg``, ``all_deg`` (by unit, with all poses); by draw, unit after
        unit, ``needed``,
        ``error_from`` (the error alone is near) and ``answers_from`` (answers alone are enough),
        null where all poses are too few; ``points``, of each size ``[poses, median, least and
        largest error, median availability, refused draws]``, and ``refusal``, the reason of the
        first one.
    """
    leader, steps = learnt.leader, learnt.sizes
    answered = np.nan_to_num(learnt.availability) >= AVAILABLE
    floor = floor_of(
        steps,
        learnt.rms_deg,
        answered,
        seeds.generator("learning-curve", "floor", leader.dataset, leader.extractor, leader.model),
        lawful=not learnt.in_order,
    )
    near = _near(learnt.rms_deg, floor)
    return {
        "dataset": leader.dataset,
        "place": leader.place,
        "condition": leader.condition,
        "extractor": leader.extractor,
        "model": leader.model,
        "poses": steps[-1],
        "in_order": learnt.in_order,
        **_said(floor),
        "bound_deg": bound_deg,
        "bench_deg": bench_deg,
        "all_deg": [store(error) for error in learnt.rms_deg[:, 0, -1].tolist()],
        "needed": _from(steps, near & answered),
        "error_from": _from(steps, near),
        "answers_from": _from(steps, answered),
        "points": [_point(learnt, k) for k in range(len(steps))],
        "refusal": next((str(r) for r in learnt.refusals.ravel() if r), ""),
    }


def _near(errors: Floats, floor: Floor | None) -> Flags:
    if floor is None:
        return np.zeros(errors.shape, dtype=np.bool_)
    limit = NEAR * np.array(floor.error_deg)[:, None, None]
    return np.asarray(np.nan_to_num(errors, nan=np.inf) <= limit)


def _said(floor: Floor | None) -> Row:
    if floor is None:
        nothing = ("floor_error_deg", "floor_low_deg", "floor_high_deg", "exponent", "misfit")
        return {"floor": "none", **dict.fromkeys(nothing)}
    return {
        "floor": "fitted" if floor.is_fitted else "all",
        "floor_error_deg": _pool(floor.error_deg),
        "floor_low_deg": _pool(floor.low_deg) if floor.is_fitted else None,
        "floor_high_deg": _pool(floor.high_deg) if floor.is_fitted else None,
        "exponent": floor.exponent,
        "misfit": None if floor.misfit is None else store(floor.misfit, 2),
    }


def _pool(errors: Sequence[float]) -> float | None:
    return store(math.sqrt(math.fsum(error**2 for error in errors) / len(errors)))


def _from(steps: tuple[int, ...], near: Flags) -> list[int | None]:
    return [reached_from(steps, draw) for unit in near for draw in unit]


def _point(learnt: CurveErrors, place: int) -> list[float | int | None]:
    errors, shares = learnt.rms_deg[:, :, place].ravel(), learnt.availability[:, :, place].ravel()
    known = errors[np.isfinite(errors)]
    answered = shares[np.isfinite(shares)]
    refused = sum(bool(reason) for reason in learnt.refusals[:, :, place].ravel())
    point: list[float | int | None] = [learnt.sizes[place]]
    if not len(known):  # every draw was refused
        return [*point, None, None, None, None, refused]
    middle, low, high = (store(v, _CURVE_DIGITS) for v in _middle_and_ends(known))
    return [*point, middle, low, high, store(float(np.median(answered)), _SHARE_DIGITS), refused]


def _middle_and_ends(values: Floats) -> tuple[float, float, float]:
    return float(np.median(values)), float(values.min()), float(values.max())
