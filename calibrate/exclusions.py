"""Samples that are left out of a fit: runs that are off, folds, and what a model contradicts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.angles import separation_deg
from algorithms.chain import Scored
from algorithms.contract import Floats, SensorGeometry
from calibrate.ambiguity import folded
from calibrate.readings import Readings
from calibrate.robust import normalised
from calibrate.runs import RunOffset, off_runs
from calibrate.selection import Candidate, fitted, unbounded

#: Why samples are left out.
WRONG, FOLD = "wrong pose", "reading that another direction gives too"
#: Residuals of samples left out, over their robust scale, that list a sample as wrong after all.
_WRONG_OF_MODEL = 5.0
#: And below which a sample that no smooth map explains is taken back.
_RIGHT_OF_MODEL = 4.0
#: Share of samples that may be wrong.
_MOST_WRONG = 0.25


@dataclass(frozen=True)
class Excluded:
    """A sample that was left out of the fit.

    Attributes
    ----------
    source : str
        Its run.
    row : int
        In its file.
    reason : str
    """

    source: str
    row: int
    reason: str


def sound_of(readings: Readings) -> tuple[Readings, list[Excluded], list[RunOffset], float | None]:
    """Leave out runs that are off, and what lies beyond a fold."""
    excluded: list[Excluded] = []
    runs = off_runs(readings)
    for one in runs:
        bad = readings.run == one.run
        excluded += excluded_of(bad, _off_by(one.offset_deg), readings)
        readings = readings.only(~bad)
    bad = folded(readings.features, readings.sun)
    fold = None
    if bad.any():
        fold = float(np.degrees(np.arccos(np.clip(readings.sun[bad, 2], -1.0, 1.0)).min()))
        excluded += excluded_of(bad, FOLD, readings)
        readings = readings.only(~bad)
    return readings, excluded, runs, fold


def _off_by(offset_deg: float) -> str:
    """Say how far a run is off; a rotation found by small angles says no more beyond 30 deg."""
    return f"run off by {offset_deg:.2f} deg" if offset_deg < 30.0 else "run off by over 30 deg"


def excluded_of(bad: NDArray[np.bool_], reason: str, among: Readings) -> list[Excluded]:
    """Return the samples of a mask as left out for a reason."""
    return [
        Excluded(among.run_names[among.run[at]], int(among.rows[at]), reason)
        for at in np.flatnonzero(bad)
    ]


def kept_by_model(
    scored: Scored, chosen: Candidate, sound: Readings, readings: Readings, geometry: SensorGeometry
) -> NDArray[np.bool_]:
    """Return which sound samples (N,) the chosen model explains; those it cannot answer stay.

    What no smooth map explained may be what only this model explains, and the other way round.
    """
    model = unbounded(fitted(scored, readings, geometry))
    errors = separation_deg(model.predict(sound.features, sound.context), sound.sun)
    inside = np.isin(_places(sound), _places(readings))
    left_out = chosen.errors
    if left_out is not None and len(left_out) == len(readings):
        known = np.isfinite(left_out)
        at = np.flatnonzero(inside)[known]
        errors[at] = left_out[known]
    usual = 1.4826 * np.maximum(
        float(np.nanmedian(errors[inside])), _around(sound.features, inside, errors)
    )
    kept = errors <= np.where(inside, _WRONG_OF_MODEL, _RIGHT_OF_MODEL) * usual
    kept |= ~np.isfinite(errors) & inside
    return inside if kept.mean() < 1.0 - _MOST_WRONG else kept


def _around(features: Floats, inside: NDArray[np.bool_], errors: Floats) -> Floats:
    """Return the median error (N,) of the samples inside that are nearest in features."""
    from scipy.spatial import cKDTree  # noqa: PLC0415 - SciPy, at the first use

    used = normalised(features)
    used = used / np.maximum(used.std(axis=0), 1e-12)
    known = np.flatnonzero(inside & np.isfinite(errors))
    near = np.asarray(cKDTree(used[known]).query(used, k=min(12, len(known)))[1])
    return np.asarray(np.median(errors[known][near.reshape(len(used), -1)], axis=1))


def _places(readings: Readings) -> NDArray[np.int64]:
    return readings.run * np.int64(10_000_000) + readings.rows
