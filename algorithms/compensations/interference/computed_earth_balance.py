"""Light of the Earth through the opening of a quadrant detector, computed and taken off."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.compensated import CalibratedCompensation
from algorithms.calibration.ground_light import ground_light
from algorithms.contract import AboutCompensation, FeatureKind, Floats
from algorithms.documented import documented
from algorithms.parameters import require_positive
from algorithms.row_arithmetic import normalise

ITERATIONS = 3
"""Steps from the direction that all light has to the Sun's; each leaves a share of the Earth's."""
_ORDER = 5
"""Order of the polynomial of a balance, beside which the Earth's part is learnt."""


@documented
@dataclass
class ComputedEarthBalance(CalibratedCompensation):
    """Balances of quadrants without the light that a sunlit Earth sends through their opening.

    Light of every visible patch of the ground is projected through the square opening on the
    quadrants. The ground's reflectance is learnt from the calibration.

    Parameters
    ----------
    focal_length_mm : float
        Distance h from opening to detector, positive.
    aperture_width_mm : float
        Width w of the opening, positive.
    half_fov_deg : float
        Half field of view, below 90: so far off axis the whole image of the opening is on the
        detector, which says how large that is.
    altitude_km : float
        Height of the orbit, positive.

    Attributes
    ----------
    reflectance_ : float
        Share of sunlight that the ground sends back; 0 where the calibration shows none.

    Notes
    -----
    Implements: the model's sum that Bhanderi2006 compares eq:albedo2 with (model:albedo), behind an
    opening. Of light from a direction with tangents (p, q) the image of the opening covers
    ``[h p - w/2, h p + w/2]`` of the detector, and likewise in y; what lies on either side of the
    middle gives its balance b, what lies on the detector its share o. With the Sun's S, and the
    Earth's ``T = sum o E`` and ``B = sum o b E``, the balance read is ``(S b_sun + B)/(S + T)``,
    solved for b_sun.

    Shapes: balances (N, 2) to the same. Context: ``nadir`` (N, 3).

    Failure: a NaN row for a NaN feature row or nadir. Clouds, coasts and the gap between quadrants
    are not in the model.

    Cost: 3 passes over 192 patches per sample.

    Examples
    --------
    >>> import numpy as np
    >>> sun = np.array([[x, y, 1.0] for x in (-0.4, -0.1, 0.2, 0.5) for y in (-0.5, 0.0, 0.3, 0.6)])
    >>> sun /= np.linalg.norm(sun, axis=1, keepdims=True)
    >>> plain = np.tile([[0.0, 0.0, -1.0]], (16, 1))  # the Earth behind the sensor
    >>> balances = sun[:, :2] / sun[:, 2:]
    >>> clean = ComputedEarthBalance(1.0, 2.0, 40.0).fit(balances, sun, {"nadir": plain})
    >>> float(np.abs(clean.transform(balances, {"nadir": plain}) - balances).max().round(9))
    0.0
    """

    about: ClassVar = AboutCompensation(
        name="computed-earth-balance",
        taxonomy="ICM/Albedo",
        studies=(),
        labels=("model:albedo",),
        origin="ours",
        needs=("focal_length_mm", "aperture_width_mm", "half_fov_deg"),
        accepts=frozenset({FeatureKind.BALANCE}),
        context=("nadir",),
        ahead_of=("assembly-drift", "unscented-kalman"),
    )

    focal_length_mm: float
    aperture_width_mm: float
    half_fov_deg: float
    altitude_km: float = 600.0

    reflectance_: float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        require_positive(
            self.about.name,
            focal_length_mm=self.focal_length_mm,
            aperture_width_mm=self.aperture_width_mm,
            half_fov_deg=self.half_fov_deg,
            altitude_km=self.altitude_km,
        )
        if not self.half_fov_deg < 90:
            raise ValueError(
                f"{self.about.name}: half_fov_deg must be below 90; got {self.half_fov_deg}"
            )

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Least squares of balances: a polynomial of the Sun's tangents, and the Earth's part."""
        shift = self._shift(features, sun, context["nadir"])
        beta, alpha = sun[:, 0] / sun[:, 2], sun[:, 1] / sun[:, 2]
        terms = np.column_stack(
            [beta**i * alpha ** (n - i) for n in range(_ORDER + 1) for i in range(n + 1)]
        )
        # what a polynomial can take of either is no sign of the Earth
        left = [
            column - terms @ np.linalg.lstsq(terms, column, rcond=None)[0]
            for column in (features, shift)
        ]
        square = float((left[1] ** 2).sum())
        self.reflectance_ = max(float((left[0] * left[1]).sum()) / max(square, 1e-12), 0.0)

    def apply(self, features: Floats, context: Columns) -> Floats:
        """Balances (N, 2) of the Sun alone."""
        given = features.copy()
        half = self.aperture_width_mm / 2.0
        for _ in range(ITERATIONS):
            slopes = given * (half / self.focal_length_mm)
            sun = normalise(np.column_stack([slopes, np.ones(len(slopes))]))
            given = features - self.reflectance_ * self._shift(features, sun, context["nadir"])
        return given

    def _shift(self, features: Floats, sun: Floats, nadir: Floats) -> Floats:
        """(N, 2) how far a ground that sends all light back moves balances, of those read."""
        found = np.full(features.shape, np.nan)
        known = np.flatnonzero(np.isfinite(sun).all(axis=1) & np.isfinite(nadir).all(axis=1))
        for rows, directions, light in ground_light(sun[known], nadir[known], self.altitude_km):
            ahead = directions[:, :, 2] > 0
            depth = np.where(ahead, directions[:, :, 2], 1.0)
            sides = [self._sides(directions[:, :, axis] / depth) for axis in (0, 1)]
            shares = [minus + plus for minus, plus in sides]
            lit = np.where(ahead, light * depth, 0.0) * shares[0] * shares[1]
            whole = lit.sum(axis=1)
            at = known[rows]
            for axis, (minus, plus) in enumerate(sides):
                share = np.where(shares[axis] > 0, shares[axis], 1.0)
                moved = (lit * (plus - minus) / share).sum(axis=1)
                found[at, axis] = (moved - features[at, axis] * whole) / sun[at, 2]
        return found

    def _sides(self, slope: Floats) -> tuple[Floats, Floats]:
        """Shares of the opening's image on either side of the detector's middle, by a tangent."""
        half, height = self.aperture_width_mm / 2.0, self.focal_length_mm
        edge = half + height * math.tan(math.radians(self.half_fov_deg))
        low = np.clip(height * slope - half, -edge, edge)
        high = np.clip(height * slope + half, -edge, edge)
        minus = np.minimum(high, 0.0) - np.minimum(low, 0.0)
        plus = np.maximum(high, 0.0) - np.maximum(low, 0.0)
        return minus / (2.0 * half), plus / (2.0 * half)
