"""Beyond the survey: faces whose direction is given where no other one explains them as well."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.contract import AboutModel, FeatureKind, Floats
from algorithms.documented import documented
from algorithms.models.physics_informed.assembled_faces import AssembledFaces
from algorithms.parameters import require_positive

#: Width of the bend between dark and lit over a face's noise, as of the directions' equations.
_BEND = 0.5
#: Directions nearer than so many deviations of a well lit face's reading are one.
_SAME = 6.0
#: Cosine of incidence up to which a face may be lit from the other side as well.
_GRAZING = 0.15


@documented
@dataclass
class SureFaces(AssembledFaces):
    """Assembly calibration of faces, without answers that a mirrored direction explains as well.

    A face answers grazing light with nothing. Where the Sun is in the plane of two faces back to
    back, both are dark, and it is open on which side of them the Sun is: least squares choose one,
    two degrees off in half of the cases. Such samples, one or two in a hundred of all directions
    around a cube, get no answer here.

    Parameters
    ----------
    margin : float
        By how much a mirrored direction must explain the signals worse, as a sum of squares over
        variances, positive.

    Notes
    -----
    Implements: nothing printed in the survey beyond `AssembledFaces` (model:assem), which finds the
    direction s. Each face of normal n that is nearly edge on, ``|n s| < 0.15``, mirrors it to ``s -
    2 (n s) n``. With chi^2 the sum of squares over faces, at the best strength of light for each,
    s is refused where ``chi^2(mirrored) < chi^2(s) + margin`` and they are farther apart than six
    deviations of a well lit face's reading tell.

    Shapes: signals (N, K), in any common unit, to unit vectors (N, 3).

    Failure: as of `AssembledFaces`, and a NaN row where the mirrored direction is as good.

    Cost: that of `AssembledFaces`, and 30 operations for each pair of faces and sample.

    Examples
    --------
    >>> from algorithms.examples import face_signals, sun_grid
    >>> normals = ((0.6, 0.0, 0.8), (-0.6, 0.0, 0.8), (0.0, 0.6, 0.8), (0.0, -0.6, 0.8))
    >>> sun = sun_grid(range(-30, 31, 10))
    >>> model = SureFaces(normals).fit(face_signals(sun, normals), sun)
    >>> model.predict(face_signals(sun[:1], normals)).round(3)
    array([[-0.447, -0.447,  0.775]])
    """

    about: ClassVar = AboutModel(
        name="sure-faces",
        taxonomy="None",
        origin="ours",
        needs=("face_normals",),
        accepts=frozenset({FeatureKind.SIGNALS}),
    )

    margin: float = 9.0

    def __post_init__(self) -> None:
        super().__post_init__()
        require_positive(self.about.name, margin=self.margin)

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of signals (N, K); NaN where another one is as likely."""
        sun = super().answer(features, context)
        light = features - self.dark_
        least = self._misfit(sun, light)
        # by one well lit face a direction is known so well
        usual = np.median(self.noise_ / self.responses_.sum(axis=1))
        for normal in self.normals_:
            cosine = sun @ normal
            mirrored = sun - 2.0 * cosine[:, None] * normal
            apart = 2.0 * np.abs(cosine) > _SAME * usual
            as_good = self._misfit(mirrored, light) < least + self.margin
            sun[(np.abs(cosine) < _GRAZING) & apart & as_good] = np.nan
        return sun

    def _misfit(self, sun: Floats, light: Floats) -> Floats:
        """Sum of squares (N,) over noise of signals (N, K) at the strength that fits best."""
        seen = self._response(sun @ self.normals_.T) / self.noise_
        scaled = light / self.noise_
        firm = 1.0 / self.level_spread**2
        level = ((seen * scaled).sum(axis=1) + firm) / ((seen * seen).sum(axis=1) + firm)
        left = scaled - level[:, None] * seen
        return np.asarray((left * left).sum(axis=1) + firm * (level - 1.0) ** 2)

    def _response(self, cosine: Floats) -> Floats:
        """Signals (N, K) at cosines of incidence (N, K), bent softly to nothing in the dark."""
        b0, b1, b2, b3 = self.responses_.T
        front = np.maximum(cosine, 0.0)
        rise = np.maximum(b1, 0.1 * (b0 + b1 + b2 + b3))
        value = ((b3 * front + b2) * front + b1) * front + b0 + rise * (cosine - front)
        width = _BEND * self.noise_
        return np.asarray(width * np.logaddexp(0.0, np.nan_to_num(value / width)))
