"""Sun vectors as polynomials of all normalised signals together (Polynomial)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import combinations_with_replacement
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from algorithms.calibration.blocks import folds
from algorithms.calibration.calibrated import Columns
from algorithms.calibration.faces_model import SignalsModel
from algorithms.calibration.orders import choose_order, errors_of_orders
from algorithms.calibration.quality import Setting
from algorithms.contract import (
    AboutModel,
    FeatureKind,
    Floats,
    UnusableDataError,
)
from algorithms.documented import documented
from algorithms.inputs import require_samples
from algorithms.models.non_physical.regression_axes import solve_regression
from algorithms.parameters import require_order
from algorithms.row_arithmetic import normalise

MAX_DEGREE = 6

MAX_TERMS = 500
"""Most terms tried: what some thousand calibration samples can settle."""

_DEPENDENT = 1e-4
"""Share of a term that those before it leave, below which samples do not tell it from them."""


@documented
@dataclass
class SignalPolynomial(SignalsModel):
    """Each component of the Sun vector as a polynomial of all detectors' signals.

    The method needs no geometry of the cells; it compensates angular responses, gains and mounting
    as far as the degree permits.

    Parameters
    ----------
    degree : int, optional
        Total degree n, 1 to 6. None: chosen from the calibration samples by cross-validation.
    extrapolation : float
        Allowed extrapolation beyond the cone of calibrated directions, in radians, at least 0, and
        beyond the calibrated range of signals, in half ranges; infinity: unlimited.

    Attributes
    ----------
    middle_, half_range_ : ndarray, shape (K,)
        The signals' scaling ``u = (signal - middle) / half_range`` onto [-1, 1]; a signal that
        never changed is left alone.
    powers_ : ndarray, shape (terms, K)
        Degree of each signal's Chebyshev polynomial in each term, by total degree.
    coefficients_ : ndarray, shape (terms, 3)
        Of the terms, in s_x, s_y and s_z.
    dropped_ : int
        Terms up to the degree that the samples do not tell from others, left out.
    quality_ : FitQuality
        Residuals, the degree, the terms kept and those left out.

    Notes
    -----
    Implements: model:poly (Hermoso2021), described in words a polynomial of photodiode signals: ``s
    = sum_p c_p u_1^p_1 ... u_K^p_K``, ``p_1 + ... + p_K <= n``, scaled to length one (ours, for all
    signals at once), in products of Chebyshev polynomials, which span the same functions. The
    signals of different cells are not independent: the squares of a cube's signals add up to one,
    and opposite panels are never lit together. A term that is a linear combination of other terms
    on the calibration samples (to one part in ten thousand) cannot be determined and is left out,
    higher degrees first.

    Failure: a NaN row for a NaN feature row, outside the cone, where a signal leaves its
    calibrated range by more than a tenth of its half (a detector lit that never was), or where
    the vector vanishes. fit raises UnusableDataError where samples are fewer than the terms they
    tell apart, or no signal changes. UnsuitableDesignError for more than eight detectors.

    Cost: 8 operations a term and sample; ``(n + K)! / (n! K!)`` terms at most.

    Examples
    --------
    >>> import numpy as np
    >>> normals = np.array([[0.6, 0, 0.8], [-0.6, 0, 0.8], [0, 0.6, 0.8], [0, -0.6, 0.8]])
    >>> sun = np.random.default_rng(1).uniform((-0.3, -0.3, 1), (0.3, 0.3, 1), (300, 3))
    >>> sun /= np.linalg.norm(sun, axis=1, keepdims=True)
    >>> signals = (sun @ normals.T) ** 1.1
    >>> model = SignalPolynomial(signals=4).fit(signals, sun)
    >>> model.quality_.settings["degree"], bool(model.quality_.residual_rms_deg < 0.001)
    (5, True)
    """

    about: ClassVar = AboutModel(
        name="polynomial-signals",
        taxonomy="Polynomial",
        studies=("Hermoso2021",),
        labels=("model:poly",),
        origin="survey",
        needs=("face_normals",),
        accepts=frozenset({FeatureKind.SIGNALS}),
    )

    degree: int | None = None

    middle_: Floats = field(init=False, repr=False, compare=False)
    half_range_: Floats = field(init=False, repr=False, compare=False)
    powers_: NDArray[np.int64] = field(init=False, repr=False, compare=False)
    coefficients_: Floats = field(init=False, repr=False, compare=False)
    dropped_: int = field(init=False, repr=False, compare=False)
    validated_deg_: float | None = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        require_order(self.about.name, MAX_DEGREE, degree=self.degree)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Fit the components to samples (n, K) of Suns (n, 3)."""
        del context
        by = self.about.name
        low, high = features.min(axis=0), features.max(axis=0)
        middle, half = (low + high) / 2.0, (high - low) / 2.0
        if not (half > 0).any():
            raise UnusableDataError(f"{by} needs samples in which a signal changes; got none")
        scaled = _scale(features, middle, half)
        most = self.degree or self._largest_degree(len(features))
        powers = _powers(self.signals, most)
        design = _terms(scaled, powers)
        kept = _settled(design)
        design, kept_powers = design[:, kept], powers[kept]
        degrees = kept_powers.sum(axis=1)
        sizes = [int((degrees <= n).sum()) for n in range(1, most + 1)]
        degree, validated = most, None
        if self.degree is None:
            # faces go dark between poses, where the middle of two readings is no reading at all
            between = design[:0]
            choice = choose_order(errors_of_orders(design, sizes, sun, folds(sun), between), by)
            degree, validated = choice.order + 1, float(np.degrees(choice.rms))
        size = sizes[degree - 1]
        require_samples(len(features), size + 1, by, f"{size} terms of degree {degree}")
        self.coefficients_ = solve_regression(design[:, :size], sun, by)
        self.middle_, self.half_range_ = middle, half
        self.powers_ = kept_powers[:size]
        self.dropped_ = int((powers.sum(axis=1) <= degree).sum()) - size
        self.validated_deg_ = validated

    def settings(self) -> Mapping[str, Setting]:
        """Give the degree, chosen or given, and how many terms were kept and left out."""
        return {
            "degree": int(self.powers_.sum(axis=1).max()),
            "terms": len(self.powers_),
            "dropped": self.dropped_,
        }

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of signals (N, K)."""
        del context
        scaled = _scale(features, self.middle_, self.half_range_)
        columns = _power_columns(scaled, int(self.powers_.max()))
        vectors = np.zeros((len(features), 3), order="F")
        # Term by term: a matrix product rounds a sample differently in batches of another size.
        for powers, coefficients in zip(self.powers_, self.coefficients_, strict=True):
            term = np.ones(len(features))
            for signal in np.flatnonzero(powers):
                term *= columns[signal][powers[signal]]
            for axis in range(3):
                vectors[:, axis] += coefficients[axis] * term
        reach = 1.0 + _BEYOND + self.extrapolation
        inside = np.ones(len(features), dtype=np.bool_)
        for column in scaled.T:
            inside &= np.abs(column) <= reach
        vectors[~inside] = np.nan
        return normalise(vectors)

    def _largest_degree(self, samples: int) -> int:
        """Largest degree whose terms are no more than allowed, and than half the samples."""
        most = 1
        while most < MAX_DEGREE:
            terms = len(_powers(self.signals, most + 1))
            if terms > MAX_TERMS or terms > samples // 2:
                break
            most += 1
        return most


_BEYOND = 0.1


def _scale(features: Floats, middle: Floats, half: Floats) -> Floats:
    """Signals (N, K) on [-1, 1]; those that never changed as they are off their one value."""
    return np.asarray((features - middle) / np.where(half > 0, half, 1.0))


def _powers(signals: int, degree: int) -> NDArray[np.int64]:
    """(terms, K) powers of every product of signals up to a total degree, by degree."""
    rows = [
        np.bincount(picked, minlength=signals) if picked else np.zeros(signals, dtype=np.int64)
        for total in range(degree + 1)
        for picked in combinations_with_replacement(range(signals), total)
    ]
    return np.array(rows, dtype=np.int64)


def _power_columns(scaled: Floats, degree: int) -> list[list[Floats]]:
    """Of each signal, its Chebyshev polynomials 0..degree, each (N,)."""
    columns = []
    for column in scaled.T:
        found = [np.ones_like(column), column]
        for _ in range(degree - 1):
            found.append(2.0 * column * found[-1] - found[-2])
        columns.append(found)
    return columns


def _terms(scaled: Floats, powers: NDArray[np.int64]) -> Floats:
    """Products (n, terms) of the signals' Chebyshev polynomials."""
    columns = _power_columns(scaled, int(powers.max()))
    design = np.ones((len(scaled), len(powers)), order="F")
    for number, row in enumerate(powers):
        for signal in np.flatnonzero(row):
            design[:, number] *= columns[signal][row[signal]]
    return design


def _settled(design: Floats) -> NDArray[np.int64]:
    """Terms (in order) that are not sums of those before them: Gram and Schmidt, done twice."""
    basis = np.empty_like(design)
    kept: list[int] = []
    for number, column in enumerate(design.T):
        rest = column.copy()
        for _ in range(2):
            before = basis[:, : len(kept)]
            rest -= before @ (before.T @ rest)
        length = float(np.sqrt(rest @ rest))
        if length > _DEPENDENT * float(np.sqrt(column @ column)):
            basis[:, len(kept)] = rest / length
            kept.append(number)
    return np.array(kept, dtype=np.int64)
