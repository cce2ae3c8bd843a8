"""Code dials with the fine code's phase error and each dial's assembly calibrated (Periodic)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.dial_model import DialModel
from algorithms.contract import AboutModel, FeatureKind, Floats
from algorithms.documented import documented
from algorithms.models.multiplex.dial_code import (
    NEEDS,
    fit_tangents,
    sun_from_fractions,
)

_START = (0.0, 0.0, 0.0, 1.0, 0.0)


@documented
@dataclass
class PeriodicCode(DialModel):
    """Coarse cell and fine phase of each dial, corrected for periodic error and assembly.

    The Gray code identifies the period of the fine rows; their phase gives the position within the
    period. Rows displaced against each other cause a phase error of two cycles per period. A dial
    that is off centre, tilted or too far away changes the tangent into a ratio of two linear
    functions.

    Attributes
    ----------
    correction_ : ndarray, shape (2, 2)
        (k, t) of the dials along x and y: amplitude of the correction as a tangent, phase in
        radians.
    conversion_ : ndarray, shape (2, 4)
        (a, b, c, d) of the dials along x and y, a = -1.

    Notes
    -----
    Implements: eq:pamulti, eq:fourier (model:periodic, Fan2013): ``alpha_s = alpha_1 + alpha_2 + k
    sin(4 pi alpha / theta_0 + t)``, ``alpha_comp = arctan((b - d tan(alpha_s)) / (c tan(alpha_s) -
    a))``, the fine phase from ``F3 - F1`` and ``F4 - F2``. The survey prints ``sin(4 pi alpha +
    t)``; corrected because the error repeats twice per fine period theta_0. The tracks of a flat
    dial are even in the tangent, so alpha_1, alpha_2 and k add up there and the period is the
    phase's. Of (a, b, c, d) only the three ratios are determined. They and (k, t) are fitted by
    least squares of the angles, an axis at a time.

    Failure: a NaN row for a NaN feature row, for fine rows without contrast, where cell and phase
    contradict each other, and where the direction would lie behind the detector. What couples the
    axes (dials turned against the reference, slits askew) is not in the equation and stays. fit
    raises UnusableDataError where the samples do not determine the ten parameters.

    Cost: 2 arc tangents, 2 sines and 60 operations per sample.

    Examples
    --------
    >>> from algorithms.angles import angles_from_sun, sun_from_angles
    >>> from algorithms.examples import dial_signals, sun_grid
    >>> design = dict(bits=5, cell_mm=0.15, period_mm=0.3, focal_length_mm=2.0)
    >>> sun = sun_grid(range(-30, 31, 3))
    >>> model = PeriodicCode(**design).fit(dial_signals(sun, **design), sun)
    >>> signals = dial_signals(sun_from_angles([[12.3, -4.5]]), **design)
    >>> angles_from_sun(model.predict(signals)).round(3)
    array([[12.3, -4.5]])
    """

    about: ClassVar = AboutModel(
        name="periodic",
        taxonomy="Periodic",
        studies=("Fan2013",),
        labels=("model:periodic", "eq:pamulti", "eq:fourier"),
        origin="survey",
        needs=NEEDS,
        accepts=frozenset({FeatureKind.SIGNALS}),
    )

    correction_: Floats = field(init=False, repr=False, compare=False)
    conversion_: Floats = field(init=False, repr=False, compare=False)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Learn (k, t) and (a, b, c, d) of both dials."""
        del context
        places, phases, vectors = self.code.calibration(features, sun)

        def tangents(parameters: NDArray[np.complex128]) -> NDArray[np.complex128]:
            numerators, denominators = _fraction(parameters.reshape(2, 5), places, phases)
            return np.asarray(numerators / denominators)

        found = fit_tangents(tangents, np.tile(_START, 2), vectors, self.about.name).reshape(2, 5)
        sine, cosine, shift, slope, bend = found.T
        self.correction_ = np.column_stack([np.hypot(sine, cosine), np.arctan2(cosine, sine)])
        self.conversion_ = np.column_stack([np.full(2, -1.0), shift, bend, -slope])

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of signals (N, 2 (bits + 4))."""
        del context
        places, phases = self.code.read(features)
        k, t = self.correction_.T
        a, b, c, d = self.conversion_.T
        tangent = places + k * np.sin(2.0 * phases + t)
        return sun_from_fractions(b - d * tangent, c * tangent - a)


def _fraction(parameters: NDArray[Any], places: Floats, phases: Floats) -> tuple[Any, Any]:
    """Numerators and denominators (N, 2) of eq:pamulti's tangents.

    A row of `parameters` (2, 5) is an axis': k cos(t), k sin(t), b, -d and c, with a = -1.
    """
    sine, cosine, shift, slope, bend = parameters.T
    tangent = places + sine * np.sin(2.0 * phases) + cosine * np.cos(2.0 * phases)
    return shift + slope * tangent, 1.0 + bend * tangent
