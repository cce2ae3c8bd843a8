"""How good predictions are: errors where a direction can be determined, and whether any is given.

A sample is *observable* where its direction can be determined at all (`benchmark.metrics.bounds`).
Errors are those of the answers to observable samples; that an observable sample has no answer
lowers the availability, and that an unobservable one has is a false Sun. What false Suns cost is
charged: the rank is by the error over all answers, whether the sample was observable or not.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.contract import Floats
from benchmark.metrics.rings import RINGS, ring_errors
from benchmark.metrics.separation import (
    SIGNIFICANT_DIGITS,
    aligned_error_deg,
    separation_deg,
    store,
)

#: Raised when a metric's definition changes: scores of two versions never stand side by side.
METRIC_VERSION = 4

#: Share of observable samples that a pipeline has to answer to be ranked among its like.
AVAILABLE = 0.95

RING_DIGITS = 4
_UNIT_TOLERANCE = 1e-6
_ROUNDING_DEG = 1e-12


@dataclass(frozen=True)
class Score:
    """Accuracy of N predictions. NaN where a number is undefined; angles in degrees.

    Error statistics, the bound and their ratio are over the same samples: observable, with an
    answer. `rms_alpha_deg` and its like are over those whose true and predicted directions lie in
    front of the detector (s_z > 0), where alpha and beta are defined.
    """

    #: answered share of the observable samples
    availability: float
    #: answered share of the samples that are not observable
    false_detection_rate: float
    rms_deg: float
    #: root mean square over all answers, those to samples that are not observable among them
    rms_all_answers_deg: float
    #: `rms_deg` that is left after the best rotation of all answers onto the truth
    aligned_deg: float
    median_deg: float
    p95_deg: float
    p997_deg: float
    max_deg: float
    bias_alpha_deg: float
    bias_beta_deg: float
    rms_alpha_deg: float
    rms_beta_deg: float
    #: standard deviation of answers to a pose held still, root of the sum over two axes
    repeatability_deg: float
    #: root mean square of the Cramer-Rao bound
    bound_deg: float
    #: `rms_deg` over `bound_deg`
    over_bound: float
    #: one standard error of `over_bound`, from the spread of the squared errors
    over_bound_se: float
    #: root mean square of the bound for who knows the unit by flats and darks alone
    bound_unit_deg: float
    #: `rms_deg` over `bound_unit_deg`
    over_bound_unit: float
    #: rms error by off-axis angle, one a ring of `benchmark.metrics.rings.RINGS`
    rings_deg: tuple[float, ...]

    def row(self) -> dict[str, float | None]:
        """Return the numbers as stored, a column each: rounded, None where undefined."""
        plain = {name: store(getattr(self, name)) for name in _PLAIN}
        for bias, rms in _BIASES.items():
            plain[bias] = stored_beside(getattr(self, bias), getattr(self, rms))
        rings = zip(RINGS, self.rings_deg, strict=True)
        return plain | {ring.column: store(value, RING_DIGITS) for ring, value in rings}


_PLAIN = tuple(field.name for field in fields(Score) if field.name != "rings_deg")
#: Means of errors about zero, and the root mean squares whose last digit is theirs, too.
_BIASES = {"bias_alpha_deg": "rms_alpha_deg", "bias_beta_deg": "rms_beta_deg"}
#: Columns of a stored score.
METRICS = (*_PLAIN, *(ring.column for ring in RINGS))


def stored_beside(value: float, size: float) -> float | None:
    """Round a number to the last digit that `size` is kept to; None where either is not finite.

    A mean of errors that cancel is no better known than they are.

    Examples
    --------
    >>> stored_beside(-9.34789e-05, 0.0029342)
    -9.35e-05
    """
    if not (math.isfinite(value) and math.isfinite(size)):
        return None
    if size == 0.0:
        return store(value)
    return round(value, SIGNIFICANT_DIGITS - 1 - math.floor(math.log10(size))) + 0.0


def is_available(row: Mapping[str, object]) -> bool:
    """Say whether the pipeline of a stored row answers often enough to be ranked by its error."""
    share = row["availability"]
    return isinstance(share, float | int) and share >= AVAILABLE


def score(
    predicted: ArrayLike,
    sun: ArrayLike,
    bound_deg: ArrayLike | None,
    observable: ArrayLike,
    repeated: ArrayLike | None = None,
    *,
    bound_unit_deg: ArrayLike | None = None,
) -> Score:
    """Score predictions against the truth and the Cramer-Rao bounds.

    Noise alone limits how precise an answer is (`bound_deg`); a calibration that knows the unit as
    far as its flats and darks tell limits its accuracy a little more (`bound_unit_deg`).

    Parameters
    ----------
    predicted
        Unit vectors (N, 3); a row of NaN where nothing was found.
    sun
        True unit vectors (N, 3).
    bound_deg
        Per-sample Cramer-Rao standard deviation (N,) of the separation angle; None where it was
        not computed.
    observable
        Where (N,) the direction is observable; the bound is not read elsewhere.
    repeated
        Answers (R, P, 3) to P observable poses in R passes that differ in noise alone; None
        where there are none.
    bound_unit_deg
        As `bound_deg`, with the unit unknown but for flats and darks; None where there is none.

    Raises
    ------
    ValueError
        On another shape, no samples, a row partly NaN, or a prediction that is not a unit vector.
    """
    truth = _vectors(sun, "sun")
    guess = _vectors(predicted, "predicted")
    if guess.shape != truth.shape:
        raise ValueError(f"predicted must have shape {truth.shape}; got {guess.shape}")
    seen = np.asarray(observable, dtype=np.bool_)
    bound, unit_bound = _bound(bound_deg, len(truth)), _bound(bound_unit_deg, len(truth))
    if any(given.shape != (len(truth),) for given in (bound, unit_bound, seen)):
        raise ValueError(
            f"bound_deg and observable must have shape ({len(truth)},), and bound_unit_deg, too; "
            f"got {bound.shape}, {seen.shape} and {unit_bound.shape}"
        )
    answered = _answered(guess)
    judged = answered & seen
    error = separation_deg(guess[judged], truth[judged])
    over_bound, over_bound_se, rms_bound = _against_bound(error, bound[judged])
    over_bound_unit, _, rms_bound_unit = _against_bound(error, unit_bound[judged])
    alpha, beta = _axis_errors(guess[judged], truth[judged])
    return Score(
        availability=_share(answered[seen]),
        false_detection_rate=_share(answered[~seen]),
        rms_deg=_rms(error),
        rms_all_answers_deg=_rms(separation_deg(guess[answered], truth[answered])),
        aligned_deg=_rms(aligned_error_deg(guess[judged], truth[judged])),
        median_deg=_quantile(error, 0.5),
        p95_deg=_quantile(error, 0.95),
        p997_deg=_quantile(error, 0.997),
        max_deg=_quantile(error, 1.0),
        bias_alpha_deg=_mean(alpha),
        bias_beta_deg=_mean(beta),
        rms_alpha_deg=_rms(alpha),
        rms_beta_deg=_rms(beta),
        repeatability_deg=math.nan if repeated is None else repeatability_deg(repeated),
        bound_deg=rms_bound,
        over_bound=over_bound,
        over_bound_se=over_bound_se,
        bound_unit_deg=rms_bound_unit,
        over_bound_unit=over_bound_unit,
        rings_deg=ring_errors(truth[seen], answered[seen], separation_deg(guess, truth)[seen]),
    )


def repeatability_deg(repeated: ArrayLike) -> float:
    """Pool the standard deviation of repeated answers about each pose's mean over the poses.

    Parameters
    ----------
    repeated
        Unit vectors (R, P, 3) of R passes over P poses; rows of NaN where nothing was found.

    Returns
    -------
    float
        Root of the variances summed over both axes across the direction, degrees; NaN where no
        pose has two answers.

    Raises
    ------
    ValueError
        On another shape, a row partly NaN, or an answer that is not a unit vector.
    """
    answers = np.asarray(repeated, dtype=np.float64)
    if answers.ndim != 3 or answers.shape[2] != 3:
        raise ValueError(f"repeated must have shape (R, P, 3); got {answers.shape}")
    passes, poses, _ = answers.shape
    found = _answered(answers.reshape(-1, 3)).reshape(passes, poses)
    middle = np.where(found[..., None], answers, 0.0).sum(axis=0)
    length = np.sqrt(np.sum(middle**2, axis=1, keepdims=True))
    middle /= np.where(length > 0, length, 1.0)
    away = separation_deg(answers.reshape(-1, 3), np.tile(middle, (passes, 1)))
    counted = found.sum(axis=0)
    several = counted > 1
    freedom = int((counted[several] - 1).sum())
    squares = np.where(found, away.reshape(passes, poses) ** 2, 0.0).sum(axis=0)
    spread = math.sqrt(float(squares[several].sum()) / freedom) if freedom else math.nan
    # answers that differ by the rounding of a unit vector are the same answer
    return 0.0 if spread < _ROUNDING_DEG else spread


def _bound(value: ArrayLike | None, count: int) -> Floats:
    return np.full(count, np.nan) if value is None else np.asarray(value, np.float64)


def _vectors(value: ArrayLike, name: str) -> Floats:
    array = np.asarray(value, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 3 or not len(array):
        raise ValueError(f"{name} must have shape (N, 3) with N >= 1; got {array.shape}")
    return array


def _answered(predicted: Floats) -> NDArray[np.bool_]:
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


def _share(where: NDArray[np.bool_]) -> float:
    return float(where.mean()) if len(where) else math.nan


def _rms(values: Floats) -> float:
    return math.sqrt(float(np.mean(values**2))) if len(values) else math.nan


def _mean(values: Floats) -> float:
    return float(np.mean(values)) if len(values) else math.nan


def _quantile(values: Floats, fraction: float) -> float:
    return float(np.quantile(values, fraction)) if len(values) else math.nan
