"""`ParametricModel`: a sensor's geometry with a few numbers settled by nonlinear least squares."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from algorithms.calibration.calibrated import CalibratedModel, Columns
from algorithms.calibration.conditioning import WORST_SOLUTION
from algorithms.calibration.quality import Parameter
from algorithms.calibration.residual_noise import parameter_covariance
from algorithms.contract import Floats, UnusableDataError
from algorithms.inputs import require_samples

RADIAN_DEG = math.degrees(1.0)
"""Scale of angles in degrees."""

TOLERANCE = 1e-15
"""Relative change of cost, step and gradient at which a fit stops: machine precision."""

MAX_EVALUATIONS = 400
"""Of the residuals' derivatives; a fit that has not come to rest by then does not."""

#: A direction that a trial's numbers leave undefined: farther off than any defined one.
_UNDEFINED_RAD = 4.0
#: Step of a central difference, as a share of a parameter's scale: the cube root of precision.
_STEP = 6e-6


class FreeParameter(NamedTuple):
    """A number that a fit settles.

    Attributes
    ----------
    name, unit : str
        Of the parameter.
    scale : float
        Change of it that shifts directions by some tenths of a radian.
    drawn : float
        Value in the sensor's drawing.
    """

    name: str
    unit: str
    scale: float
    drawn: float = 0.0


@dataclass
class ParametricModel(CalibratedModel):
    """Directions as a function of features and a vector of parameters, all fitted together.

    A subclass writes `free_parameters` and `directions`, and `starts` if the drawing is not where
    to start. Residuals are the two components of each direction's error across the true one, so
    that a fit is as good where the Sun is far off the boresight as where it is near.

    Attributes
    ----------
    vector_ : ndarray, shape (P,)
        Fitted parameters, in the units that `free_parameters` says.
    covariance_ : ndarray, shape (P, P)
        Of their errors, from the residuals: of a turntable and of features (`residual_noise`).
    condition_ : float
        Of the equations at the solution, their columns brought to one length.
    """

    vector_: Floats = field(init=False, repr=False, compare=False)
    covariance_: Floats = field(init=False, repr=False, compare=False)
    condition_: float = field(init=False, repr=False, compare=False)

    @abstractmethod
    def free_parameters(self) -> Sequence[FreeParameter]:
        """Numbers that a fit settles, in the order of its vector."""
        ...

    def starts(self, features: Floats, sun: Floats, context: Columns) -> Sequence[Sequence[float]]:
        """Vectors to start from, by default the drawing; the best solution is kept."""
        del features, sun, context
        return ([one.drawn for one in self.free_parameters()],)

    @abstractmethod
    def directions(self, vector: Floats, features: Floats, context: Columns) -> Floats:
        """(N, 3) unit vectors of features (N, F), with parameters `vector`; NaN where undefined."""
        ...

    def residuals(
        self,
        vector: Floats,
        features: Floats,
        sun: Floats,
        axes: tuple[Floats, Floats],
        context: Columns,
    ) -> Floats:
        """(n, 2) errors to make small, radians: those across the true directions by default."""
        return across(self.directions(vector, features, context), sun, *axes)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Fit all parameters to samples (n, F) of Suns (n, 3)."""
        from scipy.optimize import least_squares  # noqa: PLC0415 - SciPy, at the first fit only

        by, free = self.about.name, self.free_parameters()
        scales = np.array([one.scale for one in free], dtype=np.float64)
        count = len(scales)
        require_samples(len(features), count // 2 + 1, by, f"{count} parameters, two angles each")
        axes = tangent_axes(sun)

        def residuals(scaled: Floats) -> Floats:
            return self.residuals(scaled * scales, features, sun, axes, context).ravel()

        def derivatives(scaled: Floats) -> Floats:
            columns = np.empty((2 * len(features), count))
            for number in range(count):
                step = np.zeros(count)
                step[number] = _STEP
                columns[:, number] = (residuals(scaled + step) - residuals(scaled - step)) / (
                    2.0 * _STEP
                )
            return columns

        best: Any = None
        for start in self.starts(features, sun, context):
            solution = least_squares(
                residuals,
                np.asarray(start, dtype=np.float64) / scales,
                jac=derivatives,
                method="lm",
                ftol=TOLERANCE,
                xtol=TOLERANCE,
                gtol=TOLERANCE,
                max_nfev=MAX_EVALUATIONS,
            )
            if np.isfinite(solution.x).all() and (best is None or solution.cost < best.cost):
                best = solution
        if best is None or not best.success:
            reason = "no finite solution" if best is None else best.message
            raise UnusableDataError(f"{by}: the fit did not converge ({reason})")

        jacobian = best.jac
        lengths = np.linalg.norm(jacobian, axis=0)
        values = (
            np.linalg.svd(jacobian / lengths, compute_uv=False)
            if (lengths > 0).all()
            else np.zeros(1)
        )
        if not values[-1] * WORST_SOLUTION > values[0]:
            raise UnusableDataError(
                f"{by}: the calibration samples do not settle the {count} parameters "
                f"({', '.join(one.name for one in free)}); they must spread over the field "
                "of view"
            )
        moved = self._move(best.x * scales, features, sun, axes, context)
        covariance = parameter_covariance(
            jacobian.reshape(-1, 2, count), best.fun.reshape(-1, 2), moved
        )
        self.vector_ = np.asarray(best.x * scales)
        self.covariance_ = np.asarray(covariance * np.outer(scales, scales))
        self.condition_ = float(values[0] / values[-1])

    def _move(
        self,
        vector: Floats,
        features: Floats,
        sun: Floats,
        axes: tuple[Floats, Floats],
        context: Columns,
    ) -> Floats:
        """(n, 2, F) derivatives of the residuals by each feature; 0 where there are none."""
        found = np.empty((len(features), 2, features.shape[1]))
        for column in range(features.shape[1]):
            step = _STEP * (float(np.std(features[:, column])) or 1.0)
            ends = []
            for way in (step, -step):
                beside = features.copy()
                beside[:, column] += way
                ends.append(self.residuals(vector, beside, sun, axes, context))
            found[:, :, column] = (ends[0] - ends[1]) / (2.0 * step)
        return np.nan_to_num(found, posinf=0.0, neginf=0.0)

    def answer(self, features: Floats, context: Columns) -> Floats:
        """(N, 3) unit vectors of features (N, F)."""
        return self.directions(self.vector_, features, context)

    def fitted_parameters(self) -> tuple[Parameter, ...]:
        """Every parameter with its standard error."""
        deviations = np.sqrt(np.diag(self.covariance_))
        return tuple(
            Parameter(one.name, float(value), float(deviation), one.unit)
            for one, value, deviation in zip(
                self.free_parameters(), self.vector_, deviations, strict=True
            )
        )

    def condition(self) -> float:
        """Condition of the equations at the solution."""
        return self.condition_

    def variance(self, features: Floats, context: Columns) -> Floats:
        """(N,) variance of a tangent axis that the parameters' errors make, rad^2."""
        steps = np.sqrt(np.diag(self.covariance_))
        steps = np.where(steps > 0, steps, 1e-12)
        middle = self.directions(self.vector_, features, context)
        first, second = tangent_axes(middle)
        moved = np.empty((len(steps), len(features), 2))
        for number, step in enumerate(steps):
            shifted = self.vector_.copy()
            shifted[number] += step
            found = self.directions(shifted, features, context)
            moved[number] = across(found, middle, first, second)
        correlation = self.covariance_ / np.outer(steps, steps)
        return np.asarray(np.einsum("ink,ij,jnk->n", moved, correlation, moved) / 2.0)


def tangent_axes(sun: Floats) -> tuple[Floats, Floats]:
    """Two unit vectors (N, 3) across each direction (N, 3) and each other."""
    # Across the axis that the direction is farthest from, so that no product is small.
    least = np.abs(np.nan_to_num(sun)).argmin(axis=1)
    first = np.cross(np.eye(3)[least], sun)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return first, np.cross(sun, first)


def across(found: Floats, sun: Floats, first: Floats, second: Floats) -> Floats:
    """Errors (N, 2) of directions along two axes across the true ones, radians.

    The length is the angle itself, so that a direction behind is farther off than one beside.
    """
    from algorithms.calibration.parametric_kernel import offsets_across, stretch_to_angles  # noqa: PLC0415 - Numba

    off, lengths = np.empty((len(found), 2)), np.empty((2, len(found)))
    offsets_across(found, sun, first, second, off, lengths)
    stretch_to_angles(off, lengths[0], np.arctan2(*lengths), _UNDEFINED_RAD)
    return off
