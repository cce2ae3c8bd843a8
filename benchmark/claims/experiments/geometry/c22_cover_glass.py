"""C22: whether refraction in the cover glass is undone by iteration (Wei2011).

A linear CCD behind an N of slits, as the study's. The same unit is seen with and without half a
millimetre of glass; `spm` reads both, `optical + spm` the spots under glass, given the drawn plate.
Iterations are counted of Newton's method on eq:refcomp3 from the paraxial ray, as the compensation
takes it, until the ray is within 1e-9 rad of its limit at every test spot.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from algorithms.chain import Chain
from algorithms.compensations.optics.refraction import Refraction
from algorithms.contract import Floats, SensorGeometry
from algorithms.extractors.profiles.centroid import ProfileThresholdedCentroid
from algorithms.models.geometric.standard_projection import StandardProjection
from benchmark.claims.benches import ConditionView, middles, ratio, rms, rms_within
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.geometry.alterations import alter
from benchmark.datasets.standard import ccd_n_slit
from benchmark.simulator.optics.plates import CoverGlass

OBLIQUE_DEG = 30.0
EDGES_DEG = (0.0, 10.0, 20.0, OBLIQUE_DEG, 40.0, 50.0, 60.0, 70.0)
_AT_REST_RAD = 1e-9
_MOST = 100


def trial(number: int) -> Trial:
    """Measure one unit with and without glass."""
    glazed = ccd_n_slit.PRESET
    bare = alter(glazed, _without_glass, replace(glazed.geometry, cover_glass=None))
    under, free = (ConditionView(one, unit=number) for one in (glazed, bare))
    incidence = under.incidence_deg()
    errors = (
        under.errors(ProfileThresholdedCentroid, StandardProjection),
        under.errors(ProfileThresholdedCentroid, Chain((Refraction,), StandardProjection)),
        free.errors(ProfileThresholdedCentroid, StandardProjection),
    )
    names = "spm under glass", "optical + spm under glass", "spm without glass"
    lines = {
        name: (middles(EDGES_DEG), rms_within(found, incidence, EDGES_DEG))
        for name, found in zip(names, errors, strict=True)
    }
    spots = under.features(ProfileThresholdedCentroid, "test")
    refracted, compensated, clear = errors
    oblique = incidence > OBLIQUE_DEG
    values = {
        "reduces": ratio(rms(refracted, oblique), rms(compensated, oblique)),
        "removes": ratio(rms(compensated), rms(clear)),
        "converges": float(_iterations(glazed.geometry, spots)),
    }
    return Trial(values, lines)


def _without_glass(sensor: Any) -> Any:
    return replace(sensor, camera=replace(sensor.camera, glass=CoverGlass()))


def _iterations(geometry: SensorGeometry, spots: Floats) -> int:
    """Newton's steps after which every ray stands within 1e-9 rad of where it ends."""
    ((thickness, index),) = geometry.cover_glass or ()
    gap = (geometry.focal_length_mm or 0.0) - thickness
    moved = (spots - np.asarray(geometry.centre_px)) * geometry.pixel_pitch_mm
    fallen = np.linalg.norm(moved[np.isfinite(moved).all(axis=1)], axis=1)
    tangent = fallen / (gap + thickness / index)
    angles = [np.arctan(tangent)]
    for _ in range(_MOST):
        root = np.sqrt(index**2 + (index**2 - 1.0) * tangent**2)
        place = gap * tangent + thickness * tangent / root
        tangent = tangent + (fallen - place) / (gap + thickness * index**2 / root**3)
        angles.append(np.arctan(tangent))
    off = [float(np.abs(angle - angles[-1]).max()) for angle in angles]
    return next(step for step, left in enumerate(off) if left <= _AT_REST_RAD)
