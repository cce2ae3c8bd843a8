"""The angular response of photodiodes, made the cosine that models ask for (ECM/Angular loss)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.compensated import CalibratedCompensation
from algorithms.contract import (
    AboutCompensation,
    FeatureKind,
    Floats,
    UnusableDataError,
)
from algorithms.documented import documented
from algorithms.models.geometric.detector_faces import Normals, require_normals
from algorithms.parameters import require_choice

Response = Literal["kelly", "fitted"]

KELLY = (-0.015, 0.750, 0.637, -0.369)
"""Coefficients of 1, c, c^2 and c^3 of the cosine of incidence (eq:kellycos)."""

FEWEST_LIT = 8
"""Samples that must light a face."""

SURELY_LIT = 0.1
"""Cosine by the drawing from which on a face's sample tells of its gain."""

_ROUNDS = 20


@documented
@dataclass
class AngularLoss(CalibratedCompensation):
    """Photodiode signals converted to cosines of incidence by the angular response.

    A photodiode reflects more at oblique incidence; its signal is a cubic of the cosine of
    incidence, times a gain. Both are inverted for models that assume a cosine.

    Parameters
    ----------
    response : {"kelly", "fitted"}
        The published cubic, or the one that fits the calibration best, the same for all faces.

    Attributes
    ----------
    gains_ : ndarray, shape (K,)
        Signal of each face at normal incidence.
    response_ : ndarray, shape (4,)
        Coefficients of 1, c, c^2 and c^3; ``f(1) = 1``.

    Notes
    -----
    Implements: eq:kellycos (model:nonlin, Yousefian2017): ``I_i = alpha_s I_0,i (-0.369 c^3 + 0.637
    c^2 + 0.750 c - 0.015) + eta_i``, solved for c; ``alpha_s I_0,i`` is learnt, a face each, by
    least squares over samples that light it. The printed cubic is 1.003 at c = 1, and 0 within 1.1
    degrees of grazing: darker signals give a cosine of 0. The survey has only the published cubic.

    Shapes: signals (N, K), in any common unit, to cosines (N, K) in [0, 1.2].

    Failure: a NaN row for a NaN feature row. fit raises UnusableDataError where fewer than 8
    samples light a face, or a lit face's signal is not positive. The normals of the drawing are
    used.

    Cost: 6 Newton's steps of 12 operations per face.

    Examples
    --------
    >>> import numpy as np
    >>> faces = ((0.6, 0.0, 0.8), (-0.6, 0.0, 0.8), (0.0, 0.6, 0.8), (0.0, -0.6, 0.8))
    >>> turns = np.radians(np.arange(0, 360, 30))
    >>> sun = np.column_stack([0.5 * np.cos(turns), 0.5 * np.sin(turns), np.full(12, 0.75**0.5)])
    >>> cosines = sun @ np.array(faces).T
    >>> signals = 3.0 * np.polyval(KELLY[::-1], cosines)
    >>> linear = AngularLoss(faces).fit(signals, sun)
    >>> float(np.abs(linear.transform(signals) - cosines).max().round(9))
    0.0
    """

    about: ClassVar = AboutCompensation(
        name="angular-loss",
        taxonomy="ECM/Angular loss",
        studies=("Yousefian2017",),
        labels=("model:nonlin", "eq:kellycos"),
        origin="survey",
        needs=("face_normals",),
        accepts=frozenset({FeatureKind.SIGNALS}),
        ahead_of=(
            "basic",
            "solar-panel",
            "pyramidal",
            "panoramic",
            "sun-and-albedo-inputs + basic",
            "sun-and-earth + basic",
            "computed-earth + basic",
        ),
    )
    frontal: ClassVar[bool] = False

    face_normals: Normals
    response: Response = "kelly"

    gains_: Floats = field(init=False, repr=False, compare=False)
    response_: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        require_normals(self.face_normals, self.about.name)
        require_choice(self.about.name, Response, response=self.response)

    def columns(self) -> int:
        """One a face."""
        return len(self.face_normals)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Learn every face's gain, and the response where it is to be fitted."""
        del context
        cosines = sun @ np.asarray(self.face_normals, dtype=np.float64).T
        lit = cosines > SURELY_LIT
        if lit.sum(axis=0).min() < FEWEST_LIT:
            face = int(lit.sum(axis=0).argmin())
            raise UnusableDataError(
                f"{self.about.name}: face {face + 1} is lit by {int(lit[:, face].sum())} "
                f"calibration samples; at least {FEWEST_LIT} must light it"
            )
        response = np.array(KELLY) / sum(KELLY)
        gains = self._gains(features, cosines, lit, response)
        if self.response == "fitted":
            powers = np.stack([cosines**k for k in range(4)], axis=-1)[lit]
            for _ in range(_ROUNDS):
                relative = (features / gains)[lit]
                fitted = np.asarray(np.linalg.lstsq(powers, relative, rcond=None)[0])
                response = np.asarray(fitted / fitted.sum(), dtype=np.float64)
                gains = self._gains(features, cosines, lit, response)
        self.gains_, self.response_ = gains, response

    def apply(self, features: Floats, context: Columns) -> Floats:
        """Cosines of incidence (N, K) of signals (N, K)."""
        from algorithms.models.physics_informed.faces_kernel import invert  # noqa: PLC0415 - Numba

        del context
        relative = features / self.gains_
        return np.column_stack([invert(column, self.response_) for column in relative.T])

    def _gains(
        self, features: Floats, cosines: Floats, lit: NDArray[np.bool_], response: Floats
    ) -> Floats:
        """Gain (K,) of each face by least squares over the samples that light it."""
        shape = np.where(lit, np.polyval(response[::-1], cosines), 0.0)
        gains = (features * shape).sum(axis=0) / (shape**2).sum(axis=0)
        if not (gains > 0).all():
            raise UnusableDataError(
                f"{self.about.name}: faces turned to the Sun must have positive signals; the "
                f"calibration gives a gain of {gains.min():.6g}"
            )
        return np.asarray(gains)
