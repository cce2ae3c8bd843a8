"""Light of the Earth computed from the orbit's height, the nadir and the Sun, and taken off."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.compensated import CalibratedCompensation
from algorithms.calibration.cube_currents import SURELY_LIT
from algorithms.calibration.face_sunlight import KNOTS, LIT, sunlight
from algorithms.calibration.ground_light import ground_light
from algorithms.contract import AboutCompensation, FeatureKind, Floats, UnusableDataError
from algorithms.documented import documented
from algorithms.models.geometric.detector_faces import Normals, require_normals
from algorithms.parameters import require_positive
from algorithms.row_arithmetic import normalise

ITERATIONS = 4
"""Steps from the direction that all light has to the Sun's; each leaves a share of the Earth's."""

#: Weight of what is expected of a bend, none, against that of all samples.
_SMALL = 1e-2


@documented
@dataclass
class ComputedEarth(CalibratedCompensation):
    """Signals of faces minus the light that a uniform sunlit Earth sends to each.

    The light is integrated over the visible ground, lit by the Sun, for every face. How strongly a
    face answers to it is learnt from the calibration.

    Parameters
    ----------
    face_normals : tuple of K vectors
        Outward normals of the faces, in the order of the features; they must span space.
    altitude_km : float
        Height of the orbit, positive.

    Attributes
    ----------
    one_sun_ : ndarray, shape (K,)
        Signal of each face under perpendicular sunlight, in the features' unit.
    level_ : ndarray, shape (K,)
        Signal without light.
    response_ : ndarray, shape (9,)
        All faces' response at cosines of incidence of 0, 0.05, 0.1, 0.2, 0.3, 0.45, 0.6, 0.8 and 1,
        in units of the last; straight between them.
    reflectance_ : float
        Share of sunlight that the ground sends back; 0 where the calibration shows none.

    Notes
    -----
    Implements: the model's sum that Bhanderi2006 compares eq:albedo2 with (model:albedo), for a
    ground that reflects alike everywhere by Lambert's law:
    ``E_k = (a / pi) sum(w_j (g_j . s) r(v_j . n_k))`` over patches j that both the Sun and the face
    see: w_j their solid angle, g_j the normal of the ground that is seen along v_j, n_k that of the
    face, r its response, s the Sun. The Sun is found from the faces that it lights, by least
    squares, and E_k from that, in turn.

    Shapes: signals (N, K), in any common unit, to the same. Context: ``nadir`` (N, 3).

    Failure: a NaN row for a NaN feature row or nadir; a row without a face in sunlight stays as it
    is. A face that the calibration never lights takes the others' mean. fit raises
    UnusableDataError where no sample lights a face. Clouds and coasts are not in the model.

    Cost: 4 passes over 192 patches and K faces per sample.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.examples import face_signals
    >>> faces = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
    >>> sun, nadir = np.random.default_rng(1).standard_normal((2, 60, 3))
    >>> sun, nadir = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in (sun, nadir))
    >>> seen = face_signals(sun, faces) + 0.3 * earth_light(sun, nadir, faces, 600.0)
    >>> clean = ComputedEarth(faces).fit(seen, sun, {"nadir": nadir})
    >>> round(clean.reflectance_, 3)
    0.3
    >>> left = clean.transform(seen, {"nadir": nadir})
    >>> bool(np.abs(left - face_signals(sun, faces)).max() < 1e-3)
    True
    """

    about: ClassVar = AboutCompensation(
        name="computed-earth",
        taxonomy="ICM/Albedo",
        studies=(),
        labels=("model:albedo",),
        origin="ours",
        needs=("face_normals",),
        accepts=frozenset({FeatureKind.SIGNALS}),
        context=("nadir",),
        ahead_of=(
            "basic",
            "assembled-faces",
            "assembly-drift",
            "consider-kalman",
            "unscented-kalman",
        ),
    )
    frontal: ClassVar[bool] = False

    face_normals: Normals
    altitude_km: float = 600.0

    one_sun_: Floats = field(init=False, repr=False, compare=False)
    level_: Floats = field(init=False, repr=False, compare=False)
    response_: Floats = field(init=False, repr=False, compare=False)
    reflectance_: float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        require_normals(self.face_normals, self.about.name)
        require_positive(self.about.name, altitude_km=self.altitude_km)

    def columns(self) -> int:
        """One a face."""
        return len(self.face_normals)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Least squares for each face: a level, a response to the cosine, and the Earth's light.

        Twice: the Earth's light depends on the response that the first one finds.
        """
        normals = np.asarray(self.face_normals, dtype=np.float64)
        cosines = np.maximum(sun @ normals.T, 0.0)
        lit = np.flatnonzero((cosines > SURELY_LIT).any(axis=0))
        response, reflectance, one_sun = KNOTS, 0.0, np.zeros(0)
        for _ in range(2 if len(lit) else 0):
            earth = earth_light(sun, context["nadir"], normals, self.altitude_km, response)
            solved = np.array([_fitted(features[:, k], cosines[:, k], earth[:, k]) for k in lit])
            one_sun = solved[:, 1] + solved[:, -1]
            if not (one_sun > 0).all():
                break
            # one kind of face and one ground: what noise gives one of them is not the others'
            relative = solved / one_sun[:, None]
            reflectance = max(float(np.median(relative[:, 2])), 0.0)
            found = relative[:, 1:2] * KNOTS + np.pad(relative[:, 3:], ((0, 0), (1, 0)))
            rising = np.maximum.accumulate(np.median(found, axis=0))
            response = rising / rising[-1]
        if not (len(one_sun) and (one_sun > 0).all()):
            raise UnusableDataError(
                f"{self.about.name} needs samples that light its faces with positive signals"
            )
        self.response_, self.reflectance_ = response, reflectance
        # a face that was never lit is as the others are on average
        self.one_sun_ = np.full(len(normals), one_sun.mean())
        self.level_ = np.full(len(normals), solved[:, 0].mean())
        self.one_sun_[lit], self.level_[lit] = one_sun, solved[:, 0]

    def apply(self, features: Floats, context: Columns) -> Floats:
        """Signals (N, K) of the Sun alone."""
        normals = np.asarray(self.face_normals, dtype=np.float64)
        relative = (features - self.level_) / self.one_sun_
        sunlit = np.flatnonzero(relative.max(axis=1) > LIT)
        given, nadir = features.copy(), context["nadir"][sunlit]
        light = np.zeros((len(sunlit), len(normals)))
        for _ in range(ITERATIONS):
            sun = sunlight(relative[sunlit] - light, normals, self.response_)
            # what warms the faces, or brings them nearer to the Sun, changes all light alike
            level = np.sqrt((sun**2).sum(axis=1, keepdims=True))
            light = (self.reflectance_ * level) * earth_light(
                normalise(sun), nadir, normals, self.altitude_km, self.response_
            )
        given[sunlit] -= light * self.one_sun_
        return given


def _fitted(signals: Floats, cosine: Floats, earth: Floats) -> Floats:
    """Level, sunlight, Earth's light and the response's bends at all knots but the first, of (n,).

    A weak prior of zero holds bends that no sample determines.
    """
    bends = np.column_stack([np.interp(cosine, KNOTS, row) for row in np.eye(len(KNOTS))[1:]])
    matrix = np.column_stack([np.ones(len(cosine)), cosine, earth, bends])
    small = np.zeros((bends.shape[1], matrix.shape[1]))
    small[:, 3:] = _SMALL * math.sqrt(len(cosine)) * np.eye(bends.shape[1])
    right = np.concatenate([signals, np.zeros(len(small))])
    return np.asarray(np.linalg.lstsq(np.vstack([matrix, small]), right, rcond=None)[0])


def earth_light(
    sun: Floats,
    nadir: Floats,
    normals: ArrayLike,
    altitude_km: float,
    response: Floats | None = None,
) -> Floats:
    """Light (N, K) that faces get from a sunlit Earth that sends all of it back.

    Parameters
    ----------
    sun, nadir : ndarray, shape (N, 3)
        Unit vectors of the sensor's frame.
    normals : array_like, shape (K, 3)
        Of the faces.
    altitude_km : float
        Height of the orbit.
    response : ndarray, optional
        Of the faces at the cosines of `ComputedEarth.response_`; the cosine itself by default.

    Returns
    -------
    ndarray, shape (N, K)
        In units of perpendicular sunlight.
    """
    faces = np.asarray(normals, dtype=np.float64)
    out = np.empty((len(sun), len(faces)))
    for rows, directions, light in ground_light(sun, nadir, altitude_km):
        seen = np.maximum(directions @ faces.T, 0.0)
        if response is not None:
            seen = np.interp(seen, KNOTS, response)
        out[rows] = np.einsum("nj,njk->nk", light, seen)
    return out
