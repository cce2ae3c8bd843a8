"""Readings that come late: by rows, and by a fraction of one along a sweep."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from algorithms.contract import Floats
from calibrate.conventions.finding import MUCH_BETTER, Finding
from calibrate.readings import Readings
from calibrate.robust import degree_for, normalised, robust_map, terms
from calibrate.settings import Settings

_SHIFTS = (-4, -3, -2, -1, 1, 2, 3, 4)
_MOST_PAIRS = 1000
#: Fewest rows along a sweep that show a fraction, stretches of them, and its significance.
_FEWEST_SWEPT, _STRETCHES, _CERTAIN = 60, 8, 6.0
#: Change of step over two steps up to which rows lie along a sweep.
_STEADY = 0.25
#: Share of the changes from row to row that goes with no smooth function of the readings, from
#: which a fraction is reported: where all sweeps go one way, a lag looks like an offset.
_TURNS = 0.2


def of_rows(readings: Readings, settings: Settings, noise_deg: float) -> Iterator[Finding]:
    """Yield the rows by which readings come after their poses, or the fraction of one."""
    found = {
        shift: left for shift in _SHIFTS if (left := _shifted_left(readings, shift)) is not None
    }
    best = min(found, key=lambda n: found[n][1] / max(found[n][0], 1e-12), default=0)
    if best and found[best][1] < MUCH_BETTER * found[best][0]:
        before, after = found[best]
        yield Finding(
            "rows",
            f"readings belong to poses {abs(best)} row{'s' if abs(best) > 1 else ''} "
            f"{'before' if best > 0 else 'after'} their own",
            before, after, {"rows": {"shift": settings.rows.shift + best}}, after < 0.4 * before,
        )  # fmt: skip
        return
    yield from _of_fraction(readings, noise_deg)


def _of_fraction(readings: Readings, noise_deg: float) -> Iterator[Finding]:
    lag, error, moved = fraction_late(readings)
    if abs(lag) > _CERTAIN * error and moved > 0.5 * noise_deg:
        yield Finding(
            "rows",
            f"readings belong to poses {abs(lag):.2g} of a row {'before' if lag > 0 else 'after'} "
            f"their own: {moved:.2g} deg along the sweep",
            float(np.hypot(moved, noise_deg)), noise_deg, {}, True,
            "a reading averaged over the time to the next row looks alike; stop at each pose, or "
            "state the directions at the time of the readings",
        )  # fmt: skip


def fraction_late(readings: Readings) -> tuple[float, float, float]:
    """Return the rows by which readings come late along sweeps, its error, and what it moves, deg.

    The part of the directions' change from row to row that no smooth function of the readings
    follows is compared with what such a function leaves of the directions.
    """
    order = np.lexsort((readings.rows, readings.run))
    sun, run = readings.sun[order], readings.run[order]
    ahead, behind = sun[2:] - sun[1:-1], sun[1:-1] - sun[:-2]
    step = np.linalg.norm(ahead + behind, axis=1)
    swept = (np.linalg.norm(ahead - behind, axis=1) < _STEADY * step) & (run[2:] == run[:-2])
    if swept.sum() < _FEWEST_SWEPT:
        return 0.0, np.inf, 0.0
    at = np.flatnonzero(swept) + 1
    change = (sun[at + 1] - sun[at - 1]) / 2.0
    features = normalised(readings.features[order][at])
    scaled = (features - features.mean(axis=0)) / np.maximum(features.std(axis=0), 1e-12) / 2.0
    design = np.linalg.qr(terms(scaled, degree_for(len(at), features.shape[1])))[0]
    change_left, left = (part - design @ (design.T @ part) for part in (change, sun[at]))
    if (change_left**2).sum() < _TURNS * (change**2).sum():
        return 0.0, np.inf, 0.0
    size = np.linalg.norm(left, axis=1)
    kept = size <= 6.0 * np.median(size)
    stretch = np.arange(len(at)) * _STRETCHES // len(at)
    whole = _slope(change_left[kept], left[kept])
    others = np.array(
        [
            _slope(change_left[kept & (stretch != n)], left[kept & (stretch != n)])
            for n in range(_STRETCHES)
        ]
    )
    error = np.sqrt((_STRETCHES - 1) / _STRETCHES * np.sum((others - others.mean()) ** 2))
    moved = np.degrees(abs(whole) * np.sqrt(np.mean((change**2).sum(axis=1))))
    return whole, max(float(error), 1e-12), float(moved)


def _slope(change: Floats, left: Floats) -> float:
    return float((change * left).sum() / max(float((change**2).sum()), 1e-300))


def _shifted_left(readings: Readings, shift: int) -> tuple[float, float] | None:
    """Residuals, degrees, of smooth maps of the same poses: own readings, and `shift` rows later.

    None where fewer than half of the poses have such a row in their run.
    """
    keys = readings.run * (int(readings.rows.max()) + 100) + readings.rows
    order = np.argsort(keys)
    at = np.searchsorted(keys[order], keys + shift).clip(max=len(keys) - 1)
    there = keys[order][at] == keys + shift
    pose, reading = np.flatnonzero(there), order[at[there]]
    if len(pose) < max(40, len(readings) // 2):
        return None
    step = max(-(-len(pose) // _MOST_PAIRS), 1)
    sun, features = readings.sun[pose][::step], readings.features
    own, other = (robust_map(features[at][::step], sun)[1] for at in (pose, reading))
    # along a row of a grid a shifted reading is a smooth function too: its ends tell
    by_median = float(np.median(own)), float(np.median(other))
    by_rms = float(np.sqrt(np.mean(own**2))), float(np.sqrt(np.mean(other**2)))
    return min(by_median, by_rms, key=lambda pair: pair[1] / max(pair[0], 1e-12))
