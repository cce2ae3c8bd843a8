"""Light of a clouded Earth, estimated from all faces of each sample, and taken off."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np
from scipy.optimize import nnls

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.face_sunlight import KNOTS, LIT, seen_of, sunlight
from algorithms.calibration.ground_light import EARTH_RADIUS_KM, ground_light, ground_points
from algorithms.compensations.interference.computed_earth import ComputedEarth
from algorithms.contract import Floats
from algorithms.documented import documented
from algorithms.row_arithmetic import normalise

#: Distances, km, over which reflectances go together.
_LENGTHS_KM = np.array([250.0, 500.0, 1000.0, 2000.0, 8000.0])
#: Share of the largest mode of the field below which another is left out.
_FAINT = 1e-4
#: Times that the Earth is lit anew by the Sun found, and steps of least squares to that each time.
_PASSES, _STEPS = 4, 2
#: Regressions of the products of residuals, each but the first weighted by what the last explains.
_WEIGHINGS = 4
#: Variance (squared share of one Sun) below which no noise of a reading is taken to be.
_LEAST = 1e-12
#: Lower quartile of the square of a normal variable of variance one.
_QUARTILE = 0.1015
#: Prior information on each component of the sunlight, so that two lit faces do not leave one free.
_SMALL = 1e-3


@documented
@dataclass
class EstimatedEarth(ComputedEarth):
    """Signals of faces minus the Earth's light, whose reflectance every sample tells anew.

    Faces that look away from the Sun see the Earth alone, and how bright it is. Reflectances of
    the ground are estimated together with the Sun; how much and over which distances they vary is
    learnt from the calibration.

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
        Mean share of sunlight that the ground sends back.
    spread_ : ndarray, shape (5,)
        Standard deviation of reflectances that go together over 250, 500, 1000, 2000 and 8000 km.
    noise_ : ndarray, shape (2,)
        Standard deviation of a reading about its model, of faces away from the Sun and of lit ones,
        in units of one Sun.
    modes_ : ndarray, shape (192, M)
        The field's independent modes at the ground, by one standard deviation.

    Notes
    -----
    Implements: the sum of model:albedo over a ground whose reflectance is a Gaussian field, drawn
    anew for every sample: mean a, covariance ``sum(v_i exp(-d^2 / (2 l_i^2)))`` of places d apart.
    The variances v_i are those that explain the products of residuals over all pairs of faces best
    (non-negative least squares). Sun and field are their most probable values given all readings,
    by steps of Gauss and Newton.

    Shapes: signals (N, K), in any common unit, to the same. Context: ``nadir`` (N, 3).

    Failure: a NaN row for a NaN feature row or nadir; a row without a face in sunlight stays as it
    is. fit raises UnusableDataError where no sample lights a face. Where every face that sees the
    Earth sees the Sun too, the mean reflectance is what is left.

    Cost: 4 passes over 192 patches and K faces, and 8 inversions of K by K, per sample.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.compensations.interference.computed_earth import earth_light
    >>> from algorithms.examples import face_signals
    >>> faces = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
    >>> generator = np.random.default_rng(1)
    >>> sun, nadir = generator.standard_normal((2, 60, 3))
    >>> sun, nadir = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in (sun, nadir))
    >>> clouded = generator.uniform(0.2, 0.4, (60, 1))
    >>> seen = face_signals(sun, faces) + clouded * earth_light(sun, nadir, faces, 600.0)
    >>> clean = EstimatedEarth(faces).fit(seen, sun, {"nadir": nadir})
    >>> left = clean.transform(seen, {"nadir": nadir}) - face_signals(sun, faces)
    >>> float(np.sqrt(np.mean(left**2)).round(3))
    0.002
    """

    about: ClassVar = replace(ComputedEarth.about, name="estimated-earth")

    spread_: Floats = field(init=False, repr=False, compare=False)
    noise_: Floats = field(init=False, repr=False, compare=False)
    modes_: Floats = field(init=False, repr=False, compare=False)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """As of a uniform ground, then the variances that explain what is left."""
        super().learn(features, sun, context)
        normals = np.asarray(self.face_normals, dtype=np.float64)
        ground = EARTH_RADIUS_KM * ground_points(self.altitude_km)
        apart = ((ground[:, None] - ground) ** 2).sum(axis=2)
        fields = np.exp(-apart / (2.0 * _LENGTHS_KM[:, None, None] ** 2))
        direct, slope = seen_of(sun, normals, self.response_)
        parts = self._parts(sun, context["nadir"], normals, np.eye(len(ground)))
        left = (features - self.level_) / self.one_sun_ - direct
        left -= self.reflectance_ * parts.sum(axis=2)
        # expected product of two faces' residuals, for a unit of each variance
        by = [parts @ one @ np.swapaxes(parts, 1, 2) for one in fields]
        by += [((slope[:, :, None] > 0) == lit) * np.eye(len(normals)) for lit in (False, True)]
        terms, products = np.stack(by, axis=-1), left[:, :, None] * left[:, None, :]
        # a first regression may leave no noise; its weights would count nothing but dark readings
        quiet = np.full(left.shape, _LEAST)
        for seen in (slope > 0, slope <= 0):
            if seen.any():
                quiet[seen] += np.quantile(left[seen] ** 2, 0.25) / _QUARTILE
        deviation, found = np.ones(left.shape), np.zeros(len(by))
        for _ in range(_WEIGHINGS):
            weight = 1.0 / (deviation[:, :, None] * deviation[:, None, :])
            matrix = (terms * weight[..., None]).reshape(-1, len(by))
            scale = np.where(matrix.any(axis=0), np.abs(matrix).max(axis=0), 1.0)
            found = nnls(matrix / scale, (products * weight).ravel())[0] / scale
            variance = np.einsum("nkkm,m->nk", terms, found)
            deviation = np.sqrt(np.maximum(variance, quiet))
        self.spread_ = np.sqrt(found[:-2])
        self.noise_ = np.sqrt(np.maximum(found[-2:], _LEAST))
        values, modes = np.linalg.eigh(np.tensordot(found[:-2], fields, axes=1))
        kept = values > _FAINT * values[-1]
        self.modes_ = modes[:, kept] * np.sqrt(values[kept])

    def apply(self, features: Floats, context: Columns) -> Floats:
        """Signals (N, K) of the Sun alone."""
        normals = np.asarray(self.face_normals, dtype=np.float64)
        relative = (features - self.level_) / self.one_sun_
        sunlit = np.flatnonzero(relative.max(axis=1) > LIT)
        given, nadir, read = features.copy(), context["nadir"][sunlit], relative[sunlit]
        terms = np.column_stack([np.ones(len(self.modes_)), self.modes_])
        uniform = (super().apply(features, context)[sunlit] - self.level_) / self.one_sun_
        sun, light = sunlight(uniform, normals, self.response_), np.zeros_like(read)
        for _ in range(_PASSES):
            # what warms the faces, or brings them nearer to the Sun, changes all light alike
            level = np.sqrt((sun**2).sum(axis=1))
            parts = level[:, None, None] * self._parts(normalise(sun), nadir, normals, terms)
            mean = self.reflectance_ * parts[:, :, 0]
            clouds = parts[:, :, 1:] @ np.swapaxes(parts[:, :, 1:], 1, 2)
            _, slope = seen_of(sun, normals, self.response_)
            noise = self.noise_[(slope > 0).astype(np.intp)] ** 2
            weight = np.linalg.inv(clouds + noise[:, :, None] * np.eye(len(normals)))
            for _ in range(_STEPS):
                direct, slope = seen_of(sun, normals, self.response_)
                turned = np.swapaxes(slope[:, :, None] * normals, 1, 2) @ weight
                matrix = turned @ (slope[:, :, None] * normals) + _SMALL * np.eye(3)
                step = turned @ (read - mean - direct)[:, :, None]
                sun = sun + np.linalg.solve(matrix, step)[:, :, 0]
            left = read - mean - seen_of(sun, normals, self.response_)[0]
            light = mean + (clouds @ weight @ left[:, :, None])[:, :, 0]
        given[sunlit] -= light * self.one_sun_
        return given

    def _parts(self, sun: Floats, nadir: Floats, normals: Floats, terms: Floats) -> Floats:
        """(N, K, M) light on faces, by reflectances of the ground that are the M columns."""
        out = np.empty((len(sun), len(normals), terms.shape[1]))
        for rows, directions, light in ground_light(sun, nadir, self.altitude_km):
            seen = np.interp(np.maximum(directions @ normals.T, 0.0), KNOTS, self.response_)
            out[rows] = np.swapaxes(light[:, :, None] * seen, 1, 2) @ terms
        return out
