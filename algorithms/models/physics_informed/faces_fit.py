"""All that a calibration tells of faces: gains, normals, response, and how even the light was."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from algorithms.calibration.conditioning import WORST_SOLUTION
from algorithms.calibration.quality import Parameter
from algorithms.contract import Floats, UnusableDataError
from algorithms.models.physics_informed.faces_weighing import ResidualWeights

FEWEST_LIT = 12
"""Samples that must light a face."""

DARK_COSINE = -0.1
"""Nominal cosine below which a face is surely dark, by more than any error of mounting."""

_MAX_EVALUATIONS = 100
#: Fits with the weights that the one before shows; the third changes nothing to speak of.
_ROUNDS = 3
#: Relative change at which the last of them stops, and those before it.
_PRECISION, _ON_THE_WAY = 1e-15, 1e-12
_STEP = 1e-6
#: Coefficients of a response: of 1, c, c^2 and c^3.
_POWERS = 4
#: Of a lamp's light: its slopes along the three axes of the sensor.
_SLOPES = 3


@dataclass
class FacesFit:
    """Joint Levenberg-Marquardt fit of ``x_k = g_k L(s) f(n_k . s) + d_k`` of K faces.

    f is a cubic, ``f(1) = 1``, the same for all faces or one each; ``L = 1 + u . s`` is how even
    the light was over the turntable's poses, which no face can tell from its own tilt but all
    together can. What the light's strength does from pose to pose beside that, all faces of a
    sample share: it is weighed out (`Weighing`), not taken for noise of each.

    Attributes
    ----------
    nominal : ndarray, shape (K, 3)
        Unit normals of the drawing.
    signals : ndarray, shape (n, K)
        Of the calibration.
    sun : ndarray, shape (n, 3)
        Its directions.
    by : str
        Whose fit it is, for messages.
    normals, responses, dark, noise, parameters, condition
        As `AssembledFaces` has them; set by `solve`.
    """

    nominal: Floats
    signals: Floats
    sun: Floats
    by: str
    normals: Floats = field(init=False)
    responses: Floats = field(init=False)
    dark: Floats = field(init=False)
    noise: Floats = field(init=False)
    parameters: tuple[Parameter, ...] = field(init=False)
    condition: float = field(init=False)

    def __post_init__(self) -> None:
        cosines = self.sun @ self.nominal.T
        lit = (cosines > -DARK_COSINE).sum(axis=0)
        if lit.min() < FEWEST_LIT:
            face = int(lit.argmin())
            raise UnusableDataError(
                f"{self.by}: face {face + 1} is lit by {int(lit[face])} calibration samples; at "
                f"least {FEWEST_LIT} must light it"
            )
        unlit = cosines < DARK_COSINE
        count = unlit.sum(axis=0)
        self.dark = np.where(
            count > 0, (self.signals * unlit).sum(axis=0) / np.maximum(count, 1), 0.0
        )
        light = self.signals - self.dark
        self._size = np.abs(light).max(axis=0)
        if not (self._size > 0).all():
            face = int(np.argmin(self._size))
            raise UnusableDataError(f"{self.by}: face {face + 1} has no signal, whatever the Sun")
        self._light = light / self._size
        self._used = ~unlit
        axes = [_axes_across(normal) for normal in self.nominal]
        self._first = np.array([first for first, _ in axes])
        self._second = np.array([second for _, second in axes])

    def solve(self, *, each: bool) -> FacesFit:
        """Fit, with a response for each face or one for all; returns self.

        Raises
        ------
        UnusableDataError
            If the samples do not determine every number.
        """
        from scipy.optimize import least_squares  # noqa: PLC0415 - SciPy, at the first fit only

        faces = len(self.nominal)
        shapes = faces if each else 1
        # gain and two tilts a face, three free coefficients a response, three slopes of the lamp
        start = np.concatenate(
            [np.ones(faces), np.zeros(2 * faces), np.zeros(3 * shapes), np.zeros(_SLOPES)]
        )

        method: Literal["lm", "trf"] = "lm" if self._used.sum() >= len(start) else "trf"
        weighing = ResidualWeights.even(self._used)
        # where the numbers are only just settled, the lamp's strength cannot be distinguished from
        # them
        rounds = _ROUNDS if self._used.sum() > 2 * (len(start) + len(self.sun)) else 1
        for number in range(rounds):

            def residuals(vector: Floats, weighing: ResidualWeights = weighing) -> Floats:
                off = self._model(*self._split(vector, shapes)) - self._light
                return weighing.weigh(off)[self._used]

            def jacobian(vector: Floats, weighing: ResidualWeights = weighing) -> Floats:
                return weighing.weigh(self._derivatives(vector, shapes))[self._used]

            tolerance = _PRECISION if number + 1 == rounds else _ON_THE_WAY
            solution = least_squares(
                residuals,
                start,
                jac=jacobian,
                method=method,
                ftol=tolerance,
                xtol=tolerance,
                gtol=tolerance,
                max_nfev=_MAX_EVALUATIONS,
            )
            start = solution.x
            modelled = self._model(*self._split(start, shapes))
            if number + 1 < rounds:
                weighing = ResidualWeights.of(
                    modelled, self._light - modelled, self._used, len(start)
                )
        derivatives = np.asarray(solution.jac, dtype=np.float64)
        lengths = np.linalg.norm(derivatives, axis=0)
        values = np.linalg.svd(derivatives / np.where(lengths > 0, lengths, 1.0), compute_uv=False)
        if not (np.isfinite(solution.x).all() and values[-1] * WORST_SOLUTION > values[0]):
            raise UnusableDataError(
                f"{self.by}: the calibration samples do not settle gains, normals and response of "
                f"{faces} faces; they must spread over the field of view"
            )
        freedom = max(int(self._used.sum()) - len(start), 1)
        covariance = np.linalg.inv(derivatives.T @ derivatives) * (2.0 * solution.cost / freedom)
        deviations = np.sqrt(np.diag(covariance))
        gains, tilts, shape, _ = self._split(solution.x, shapes)
        self.normals = self._tilt(tilts)
        self.responses = (self._size * gains)[:, None] * coefficients(shape)
        self.noise = (
            self._size
            * ResidualWeights.of(modelled, self._light - modelled, self._used, len(start)).noise
        )
        self.condition = float(values[0] / values[-1])
        self.parameters = self._name_of(solution.x, deviations, shapes)
        return self

    def _split(self, vector: Floats, shapes: int) -> tuple[Floats, Floats, Floats, Floats]:
        """Gains (K,), tilts (K, 2), free coefficients (shapes, 3) and slopes (3,)."""
        faces = len(self.nominal)
        tilts, shape = vector[faces : 3 * faces], vector[3 * faces : 3 * (faces + shapes)]
        slopes = vector[3 * (faces + shapes) :]
        return vector[:faces], tilts.reshape(faces, 2), shape.reshape(shapes, 3), slopes

    def _derivatives(self, vector: Floats, shapes: int) -> Floats:
        """(n, K, P) of the modelled signals, by central differences.

        A face's own numbers move its signals alone: all faces' are moved at once.
        """
        faces, count = len(self.nominal), len(vector)
        own = 1 if shapes == 1 else faces
        # numbers moved together, one a face where they are a face's own
        groups = [np.arange(faces)]
        groups += [faces + np.arange(a, 2 * faces, 2) for a in (0, 1)]
        groups += [3 * faces + np.arange(a, 3 * own, 3) for a in range(3)]
        groups += [np.array([number]) for number in range(count - _SLOPES, count)]
        found = np.zeros((len(self.sun), faces, count))
        for group in groups:
            step = np.zeros(count)
            step[group] = _STEP
            rise = self._model(*self._split(vector + step, shapes)) - self._model(
                *self._split(vector - step, shapes)
            )
            rise /= 2.0 * _STEP
            if len(group) == faces:
                found[:, np.arange(faces), group] = rise
            else:
                found[:, :, group[0]] = rise
        return found

    def _tilt(self, tilts: Floats) -> Floats:
        normals = self.nominal + tilts[:, :1] * self._first + tilts[:, 1:] * self._second
        return np.asarray(normals / np.sqrt((normals**2).sum(axis=1, keepdims=True)))

    def _model(self, gains: Floats, tilts: Floats, shape: Floats, slopes: Floats) -> Floats:
        """Signals (n, K) over each face's largest."""
        cosines = self.sun @ self._tilt(tilts).T
        b = coefficients(shape)
        value = ((b[:, 3] * cosines + b[:, 2]) * cosines + b[:, 1]) * cosines + b[:, 0]
        value = np.where((cosines > 0) & (value > 0), value, 0.0)
        return np.asarray(gains * value * (1.0 + self.sun @ slopes)[:, None])

    def _name_of(self, vector: Floats, deviations: Floats, shapes: int) -> tuple[Parameter, ...]:
        """Every number with its standard error, in the signals' unit and in degrees."""
        faces = len(self.nominal)
        degrees = float(np.degrees(1.0))
        kinds = [
            *((f"gain_{k + 1}", float(self._size[k]), "") for k in range(faces)),
            *((f"tilt_{k + 1}_{a}", degrees, "deg") for k in range(faces) for a in "12"),
            *(
                (f"response_{power}" + (f"_{k + 1}" if shapes > 1 else ""), 1.0, "")
                for k in range(shapes)
                for power in (0, 2, 3)
            ),
            *((f"light_{axis}", 1.0, "") for axis in "xyz"),
        ]
        return tuple(
            Parameter(name, float(value * scale), float(deviation * scale), unit)
            for (name, scale, unit), value, deviation in zip(kinds, vector, deviations, strict=True)
        )


def coefficients(shape: Floats) -> Floats:
    """(S, 4) coefficients of 1, c, c^2, c^3 of responses with ``f(1) = 1``.

    Parameters
    ----------
    shape : ndarray, shape (S, 3)
        Those of 1, c^2 and c^3.
    """
    b0, b2, b3 = shape.T
    return np.stack([b0, 1.0 - b0 - b2 - b3, b2, b3], axis=1)


def _axes_across(normal: Floats) -> tuple[Floats, Floats]:
    """Two unit vectors across a normal and each other."""
    first = np.cross(np.eye(3)[int(np.abs(normal).argmin())], normal)
    first /= np.sqrt(first @ first)
    return first, np.cross(normal, first)
