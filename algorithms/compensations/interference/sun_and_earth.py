"""Sun and Earth as one sum, the Earth's part taken off (ICM/Albedo, summarised Sun and Earth)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.cube_currents import CubeCurrents
from algorithms.contract import AboutCompensation, FeatureKind, Floats
from algorithms.documented import documented
from algorithms.row_arithmetic import normalise

ITERATIONS = 8
"""Steps from the sum's direction to the Sun's; each leaves a fraction of the albedo's share."""


#: Cosine between a face and the nadir below which it sees next to nothing of the Earth.
_AWAY = 0.1


@documented
@dataclass
class SunAndEarth(CubeCurrents):
    """Differences of opposite faces minus the modelled light of the Earth.

    The Earth's light comes from about the nadir and grows with the lit part of the visible Earth;
    its strength is learnt from the calibration. The rest of the sum is sunlight.

    Attributes
    ----------
    albedo_ : float
        Length of the Earth's vector when it is seen full, in units of one Sun; 0 where the
        calibration shows none.

    Notes
    -----
    Implements: eq:albedo2 (model:albedo, Bhanderi2006): ``(I_+x - I_-x, I_+y - I_-y, I_+z -
    I_-z)`` is the sum of Sun and albedo vectors. The study compares it with a model's sum; here
    the model is one vector towards the nadir of length ``a ((1 - s . nadir) / 2)^2``, the share of
    the visible disc that is lit, squared for the low Sun on it (ours), and a is learnt.

    Shapes: signals (N, 6), in any common unit, to the same. Context: ``nadir`` (N, 3).

    Failure: a NaN row for a NaN feature row or nadir. fit raises UnusableDataError where no sample
    lights a face. Clouds and coasts are not in the model.

    Cost: 8 steps of 20 operations per sample.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.examples import face_signals
    >>> faces = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
    >>> sun, nadir = np.array([[0.6, 0.0, 0.8], [0.0, 0.6, 0.8]]), np.array([[0.0, 0.0, -1.0]] * 2)
    >>> seen = face_signals(sun, faces) + face_signals(0.2 * 0.9**2 * nadir, faces)
    >>> round(SunAndEarth(faces).fit(seen, sun, {"nadir": nadir}).albedo_, 2)
    0.2
    """

    about: ClassVar = AboutCompensation(
        name="sun-and-earth",
        taxonomy="ICM/Albedo",
        studies=("Bhanderi2006",),
        labels=("model:albedo", "eq:albedo2"),
        origin="survey",
        needs=("face_normals",),
        accepts=frozenset({FeatureKind.SIGNALS}),
        context=("nadir",),
        ahead_of=(
            "basic",
            "assembled-faces",
        ),
    )

    albedo_: float = field(init=False, repr=False, compare=False)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Learn every face's current in full sunlight, and the Earth's strength."""
        nadir = context["nadir"]
        # faces that look away from the Earth tell of the Sun alone
        away = nadir @ np.asarray(self.face_normals, dtype=np.float64).T < _AWAY
        self.one_sun_ = self.full_sunlight(features, sun, away)
        share = _share(sun, nadir)
        plus, minus = self.pairs(features)
        along = ((plus - minus - sun) * nadir).sum(axis=1)
        self.albedo_ = max(float((share * along).sum() / max((share**2).sum(), 1e-12)), 0.0)

    def apply(self, features: Floats, context: Columns) -> Floats:
        """Signals (N, 6) of the Sun alone."""
        nadir = context["nadir"]
        plus, minus = self.pairs(features)
        both = plus - minus
        sun = normalise(both)
        for _ in range(ITERATIONS):
            sun = normalise(both - (self.albedo_ * _share(sun, nadir))[:, None] * nadir)
        left = both - (self.albedo_ * _share(sun, nadir))[:, None] * nadir
        return self.lit_by(left)


def _share(sun: Floats, nadir: Floats) -> Floats:
    """Share (N,) of the Earth's light when it is seen full."""
    cosine = sun[:, 0] * nadir[:, 0] + sun[:, 1] * nadir[:, 1] + sun[:, 2] * nadir[:, 2]
    return np.asarray(((1.0 - cosine) / 2.0) ** 2)
