"""Fits to two halves of the samples: whether they differ by more than noise explains."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.angles import separation_deg
from algorithms.calibration.hull import Hull
from algorithms.chain import Scored
from algorithms.contract import Floats, SensorGeometry, UnusableDataError
from calibrate.readings import Readings
from calibrate.selection import fitted, fold_of
from calibrate.uncertainty import refits, spread_deg

#: Ways to halve the samples, and refits of each half with other noise that tell its spread.
_SPLITS, _REFITS = 4, 3
_SEED = 20_260_102
#: Poses are told apart to so many digits.
_DIGITS = 6


@dataclass(frozen=True)
class Halves:
    """How far fits to two halves are apart.

    The ratio is the RMS difference over the stated uncertainties added, all splits together; NaN
    where not known.
    """

    ratio: float = float("nan")
    chance: float = 1.0  # of such a ratio, or a larger one, by noise alone


def halves(scored: Scored, sample: Readings, geometry: SensorGeometry, noise: Floats) -> Halves:
    """Compare fits to halves of the samples with what noise lets them differ by.

    Samples are halved at random several times: runs, or poses with all their repeats, go to one
    side. A fixed pattern would not do: every other pose of a grid of odd width has all its corners.
    Fits are compared inside both halves' fields alone, since a fit that is continued to a corner
    differs by more than noise, of which each sample's 1-sigma (N,) in degrees is given.

    The square of the ratio is one of two variances. Both come from few free directions, since a fit
    has few parameters and errs most at the edge: Satterthwaite's degrees of freedom of the fits'
    covariance, told by refits, give the chance by the F distribution.
    """
    from scipy.special import fdtrc  # noqa: PLC0415 - SciPy, at the first use

    if not (noise > 0).all():
        return Halves()
    generator = np.random.default_rng(_SEED)
    apart, expected, traces = [], [], []
    for _ in range(_SPLITS):
        first = _half(sample, generator)
        try:
            fits = [_Fits.of(scored, sample, half, geometry, noise) for half in (first, ~first)]
        except UnusableDataError:
            return Halves()
        shared = fits[0].inside & fits[1].inside
        shared &= np.isfinite(fits[0].spread + fits[1].spread)
        if not shared.any():
            return Halves()
        apart.append(float(np.mean(separation_deg(fits[0].sun, fits[1].sun)[shared] ** 2)))
        expected.append(float(np.mean((fits[0].spread ** 2 + fits[1].spread ** 2)[shared])))
        traces.append(_traces(*(fit.deviations[:, shared] for fit in fits)))
    if not sum(expected) > 1e-18:  # a model of no parameters
        return Halves()
    square = sum(apart) / sum(expected)
    squared, of_square = np.sum(traces, axis=0)
    free = max(float(squared / of_square), 1.0) if of_square > 0 else 1.0
    chance = fdtrc(free, free * 2 * _SPLITS * (_REFITS - 1), square)
    return Halves(float(np.sqrt(square)), float(chance))


@dataclass(frozen=True)
class _Fits:
    """A fit to one half, and refits of it with other noise, at all samples."""

    sun: Floats
    deviations: Floats
    spread: Floats
    inside: NDArray[np.bool_]

    @classmethod
    def of(
        cls, scored: Scored, sample: Readings, half: NDArray[np.bool_], geometry: SensorGeometry,
        noise: Floats,
    ) -> _Fits:  # fmt: skip
        part = sample.only(half)
        sun = fitted(scored, part, geometry).predict(sample.features, sample.context)
        again = refits(scored, part, geometry, noise[half], sample, _REFITS)
        if len(again) < _REFITS:
            raise UnusableDataError(f"{len(again)} of {_REFITS} refits settle the model")
        field = Hull.of_directions(part.sun, "halves")
        inside = np.isfinite(sun).all(axis=1) & (field.outside(sample.sun) <= 0.0)
        return cls(sun, again - again.mean(axis=0), spread_deg(again), inside)


def _half(sample: Readings, generator: np.random.Generator) -> NDArray[np.bool_]:
    """Return which samples (N,) are in the first half."""
    fold, by = fold_of(sample)
    if by == "runs":
        unit = fold
    else:
        poses = np.round(sample.sun, _DIGITS)
        unit = np.unique(poses, axis=0, return_inverse=True)[1].reshape(-1)
    order = generator.permutation(int(unit.max()) + 1)
    return np.asarray(order[unit] % 2 == 0)


def _traces(one: Floats, other: Floats) -> tuple[float, float]:
    """Return tr(C)^2 and tr(C^2) of the sum C of two covariances, without bias.

    Of refits (R, M, 3) of each half less their mean.
    """
    one, other = (part.reshape(len(part), -1) for part in (one, other))
    free = len(one) - 1
    trace = (float((one**2).sum()) + float((other**2).sum())) / free
    squares = _square(one) + _square(other)
    both = 2.0 * float(((one @ other.T) ** 2).sum()) / free**2
    return trace**2 - 2.0 * squares / free, squares + both


def _square(deviations: Floats) -> float:
    """Return tr(C^2) of one covariance, without the bias that few refits bring."""
    free = len(deviations) - 1
    gram = deviations @ deviations.T / free
    raw, trace = float((gram**2).sum()), float(np.trace(gram))
    return free**2 / ((free + 2) * (free - 1)) * (raw - trace**2 / free)
