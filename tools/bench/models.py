"""Answers of models against bare arc tangents of the same features; fits that choose settings.

``python -m tools.bench.models``. A million features at once, as a catalogue of a mission's readings
would be; the reference is ``numpy.arctan`` of the same array, which even an uncalibrated pinhole
must pay for.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from functools import partial

import numpy as np

from algorithms.angles import sun_from_angles
from algorithms.contract import Floats, Model
from algorithms.models.geometric.least_squares import LeastSquaresGeometry
from algorithms.models.geometric.standard_projection import StandardProjection
from algorithms.models.lut.blended_polynomials import BlendedPolynomials
from algorithms.models.lut.lookup_table import ErrorTable
from algorithms.models.non_physical.polynomial import AxisPolynomial, SurfacePolynomial
from tools.bench.comparing import Subject, main
from tools.bench.comparing import run as compared
from tools.bench.verdicts import Verdict

FEATURES = 1_000_000
REPEATS = 7
DESIGN = {"focal_length_mm": 2.0, "unit_mm": 0.01, "centre": (100.0, 80.0)}

#: Largest time of an answer over that of the two arc tangents of its features.
PREDICT_LIMITS = {
    "spm": 3.0,
    "lsq": 3.0,
    "polynomial-1d": 3.0,
    "polynomial-2d": 3.0,
    "lut": 10.0,
    "lut-polynomial": 10.0,
}
#: Largest time of a fit that chooses its settings over that of 200 QR factorisations of a
#: calibration's 441 poses by 66 terms, about a second on one core.
FIT_LIMIT = 5.0
FACTORISATIONS = 200


def calibration(half_deg: float = 50.0, steps: int = 21) -> tuple[Floats, Floats]:
    """Features (n, 2) and Suns (n, 3) of a pinhole bent a little, with noise, on a grid."""
    axis = np.linspace(-half_deg, half_deg, steps)
    sun = sun_from_angles(np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2))
    x = 200.0 * sun[:, :2] / sun[:, 2:]
    bent = x * (1.0 + 0.01 * (x**2).sum(axis=1, keepdims=True) / 200.0**2)
    noise = np.random.default_rng(1).normal(0.0, 0.02, bent.shape)
    return bent + np.array([103.0, 80.0]) + noise, sun


def models() -> list[Model]:
    """Every model with a limit, unfitted."""
    return [
        StandardProjection(**DESIGN),
        LeastSquaresGeometry(**DESIGN),
        AxisPolynomial(),
        SurfacePolynomial(),
        ErrorTable(**DESIGN),
        BlendedPolynomials(**DESIGN),
    ]


def subjects() -> Sequence[Subject]:
    """Answers of every model to a million features within what it was calibrated on, and fits."""
    features, sun = calibration()
    places = np.random.default_rng(2).integers(0, len(features), FEATURES)
    asked = features[places]
    found = [
        Subject(
            name=f"{model.about.name}: directions of a million features",
            reference_name="numpy.arctan of them",
            call=partial(model.fit(features, sun).predict, asked),
            reference=partial(np.arctan, asked),
            items=FEATURES,
            reference_items=FEATURES,
            limit=PREDICT_LIMITS[model.about.name],
        )
        for model in models()
    ]
    design = np.random.default_rng(3).standard_normal((len(features), 66))

    def factorised() -> None:
        for _ in range(FACTORISATIONS):
            np.linalg.qr(design)

    found += [
        Subject(
            name=f"{model.about.name}: a fit that chooses its settings",
            reference_name=f"{FACTORISATIONS} QR factorisations of {design.shape}",
            call=partial(model.fit, features, sun),
            reference=factorised,
            items=1,
            reference_items=1,
            limit=FIT_LIMIT,
        )
        for model in models()
    ]
    return found


def run() -> list[Verdict]:
    """Measure all, print as it goes, and return the verdicts."""
    return compared(subjects(), REPEATS)


if __name__ == "__main__":
    sys.exit(main("tools.bench.models", subjects, REPEATS, sys.argv[1:]))
