"""Models: directions of a million features, and fits that choose their settings."""

from __future__ import annotations

from typing import Any

import numpy as np

from algorithms.angles import sun_from_angles
from algorithms.models.geometric.least_squares import LeastSquaresGeometry
from algorithms.models.geometric.standard_projection import StandardProjection
from algorithms.models.lut.blended_polynomials import BlendedPolynomials
from algorithms.models.lut.lookup_table import ErrorTable
from algorithms.models.non_physical.polynomial import AxisPolynomial, SurfacePolynomial

from .paired import at_most, ratio

_DESIGN: dict[str, Any] = {"focal_length_mm": 2.0, "unit_mm": 0.01, "centre": (100.0, 80.0)}
_MODELS = {
    "spm": lambda: StandardProjection(**_DESIGN),
    "lsq": lambda: LeastSquaresGeometry(**_DESIGN),
    "polynomial-1d": AxisPolynomial,
    "polynomial-2d": SurfacePolynomial,
    "lut": lambda: ErrorTable(**_DESIGN),
    "lut-polynomial": lambda: BlendedPolynomials(**_DESIGN),
}
#: Largest time over that of the features' arc tangents (3 where not said), which even an
#: uncalibrated pinhole must pay for; and of a fit over 200 QR factorisations of 441 poses by 66
#: terms, about a second.
_PREDICT, _FIT = {"lut": 10.0, "lut-polynomial": 10.0}, 5.0


class Models:
    """A pinhole bent a little, with noise, calibrated on a grid of 441 poses."""

    params = tuple(_MODELS)
    param_names = ("model",)

    def setup(self, name: str) -> None:
        axis = np.linspace(-50.0, 50.0, 21)
        self.sun = sun_from_angles(np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2))
        x = 200.0 * self.sun[:, :2] / self.sun[:, 2:]
        bent = x * (1.0 + 0.01 * (x**2).sum(axis=1, keepdims=True) / 200.0**2)
        noise = np.random.default_rng(1).normal(0.0, 0.02, bent.shape)
        self.features = bent + np.array([103.0, 80.0]) + noise

    def track_directions_over_arctan(self, name: str) -> float:
        model = _MODELS[name]().fit(self.features, self.sun)
        places = np.random.default_rng(2).integers(0, len(self.features), 1_000_000)
        asked = self.features[places]
        found = ratio(lambda: model.predict(asked), lambda: np.arctan(asked), repeats=7)
        return at_most(_PREDICT.get(name, 3.0), found)

    def track_fit_over_factorisations(self, name: str) -> float:
        design = np.random.default_rng(3).standard_normal((len(self.features), 66))
        model = _MODELS[name]()
        found = ratio(
            lambda: model.fit(self.features, self.sun),
            lambda: [np.linalg.qr(design) for _ in range(200)],
            repeats=5,
        )
        return at_most(_FIT, found)
