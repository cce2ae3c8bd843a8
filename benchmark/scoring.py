"""How good a prediction is: separation angle, per-axis error, and distance from the bound."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.contract import Floats

#: Raised when a metric's definition changes: scores of two versions never stand side by side.
METRIC_VERSION = 1

SIGNIFICANT_DIGITS = 6
_UNIT_TOLERANCE = 1e-6


@dataclass(frozen=True)
class Score:
    """Accuracy of N predictions. NaN where a number is undefined; angles in degrees.

    Error statistics are over the found samples. `rms_alpha_deg` and its like are over found
    samples whose true and predicted directions lie in front of the detector (s_z > 0), where
    alpha and beta are defined. Everything named `bound` is over samples both found and observable.
    """

    found_fraction: float
    observable_fraction: float
    rms_deg: float
    median_deg: float
    p95_deg: float
    max_deg: float
    bias_alpha_deg: float
    bias_beta_deg: float
    rms_alpha_deg: float
    rms_beta_deg: float
    #: root mean square of the Cramer-Rao bound
    bound_deg: float
    #: rms error over the same samples, divided by `bound_deg`
    over_bound: float
    #: one standard error of `over_bound`, from the spread of the squared errors
    over_bound_se: float

    def row(self) -> dict[str, float | None]:
        """Return the numbers as stored: 6 significant digits, None where undefined."""
        return {name: stored(value) for name, value in dataclasses.asdict(self).items()}


METRICS = tuple(field.name for field in dataclasses.fields(Score))


def stored(value: float) -> float | None:
    """Round a number as results keep it: 6 significant digits, None where it is not finite."""
    return float(f"{value:.{SIGNIFICANT_DIGITS}g}") if math.isfinite(value) else None


def separation_deg(first: ArrayLike, second: ArrayLike) -> Floats:
    """Angle (N,) in degrees between unit vectors (N, 3); exact for tiny angles, NaN for NaN rows.

    The arc tangent of |a x b| over a . b: the arc cosine loses everything below 1e-6 degrees.
    """
    a = np.asarray(first, dtype=np.float64)
    b = np.asarray(second, dtype=np.float64)
    cross = np.cross(a, b)
    along = np.einsum("ij,ij->i", a, b)
    angle: Floats = np.degrees(np.arctan2(np.sqrt(np.einsum("ij,ij->i", cross, cross)), along))
    return angle


def score(
    predicted: ArrayLike, sun: ArrayLike, bound_deg: ArrayLike, observable: ArrayLike
) -> Score:
    """Score predictions against the truth and the Cramer-Rao bound.

    Parameters
    ----------
    predicted
        Unit vectors (N, 3); a row of NaN where nothing was found.
    sun
        True unit vectors (N, 3).
    bound_deg
        Per-sample Cramer-Rao standard deviation (N,) of the separation angle.
    observable
        Where (N,) the direction is observable; the bound is not read elsewhere.

    Raises
    ------
    ValueError
        On another shape, no samples, a row partly NaN, or a prediction that is not a unit vector.
    """
    truth = _vectors(sun, "sun")
    guess = _vectors(predicted, "predicted")
    if guess.shape != truth.shape:
        raise ValueError(f"predicted must have shape {truth.shape}; got {guess.shape}")
    bound = np.asarray(bound_deg, dtype=np.float64)
    seen = np.asarray(observable, dtype=np.bool_)
    if bound.shape != (len(truth),) or seen.shape != (len(truth),):
        raise ValueError(
            f"bound_deg and observable must have shape ({len(truth)},); "
            f"got {bound.shape} and {seen.shape}"
        )
    found = _found(guess)
    error = separation_deg(guess, truth)
    compared = found & seen
    over_bound, over_bound_se, rms_bound = _against_bound(error[compared], bound[compared])
    alpha, beta = _axis_errors(guess[found], truth[found])
    return Score(
        found_fraction=float(found.mean()),
        observable_fraction=float(seen.mean()),
        rms_deg=_rms(error[found]),
        median_deg=_quantile(error[found], 0.5),
        p95_deg=_quantile(error[found], 0.95),
        max_deg=_quantile(error[found], 1.0),
        bias_alpha_deg=_mean(alpha),
        bias_beta_deg=_mean(beta),
        rms_alpha_deg=_rms(alpha),
        rms_beta_deg=_rms(beta),
        bound_deg=rms_bound,
        over_bound=over_bound,
        over_bound_se=over_bound_se,
    )


def _vectors(value: ArrayLike, name: str) -> Floats:
    array = np.asarray(value, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 3 or not len(array):
        raise ValueError(f"{name} must have shape (N, 3) with N >= 1; got {array.shape}")
    return array


def _found(predicted: Floats) -> NDArray[np.bool_]:
    finite = np.isfinite(predicted)
    found: NDArray[np.bool_] = np.asarray(finite.all(axis=1))
    partly = finite.any(axis=1) & ~found
    if partly.any():
        raise ValueError(f"predicted row {int(np.argmax(partly))} is finite in some columns only")
    length = np.linalg.norm(predicted[found], axis=1)
    if (np.abs(length - 1.0) > _UNIT_TOLERANCE).any():
        worst = float(length[np.argmax(np.abs(length - 1.0))])
        raise ValueError(f"predicted rows must be unit vectors; one has length {worst:.9g}")
    return found


def _axis_errors(predicted: Floats, truth: Floats) -> tuple[Floats, Floats]:
    defined = (predicted[:, 2] > 0) & (truth[:, 2] > 0)
    p, t = predicted[defined], truth[defined]
    alpha = np.degrees(np.arctan2(p[:, 1], p[:, 2]) - np.arctan2(t[:, 1], t[:, 2]))
    beta = np.degrees(np.arctan2(p[:, 0], p[:, 2]) - np.arctan2(t[:, 0], t[:, 2]))
    return alpha, beta


def _against_bound(error: Floats, bound: Floats) -> tuple[float, float, float]:
    """Ratio of rms error to rms bound, its standard error, and the rms bound.

    The squared ratio R = sum(e^2) / sum(b^2) is a ratio estimator; its variance follows from the
    residuals e^2 - R b^2, and the root's from the delta method.
    """
    n = len(error)
    rms_bound = _rms(bound)
    if n == 0 or not rms_bound > 0 or not math.isfinite(rms_bound):
        return math.nan, math.nan, rms_bound
    squared = float(np.sum(error**2) / np.sum(bound**2))
    ratio = math.sqrt(squared)
    if n == 1 or ratio == 0:
        return ratio, math.nan, rms_bound
    residual = error**2 - squared * bound**2
    squared_se = math.sqrt(float(np.sum(residual**2)) * n / (n - 1)) / float(np.sum(bound**2))
    return ratio, squared_se / (2 * ratio), rms_bound


def _rms(values: Floats) -> float:
    return math.sqrt(float(np.mean(values**2))) if len(values) else math.nan


def _mean(values: Floats) -> float:
    return float(np.mean(values)) if len(values) else math.nan


def _quantile(values: Floats, fraction: float) -> float:
    return float(np.quantile(values, fraction)) if len(values) else math.nan
