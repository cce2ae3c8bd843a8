"""Code dials with the fine code's phase error as a Fourier series (Fourier)."""

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

MAX_HARMONICS = 16


@documented
@dataclass
class FourierPhase(DialModel):
    """Coarse cell and fine phase of each dial; the phase error is a Fourier series.

    The phase of the fine rows has a periodic error: one cycle per period from unequal gains, two
    from displaced rows, four from plain windows. The series fits all of them, and one projective
    transformation corrects the assembly of both dials.

    Parameters
    ----------
    harmonics : int
        Terms of the series, in [1, 16]; 4 reach the first one that plain windows cause.

    Attributes
    ----------
    series_ : ndarray, shape (2, harmonics, 2)
        Of the dials along x and y, the coefficients of ``sin(n p)`` and ``cos(n p)``, n from 1,
        as tangents.
    conversion_ : ndarray, shape (3, 3)
        Projection H: ``(tan(beta), tan(alpha), 1)`` in proportion to ``H (T_x, T_y, 1)``,
        ``H_33 = 1``.

    Notes
    -----
    Implements: eq:fourier (model:fourier, Fan2013): fine rows ``F1, F3 = a_0/2 -+ sum a_n cos(n
    p)``, ``F2, F4 = a_0/2 -+ sum a_n sin(n p)``, ``p = 2 pi alpha / theta_0 = atan2(F4 - F2, F3 -
    F1)`` where a_1 is alone; the survey states in words that the error of p is a Fourier series.
    Here ``T = place(cell, p) + sum_n A_n sin(n p) + B_n cos(n p)``, a tangent, of each dial.
    Fan2013 measures one axis, where assembly turns T into ``(b - d T) / (c T - a)`` (eq:pamulti);
    the projective transformation extends
    it to two axes (ours). A tilt in any direction, dials turned or
    off centre, a wrong focal length and slits askew are all projections: the relation is exact.

    Shapes: signals (N, 2 (bits + 4)), a dial's coarse tracks and then F1 to F4, in any common
    unit, to unit vectors (N, 3). All ``8 + 4 harmonics`` parameters are fitted together, by least
    squares of the angles.

    Failure: a NaN row for a NaN feature row, for fine rows without contrast, where cell and phase
    contradict each other, and where the direction would lie behind the detector. fit raises
    UnusableDataError where the samples do not determine every parameter.

    Cost: 2 arc tangents, 4 sines per harmonic and 60 operations per sample.

    Examples
    --------
    >>> from algorithms.angles import angles_from_sun, sun_from_angles
    >>> from algorithms.examples import dial_signals, sun_grid
    >>> design = dict(bits=5, cell_mm=0.15, period_mm=0.3, focal_length_mm=2.0)
    >>> sun = sun_grid(range(-30, 31, 3))
    >>> model = FourierPhase(**design).fit(dial_signals(sun, **design), sun)
    >>> signals = dial_signals(sun_from_angles([[12.3, -4.5]]), **design)
    >>> angles_from_sun(model.predict(signals)).round(3)
    array([[12.3, -4.5]])
    """

    about: ClassVar = AboutModel(
        name="fourier-phase",
        taxonomy="Fourier",
        studies=("Fan2013",),
        labels=("model:fourier", "eq:fourier", "eq:pamulti"),
        origin="survey",
        needs=NEEDS,
        accepts=frozenset({FeatureKind.SIGNALS}),
    )

    harmonics: int = 4

    series_: Floats = field(init=False, repr=False, compare=False)
    conversion_: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 1 <= self.harmonics <= MAX_HARMONICS:
            raise ValueError(
                f"{self.about.name}: harmonics must be in [1, {MAX_HARMONICS}]; got "
                f"{self.harmonics!r}"
            )

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Learn the series of both dials and the projection."""
        del context
        places, phases, vectors = self.code.calibration(features, sun)
        waves = self._waves(phases)

        def tangents(parameters: NDArray[np.complex128]) -> NDArray[np.complex128]:
            conversion, series = self._split(parameters)
            numerators, denominators = _project(conversion, _correct(places, waves, series))
            return np.asarray(numerators / denominators)

        start = np.zeros(8 + 4 * self.harmonics)
        start[[0, 4]] = 1.0
        self.conversion_, self.series_ = self._split(
            fit_tangents(tangents, start, vectors, self.about.name)
        )

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of signals (N, 2 (bits + 4))."""
        del context
        places, phases = self.code.read(features)
        corrected = _correct(places, self._waves(phases), self.series_)
        return sun_from_fractions(*_project(self.conversion_, corrected))

    def _waves(self, phases: Floats) -> Floats:
        """(harmonics, 2, N, 2) sines and cosines of the phases (N, 2) times 1, 2, ..."""
        turns = [n * phases for n in range(1, self.harmonics + 1)]
        return np.array([(np.sin(turn), np.cos(turn)) for turn in turns])

    def _split(self, parameters: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
        conversion = np.append(parameters[:8], 1.0).reshape(3, 3)
        return conversion, parameters[8:].reshape(2, self.harmonics, 2)


def _correct(places: Floats, waves: Floats, series: NDArray[Any]) -> NDArray[Any]:
    """Tangents T (N, 2): places and the series' terms, added one by one."""
    total: NDArray[Any] = places
    for n, (sine, cosine) in enumerate(waves):
        total = total + series[:, n, 0] * sine + series[:, n, 1] * cosine
    return total


def _project(conversion: NDArray[Any], tangents: NDArray[Any]) -> tuple[Any, Any]:
    """Numerators (N, 2) and their common denominator (N, 1) of the projection of T (N, 2)."""
    x, y = tangents[:, 0], tangents[:, 1]
    rows = [h[0] * x + h[1] * y + h[2] for h in conversion]
    return np.column_stack(rows[:2]), rows[2][:, None]
