"""What regressions share: the target they learn, features scaled to [-1, 1], and the solution."""

from __future__ import annotations

from typing import Literal

import numpy as np

from algorithms.angles import angles_from_sun, tangents_from_sun
from algorithms.calibration.conditioning import WORST_CONDITION
from algorithms.contract import Floats, UnusableDataError

Target = Literal["angle", "tangent"]

#: What `numpy.radians` multiplies by, one number at a time.
_RADIAN = np.pi / 180.0


def target_from_sun(sun: Floats, target: Target) -> Floats:
    """``(alpha, beta)`` (N, 2) in degrees, or their tangents, of Sun vectors (N, 3)."""
    return angles_from_sun(sun) if target == "angle" else tangents_from_sun(sun)


def sun_from_target(values: Floats, target: Target) -> Floats:
    """Sun unit vectors (N, 3) of what a regression gives; NaN where an angle reaches 90."""
    from algorithms.models.non_physical.regression_kernel import unit_vectors  # noqa: PLC0415 - Numba

    columns = np.ascontiguousarray(values.T)
    if target == "angle":
        tangents, limit = columns * _RADIAN, 90.0
        np.tan(tangents, out=tangents)
    else:
        tangents, limit = columns, np.inf
    sun = np.empty((len(values), 3))
    unit_vectors(columns, limit, tangents[0], tangents[1], sun)
    return sun


def in_degrees(rms: float, target: Target) -> float:
    """Error of a pair of angles as degrees; a tangent's as near the boresight, where it is most."""
    return rms if target == "angle" else float(np.degrees(rms))


def feature_scaling(features: Floats, by: str) -> tuple[Floats, Floats]:
    """Middle and half range of each column: the map of the calibrated range onto [-1, 1].

    Raises
    ------
    UnusableDataError
        If a column holds a single value, so that nothing can be learnt along it.
    """
    low, high = features.min(axis=0), features.max(axis=0)
    half = (high - low) / 2.0
    if not (half > 0).all():
        column = int(np.argmin(half))
        raise UnusableDataError(
            f"{by} needs calibration samples that spread along both features; "
            f"all have {low[column]:.6g} in column {column}"
        )
    return (low + high) / 2.0, half


def solve_regression(design: Floats, wanted: Floats, by: str) -> Floats:
    """Least-squares coefficients of a design matrix (n, terms).

    Raises
    ------
    UnusableDataError
        If the samples do not determine every term, or so badly that rounding would show, naming
        both numbers.
    """
    solution, _, rank, _ = np.linalg.lstsq(design, wanted, rcond=1.0 / WORST_CONDITION)
    terms = design.shape[1]
    if rank < terms:
        raise UnusableDataError(
            f"{by} needs at least {terms} samples at different features to fit {terms} terms; "
            f"the {len(design)} given settle only {int(rank)}"
        )
    return np.asarray(solution, dtype=np.float64)
