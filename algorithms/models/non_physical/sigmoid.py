"""Balances as a logistic curve, one wave and an offset of the Sun angle, inverted (Sigmoid)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from algorithms.angles import angles_from_sun, sun_from_tangents
from algorithms.calibration.calibrated import Columns
from algorithms.calibration.parametric import FreeParameter, ParametricModel
from algorithms.contract import AboutModel, FeatureKind, Floats, UnusableDataError
from algorithms.documented import documented
from algorithms.inputs import require_samples

#: Of each axis, (alpha, beta), the balance that it is read from, (s_a, s_b).
_BALANCES = (("alpha", 1), ("beta", 0))
_AXIS = 6

_LARGEST = np.radians(89.9)
#: Angles at which a curve is tabled to start its inversion from.
_NODES = 2049
#: Newton's steps from there: the first leaves 1e-10 rad, the second rounding.
_STEPS = 3
#: Largest error of a balance, over its slope at the middle, at which an inversion counts.
_INVERTED = 1e-9
#: Residual of a balance where a trial's curve has no value: farther off than any.
_UNDEFINED = 10.0
#: Bends that a fit may start from, 1/rad^2, and how near to a tangent's pole one may reach.
_BENDS = (0.3, -0.3, -1.0, -2.0, 1.0, 2.0, 4.0, 8.0, 16.0)
_NEARLY_POLE = 2.0
#: Share of the balances' variance that a straight line explains at least: a step leaves it 3/4.
_STRAIGHT = 0.5

#: Argument squared below which a logistic curve is its series, and the series' coefficients.
_NEARLY_STRAIGHT = 1e-2
_SERIES = (1.0, -1.0 / 3.0, 2.0 / 15.0, -17.0 / 315.0, 62.0 / 2835.0, -1382.0 / 155925.0)


@documented
@dataclass
class SigmoidBalance(ParametricModel):
    """Each balance as a logistic curve of its Sun angle, with first-order Fourier terms and offset.

    The balance of a round spot changes slowly at the ends of the field and quickly in the middle. A
    logistic curve has that shape and the Fourier terms fit the residual, so few parameters suffice
    for a wide field.

    Attributes
    ----------
    vector_ : ndarray, shape (12,)
        Of alpha and then beta: slope in 1/rad, bend in 1/rad^2, skew in 1/rad, and the wave's
        cosine, sine and the offset, balances.
    calibrated_deg_ : ndarray, shape (2, 2)
        Lowest and highest alpha, and beta, of the calibration: one period of the wave.

    Notes
    -----
    Implements: model:sigmoid (Pentke2022), described in words: ``s = slope L(t - m) + cosine cos(w
    (t - m)) + sine sin(w (t - m)) + offset``, t the Sun angle, m the middle of its calibrated range
    and 2 pi / w that range. ``L = T / (1 + skew T)``, ``T(x) = tanh(q x) / q``, ``q^2 = bend``, is
    the logistic ``A (2 / (1 + exp(-k (t - c))) - 1)`` less its value at m, with ``q = k / 2``,
    ``skew = q tanh(q (m - c))`` and ``slope = A q (1 - tanh^2(q (m - c)))``. Told by its slope at
    m, bend and skew (ours) it passes through a straight line (both 0), where A, k and c run to
    infinity or mean nothing, to ``tan(p x) / p``, ``p^2 = -bend``, which is a square aperture's.
    The fit minimises the errors of the balances, because the noise is that of the balances.

    Shapes: balances ``(s_a, s_b)`` (N, 2) to unit vectors (N, 3).

    Failure: a NaN row for a NaN feature row, outside the hull, and for a balance that the curve
    does not reach before it turns back. fit raises UnusableDataError below 7 samples, where they
    do not determine the parameters, or where a fitted curve turns back within the calibrated
    range.

    Cost: 2 tables and 6 steps of a hyperbolic tangent, a sine and a cosine per sample: some ten
    times a polynomial's.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.angles import angles_from_sun
    >>> from algorithms.examples import sun_grid
    >>> sun = sun_grid(range(-50, 51, 5))
    >>> balances = 0.9 * np.tanh(np.radians(1.4 * angles_from_sun(sun)[:, ::-1] - 2.0)) + 0.01
    >>> model = SigmoidBalance().fit(balances, sun)
    >>> [round(model.quality_.parameter(f"{name}_beta").value, 3) for name in ("bend", "skew")]
    [1.96, -0.049]
    >>> angles_from_sun(model.predict(balances[:1])).round(6)
    array([[-50., -50.]])
    """

    about: ClassVar = AboutModel(
        name="sigmoid",
        taxonomy="Sigmoid",
        studies=("Pentke2022",),
        labels=("model:sigmoid",),
        origin="survey",
        accepts=frozenset({FeatureKind.BALANCE}),
    )

    fewest: ClassVar[int] = 7

    calibrated_deg_: Floats = field(init=False, repr=False, compare=False)

    def free_parameters(self) -> Sequence[FreeParameter]:
        """Balances, and what they are of a radian."""
        return [
            FreeParameter(f"{name}_{axis}", unit, 1.0)
            for axis, _ in _BALANCES
            for name, unit in (
                ("slope", "1/rad"),
                ("bend", "1/rad^2"),
                ("skew", "1/rad"),
                ("cosine", ""),
                ("sine", ""),
                ("offset", ""),
            )
        ]

    def starts(self, features: Floats, sun: Floats, context: Columns) -> Sequence[Sequence[float]]:
        """Give, of each axis, the best of curves with a few bends."""
        del context
        angles = angles_from_sun(sun)
        self.calibrated_deg_ = np.stack([angles.min(axis=0), angles.max(axis=0)], axis=1)
        if not (np.ptp(self.calibrated_deg_, axis=1) > 0).all():
            raise UnusableDataError(f"{self.about.name} needs Suns that spread along both angles")
        start: list[float] = []
        for axis, (name, column) in enumerate(_BALANCES):
            turn = np.radians(angles[:, axis])
            moved, balance = turn - turn.mean(), features[:, column] - features[:, column].mean()
            along = float(moved @ balance)
            if not along**2 > _STRAIGHT * float(moved @ moved) * float(balance @ balance):
                raise UnusableDataError(
                    f"{self.about.name}: balance {column} does not rise or fall with {name}: are "
                    "the axes swapped, or samples out of order?"
                )
            start += self._straightforward(axis, turn, features[:, column])
        return [start]

    def _straightforward(self, axis: int, turn: Floats, balance: Floats) -> list[float]:
        """Numbers of an axis that fit best with one of a few bends and no skew: linear ones."""
        low, high = np.radians(self.calibrated_deg_[axis])
        phase = 2.0 * np.pi * (turn - (low + high) / 2.0) / (high - low)
        turn = turn - (low + high) / 2.0
        best, least = [0.0] * _AXIS, np.inf
        for bend in _BENDS:
            if bend * (high - low) ** 2 / 4.0 < -_NEARLY_POLE:
                continue
            columns = [_logistic(turn, bend), np.cos(phase), np.sin(phase), np.ones_like(turn)]
            design = np.stack(columns, axis=1)
            slope, cosine, sine, offset = np.linalg.lstsq(design, balance, rcond=None)[0]
            off = balance - design @ (slope, cosine, sine, offset)
            if off @ off < least:
                best, least = [slope, bend, 0.0, cosine, sine, offset], float(off @ off)
        return best

    def residuals(
        self,
        vector: Floats,
        features: Floats,
        sun: Floats,
        axes: tuple[Floats, Floats],
        context: Columns,
    ) -> Floats:
        """(n, 2) errors of the balances: the curve runs from angles to them."""
        del axes, context
        off = np.empty((len(features), 2))
        for axis, (_, column) in enumerate(_BALANCES):
            angle = np.arctan(sun[:, column] / sun[:, 2])
            found, _ = self._curve(vector, axis, angle)
            off[:, axis] = found - features[:, column]
        return np.where(np.isfinite(off), off, _UNDEFINED)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Fit both curves to samples (n, 2) of Suns (n, 3)."""
        by = self.about.name
        require_samples(len(np.unique(features, axis=0)), self.fewest, by, "six numbers an axis")
        super().learn(features, sun, context)
        for axis, (name, _) in enumerate(_BALANCES):
            low, high = self.calibrated_deg_[axis]
            _, rising = self._curve(self.vector_, axis, np.radians(np.linspace(low, high, _NODES)))
            if not (rising > 0).all() and not (rising < 0).all():
                raise UnusableDataError(
                    f"{by}: the fitted curve of {name} turns back within the calibrated range, "
                    "so that one balance stands for several angles"
                )

    def directions(self, vector: Floats, features: Floats, context: Columns) -> Floats:
        """(N, 3) directions of balances (N, 2)."""
        del context
        tangents = np.empty((len(features), 2), order="F")
        for axis, (_, column) in enumerate(_BALANCES):
            np.tan(self._inverse(vector, axis, features[:, column]), out=tangents[:, axis])
        return sun_from_tangents(tangents)

    def _curve(self, vector: Floats, axis: int, angle: Floats) -> tuple[Floats, Floats]:
        """Balance at angles (n,) in radians and its derivative; NaN past a tangent's pole."""
        slope, bend, skew, cosine, sine, offset = vector[axis * _AXIS : (axis + 1) * _AXIS]
        low, high = np.radians(self.calibrated_deg_[axis])
        wave = 2.0 * np.pi / (high - low)
        moved = angle - (low + high) / 2.0
        bent = _logistic(moved, bend)
        share = 1.0 + skew * bent
        share[~(share > 0)] = np.nan  # past the pole of a curve without an end
        curve = bent / share
        turn = wave * moved
        up, along = np.sin(turn), np.cos(turn)
        value = slope * curve + cosine * along + sine * up + offset
        steepness = 1.0 - 2.0 * skew * curve - (bend - skew * skew) * curve * curve
        rising = slope * steepness + wave * (sine * along - cosine * up)
        return value, rising

    def _inverse(self, vector: Floats, axis: int, balance: Floats) -> Floats:
        """Angles (N,) in radians at which the curve, where it does not turn, has these balances."""
        middle = float(np.radians(self.calibrated_deg_[axis].mean()))
        nodes = np.linspace(-_LARGEST, _LARGEST, _NODES)
        values, rising = self._curve(vector, axis, nodes)
        way = np.sign(vector[axis * _AXIS])
        turned = ~(way * rising > 0)
        centre = int(np.argmin(np.abs(nodes - middle)))
        below, above = np.flatnonzero(turned[:centre]), np.flatnonzero(turned[centre:])
        first = int(below[-1]) + 1 if len(below) else 0
        last = centre + int(above[0]) if len(above) else len(nodes)
        if last - first < 2:
            return np.full(len(balance), np.nan)
        order = slice(first, last) if way > 0 else slice(last - 1, first - 1 if first else None, -1)
        angle = np.interp(balance, values[order], nodes[order], left=np.nan, right=np.nan)
        for _ in range(_STEPS):
            found, slope = self._curve(vector, axis, angle)
            angle = angle - (found - balance) / slope
        found, slope = self._curve(vector, axis, angle)
        angle[~(np.abs(found - balance) <= _INVERTED * np.abs(slope))] = np.nan
        return angle


def _logistic(x: Floats, bend: float) -> Floats:
    """``tanh(q x) / q`` (n,) with ``q^2 = bend``, and what it becomes at zero and below."""
    root = float(np.sqrt(np.abs(bend)))
    square = bend * x * x
    series = np.zeros_like(x)
    for coefficient in _SERIES[::-1]:
        series = coefficient + square * series
    series *= x
    if root == 0.0:
        return series
    if bend > 0:
        curve = np.tanh(root * x) / root
    else:
        curve = np.tan(root * x) / root
        curve[~(np.abs(root * x) < np.pi / 2.0)] = np.nan
    return np.where(np.abs(square) < _NEARLY_STRAIGHT, series, curve)
