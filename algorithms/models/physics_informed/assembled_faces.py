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
        """Directions (N, 3), and the mean variance (N,) of their two components across."""
        from algorithms.models.physics_informed.faces_kernel import explain  # noqa: PLC0415 - Numba

        light = np.ascontiguousarray(signals - self.dark_)
        vector, normal = np.empty((len(light), 3)), np.empty((len(light), 3, 3))
        told = (self.normals_, self.responses_, self.noise_, float(self.level_spread))
        explain(light, told, vector, normal)
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
