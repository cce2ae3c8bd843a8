"""Photodiodes as they were mounted: normals, gains and responses learnt on the ground (ACM)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Literal

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.faces_model import FacesModel
from algorithms.calibration.quality import Parameter
from algorithms.contract import AboutModel, FeatureKind, Floats
from algorithms.documented import documented
from algorithms.models.geometric.detector_faces import Normals, require_normals
from algorithms.models.physics_informed.faces_fit import FEWEST_LIT, FacesFit
from algorithms.parameters import require_choice, require_positive
from algorithms.row_arithmetic import normalise

Sharing = Literal["common", "each"]

ITERATIONS = 100
"""Most steps towards a direction; ten are usual."""

#: Smallest step, over its vector, that is still taken.
_AT_REST = 1e-13
#: Of the equations' diagonal, over its mean, at the first step and at least.
_FIRST_DAMPING, _LEAST_DAMPING = 1e-4, 1e-12
#: Rise of the sum of squares, relative, that is still none: rounding must not choose the path.
_EQUAL = 1e-12
#: Width of the bend between dark and lit, over the face's noise: the equations are smooth there,
#: so that steps come to rest where the least sum is, on every processor.
_BEND = 0.5
#: Of the equations of the first vector, so that what is open is nothing.
_LEAST_START = 1e-6
#: What the first vector is moved by, over its length: between two dark faces the signals have two
#: solutions, one to each side, and a start on the ridge between them leaves the side to rounding.
_ASIDE = (6e-4, 5e-4, 7e-4)
#: Standard deviation of a direction from which on it is none: the lit faces leave it open.
_WORST_RAD = 0.1


@documented
@dataclass
class AssembledFaces(FacesModel):
    """Direction that best explains the signals of all faces, each with its calibrated response.

    The calibration gives each face's true normal and its angular response; a direction is then the
    least-squares fit to all faces, dark ones included, with the strength of the light as a bounded
    parameter.

    Parameters
    ----------
    response : {"common", "each"}
        Whether all faces have one response but for their gains, as elements of one make do, or
        each its own.
    level_spread : float
        Standard deviation of the light's strength around that of the calibration, relative,
        positive: Sun and lamp differ, and the Sun's distance changes.

    Attributes
    ----------
    normals_ : ndarray, shape (K, 3)
        Where each face looks.
    responses_ : ndarray, shape (K, 4)
        Of each face ``b``: its signal is ``b_0 + b_1 c + b_2 c^2 + b_3 c^3`` at the cosine c of
        incidence, bent softly to nothing where that is negative or the Sun behind; in the signals'
        unit.
    dark_ : ndarray, shape (K,)
        Signal of each face in the dark; 0 where no sample left it so.
    noise_ : ndarray, shape (K,)
        Standard deviation of each face's readings, without what the light's strength does to all.
    parameters_ : tuple of Parameter
        Gains, tilts, response and the slopes of the lamp's light, with standard errors.
    condition_ : float
        Of the equations, their columns brought to one length.

    Notes
    -----
    Implements: model:assem (Radan2019), on the ground: installation errors found by
    Levenberg-Marquardt. The survey gives no equations since every sensor has its own; for faces
    these are a normal and a response each, the response a cubic as eq:kellycos is, with
    coefficients of its own (ours). The light may flicker: residuals are weighed by the likeliest
    spread of its strength, which the faces of a sample share, and noise of each face.

    Shapes: signals (N, K), in any common unit, to unit vectors (N, 3).

    Failure: a NaN row for a NaN feature row, where no face is lit, where the lit ones leave the
    direction open, and outside the cone. Albedo is not distinguished from sunlight. fit raises
    UnusableDataError where a face is lit by fewer than 12 samples, or they do not determine its six
    numbers.

    Cost: some ten steps of 30 operations per face and 60 per sample; the fit, some twenty passes of
    seven over the samples a face.

    Examples
    --------
    >>> from algorithms.examples import face_signals, sun_grid
    >>> normals = ((0.6, 0.0, 0.8), (-0.6, 0.0, 0.8), (0.0, 0.6, 0.8), (0.0, -0.6, 0.8))
    >>> sun = sun_grid(range(-30, 31, 10))
    >>> signals = face_signals(sun, normals) * (1.0, 1.1, 0.9, 1.2)
    >>> model = AssembledFaces(normals).fit(signals, sun)
    >>> gains = [model.quality_.parameter(f"gain_{face}").value for face in (1, 4)]
    >>> round(gains[1] / gains[0], 6)
    1.2
    """

    about: ClassVar = AboutModel(
        name="assembled-faces",
        taxonomy="ACM",
        studies=("Radan2019",),
        labels=("model:assem", "eq:kellycos"),
        origin="survey",
        needs=("face_normals",),
        accepts=frozenset({FeatureKind.SIGNALS}),
    )
    fewest: ClassVar[int] = FEWEST_LIT

    face_normals: Normals
    response: Sharing = "common"
    level_spread: float = 0.05

    normals_: Floats = field(init=False, repr=False, compare=False)
    responses_: Floats = field(init=False, repr=False, compare=False)
    dark_: Floats = field(init=False, repr=False, compare=False)
    noise_: Floats = field(init=False, repr=False, compare=False)
    parameters_: tuple[Parameter, ...] = field(init=False, repr=False, compare=False)
    condition_: float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        require_normals(self.face_normals, self.about.name)
        require_positive(self.about.name, level_spread=self.level_spread)
        require_choice(self.about.name, Sharing, response=self.response)

    def columns(self) -> int:
        """One a face."""
        return len(self.face_normals)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Learn normals, gains and response of all faces together."""
        del context
        fit = FacesFit(
            np.asarray(self.face_normals, dtype=np.float64), features, sun, self.about.name
        ).solve(each=self.response == "each")
        self.normals_, self.responses_, self.dark_ = fit.normals, fit.responses, fit.dark
        # a noiseless calibration leaves rounding, which must not decide between faces
        least = 1e-9 * float(self.responses_.sum(axis=1).max())
        self.noise_ = np.maximum(fit.noise, least)
        self.parameters_, self.condition_ = fit.parameters, fit.condition

    def condition(self) -> float:
        """Give the condition of the equations."""
        return self.condition_

    def fitted_parameters(self) -> tuple[Parameter, ...]:
        """Gains, tilts and coefficients of the response, and the lamp's slopes."""
        return self.parameters_

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of signals (N, K)."""
        del context
        return self._solve(features)[0]

    def variance(self, features: Floats, context: Columns) -> Floats:
        """(N,) variance of a tangent axis that the residuals' size makes, rad^2."""
        del context
        return self._solve(features)[1]

    def _solve(self, signals: Floats) -> tuple[Floats, Floats]:
        """Directions (N, 3), and the mean variance (N,) of their two components across.

        Levenberg-Marquardt, every sample with a damping of its own.
        """
        light = signals - self.dark_
        vector = self._start(light)
        normal, right, cost = self._equations(vector, light)
        damping = np.full(len(light), _FIRST_DAMPING)
        moving = np.flatnonzero(np.isfinite(vector[:, 0]))
        for _ in range(ITERATIONS):
            if not len(moving):
                break
            here, equations, squares = vector[moving], normal[moving], cost[moving]
            size = damping[moving] * (equations[:, 0, 0] + equations[:, 1, 1] + equations[:, 2, 2])
            step = _solve3(equations + size[:, None, None] * np.eye(3), right[moving])
            tried = here + step
            found = self._equations(tried, light[moving])
            better = found[2] <= squares * (1.0 + _EQUAL)
            for kept, new in zip((vector, normal, right, cost), (tried, *found), strict=True):
                kept[moving[better]] = new[better]
            times = np.where(better, damping[moving] / 10.0, damping[moving] * 10.0)
            damping[moving] = np.clip(times, _LEAST_DAMPING, 1e6)
            small = (step**2).sum(axis=1) <= _AT_REST**2 * (here**2).sum(axis=1)
            moving = moving[~small]
        sun = normalise(vector)
        inverse = _inverse3(normal)
        along = np.zeros(len(sun))
        for i in range(3):
            for j in range(3):
                along += inverse[:, i, j] * sun[:, i] * sun[:, j]
        spread = inverse[:, 0, 0] + inverse[:, 1, 1] + inverse[:, 2, 2] - along
        variance = spread / 2.0 / (vector**2).sum(axis=1)
        known = (variance >= 0) & (variance <= _WORST_RAD**2)
        sun[~known] = np.nan
        return sun, np.where(known, variance, 0.0)

    def _start(self, light: Floats) -> Floats:
        """(N, 3) vectors that fit the lit faces' cosines; NaN where no face is lit.

        A component that no lit face tells of starts beside nothing, as the dark ones say.
        """
        normal, right = np.zeros((len(light), 3, 3)), np.zeros((len(light), 3))
        lit = np.zeros(len(light), dtype=np.bool_)
        for face, axis in enumerate(self.normals_):
            cosine = invert(light[:, face], self.responses_[face])
            seen = light[:, face] > 3.0 * self.noise_[face]
            lit |= seen
            weight = seen.astype(np.float64)
            _add_row(normal, right, [weight * component for component in axis], weight * cosine)
        start = _solve3(normal + _LEAST_START * np.eye(3), right)
        start += np.sqrt((start**2).sum(axis=1))[:, None] * np.array(_ASIDE)
        start[~lit] = np.nan
        return start

    def _equations(self, vector: Floats, light: Floats) -> tuple[Floats, Floats, Floats]:
        """Give normal equations (N, 3, 3), right sides (N, 3) and sum of squares at a vector.

        The vector's (N, 3) direction is the Sun's, its length the light's strength.
        """
        level = np.sqrt((vector**2).sum(axis=1))
        sun = vector / level[:, None]
        normal, right = np.zeros((len(light), 3, 3)), np.zeros((len(light), 3))
        cost = np.zeros(len(light))
        for face, axis in enumerate(self.normals_):
            cosine = sun[:, 0] * axis[0] + sun[:, 1] * axis[1] + sun[:, 2] * axis[2]
            value, slope = bend_and_slope(cosine, self.responses_[face], _BEND * self.noise_[face])
            residual = (light[:, face] - level * value) / self.noise_[face]
            # of level * f(n . v / level): f s + f' (n - c s)
            rows = [
                (value * sun[:, k] + slope * (axis[k] - cosine * sun[:, k])) / self.noise_[face]
                for k in range(3)
            ]
            _add_row(normal, right, rows, residual)
            cost += residual * residual
        rows = [sun[:, k] / self.level_spread for k in range(3)]
        residual = (1.0 - level) / self.level_spread
        _add_row(normal, right, rows, residual)
        return normal, right, cost + residual * residual


def bend_and_slope(cosine: Floats, coefficients: Floats, width: float) -> tuple[Floats, Floats]:
    """Response at cosines of incidence (N,), bent softly to nothing in the dark; its derivative.

    Behind the face the cubic goes on as a straight line, so that there is no jump; a value v
    becomes ``w log(1 + exp(v / w))`` of width w, in the signals' unit.
    """
    b0, b1, b2, b3 = coefficients
    front = np.maximum(cosine, 0.0)
    # a line that rises towards the front, whatever the fit says of grazing light
    rise = max(float(b1), 0.1 * float(coefficients.sum()))
    value = ((b3 * front + b2) * front + b1) * front + b0 + rise * (cosine - front)
    slope = np.where(cosine > 0, (3.0 * b3 * front + 2.0 * b2) * front + b1, rise)
    ratio = value / width
    decay = np.exp(-np.abs(ratio))
    share = np.where(ratio > 0, 1.0, decay) / (1.0 + decay)
    return width * (np.maximum(ratio, 0.0) + np.log1p(decay)), slope * share


def invert(signal: Floats, coefficients: Floats) -> Floats:
    """Cosines (N,) in [0, 1.2] at which a response gives signals (N,), by Newton's steps."""
    b0, b1, b2, b3 = coefficients
    cosine = np.clip(signal / coefficients.sum(), 0.0, 1.2)
    for _ in range(6):
        value = ((b3 * cosine + b2) * cosine + b1) * cosine + b0
        slope = np.maximum((3.0 * b3 * cosine + 2.0 * b2) * cosine + b1, 0.1 * b1)
        cosine = np.clip(cosine - (value - signal) / slope, 0.0, 1.2)
    return np.asarray(cosine)


def _add_row(normal: Floats, right: Floats, row: list[Floats], residual: Floats) -> None:
    """Add one equation a sample, derivatives `row` (3 of (N,)) and residual (N,), in place."""
    for i in range(3):
        right[:, i] += row[i] * residual
        for j in range(i, 3):
            normal[:, i, j] += row[i] * row[j]
            if j > i:
                normal[:, j, i] = normal[:, i, j]


def _inverse3(matrix: Floats) -> Floats:
    """Inverses (N, 3, 3) of symmetric matrices, element by element; NaN where singular."""
    a, b, c = matrix[:, 0, 0], matrix[:, 0, 1], matrix[:, 0, 2]
    d, e, f = matrix[:, 1, 1], matrix[:, 1, 2], matrix[:, 2, 2]
    first, second, third = d * f - e * e, c * e - b * f, b * e - c * d
    determinant = a * first + b * second + c * third
    inverse = np.empty_like(matrix)
    inverse[:, 0, 0], inverse[:, 0, 1], inverse[:, 0, 2] = first, second, third
    inverse[:, 1, 0], inverse[:, 1, 1], inverse[:, 1, 2] = second, a * f - c * c, b * c - a * e
    inverse[:, 2, 0], inverse[:, 2, 1], inverse[:, 2, 2] = third, b * c - a * e, a * d - b * b
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse /= determinant[:, None, None]
    inverse[~np.isfinite(determinant) | (determinant == 0)] = np.nan
    return inverse


def _solve3(matrix: Floats, right: Floats) -> Floats:
    """Solutions (N, 3) of symmetric equations."""
    inverse = _inverse3(matrix)
    return np.stack(
        [
            inverse[:, i, 0] * right[:, 0]
            + inverse[:, i, 1] * right[:, 1]
            + inverse[:, i, 2] * right[:, 2]
            for i in range(3)
        ],
        axis=1,
    )
