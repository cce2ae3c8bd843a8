"""C29: the same Earth before a digital sensor and before an analog one (Xie2013).

The pinhole camera on CMOS with its thresholded centroid, and the photodiode cube by least squares
over its calibrated faces, each calibrated on the ground, given the true directions, and tested with
and without the sunlit Earth in view. What albedo adds is ``sqrt(rms_with^2 - rms_without^2)``, 0
where it is no larger.
"""

from __future__ import annotations

import math

from algorithms.extractors.currents.photodiode import DirectSignals
from algorithms.extractors.frames.centroid import ThresholdedCentroid
from algorithms.models.non_physical.polynomial import SurfacePolynomial
from algorithms.models.physics_informed.assembled_faces import AssembledFaces
from benchmark.claims.benches import ConditionView, ratio, rms
from benchmark.claims.experiment import Trial
from benchmark.claims.truth import with_true_directions
from benchmark.datasets.preset import Preset
from benchmark.datasets.standard import cmos_single_aperture_pinhole, pd_maskless_cube

#: Less than this cannot be distinguished from nothing, deg: the least that a test of 400 samples
#: resolves.
_LEAST_DEG = 1e-6


def trial(number: int) -> Trial:
    """Measure one unit of both."""
    digital = _errors(cmos_single_aperture_pinhole.PRESET, number, digital=True)
    analog = _errors(pd_maskless_cube.PRESET, number, digital=False)
    values = {
        "immune": ratio(max(_add(*digital), _LEAST_DEG), _add(*analog)),
        "digital": ratio(digital[1], digital[0]),
    }
    places = ("CMOS pinhole", "photodiode cube")
    lines = {
        "black Earth": (places, [digital[0], analog[0]]),
        "sunlit Earth": (places, [digital[1], analog[1]]),
    }
    return Trial(values, lines)


def _errors(preset: Preset, number: int, *, digital: bool) -> tuple[float, float]:
    extractor = ThresholdedCentroid if digital else DirectSignals
    model = SurfacePolynomial if digital else AssembledFaces
    bare, earth = (
        ConditionView(with_true_directions(preset), condition, number)
        for condition in ("nominal", "albedo")
    )
    calibrated = bare.calibrate(extractor, model)
    return rms(bare.errors_of(calibrated, extractor)), rms(earth.errors_of(calibrated, extractor))


def _add(without: float, with_albedo: float) -> float:
    return math.sqrt(max(with_albedo**2 - without**2, 0.0))
