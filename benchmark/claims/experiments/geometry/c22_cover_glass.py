"""C22: whether refraction in the cover glass is undone by iteration (Wei2011).

The same unit is seen with and without half a millimetre of glass; `spm` reads both, `optical + spm`
the spots under glass, given the drawn plate. Iterations are counted of Newton's method on
eq:refcomp3 from the paraxial ray, as the compensation takes it, until the ray is within 1e-9 rad
of its limit at every test spot. The second method casts each ray through the plate by Snell's law
in closed form, onto the detector of the same unit, without pixels and noise; and finds it again
by bisection.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from algorithms.angles import sun_from_tangents
from algorithms.chain import Chain
from algorithms.compensations.optics.refraction import Refraction
from algorithms.contract import Floats
from algorithms.extractors.frames.centroid import ThresholdedCentroid
from algorithms.models.geometric.standard_projection import StandardProjection
from benchmark.claims.benches import ConditionView, middles, ratio, rms, rms_within, separation
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.geometry.alterations import alter, sensor_of
from benchmark.datasets.standard import cmos_single_aperture

OBLIQUE_DEG = 30.0
EDGES_DEG = (0.0, 10.0, 20.0, OBLIQUE_DEG, 40.0, 50.0, 60.0, 70.0)
_AT_REST_RAD = 1e-9
_MOST = 100


def trial(number: int) -> Trial:
    """Measure one unit with and without glass."""
    bare = cmos_single_aperture.PRESET
    glazed = alter(bare, _same, _drawn_glass(), "glass")
    under, free = ConditionView(glazed, "glass", number), ConditionView(bare, unit=number)
    incidence = under.incidence_deg()
    errors = (
        under.errors(ThresholdedCentroid, StandardProjection),
        under.errors(ThresholdedCentroid, Chain((Refraction,), StandardProjection)),
        free.errors(ThresholdedCentroid, StandardProjection),
    )
    names = "spm under glass", "optical + spm under glass", "spm without glass"
    lines = {
        name: (middles(EDGES_DEG), rms_within(found, incidence, EDGES_DEG))
        for name, found in zip(names, errors, strict=True)
    }
    spots = under.features(ThresholdedCentroid, "test")
    values = {**_statistics(errors, incidence), "converges": float(_iterations(glazed, spots))}
    sun = under.samples("test").sun
    return Trial(values, lines, _statistics(_ray_by_ray(number, sun), incidence))


def _statistics(errors: tuple[Floats, ...], incidence: Floats) -> dict[str, float]:
    under, compensated, free = errors
    oblique = incidence > OBLIQUE_DEG
    reduces = ratio(rms(under, oblique), rms(compensated, oblique))
    return {"reduces": reduces, "removes": ratio(rms(compensated), rms(free))}


def _same(sensor: Any) -> Any:
    return sensor


def _drawn_glass() -> Any:
    """Return the drawing with the plate in it, which the condition's own leaves out."""
    plates = sensor_of(cmos_single_aperture.PRESET, condition="glass").camera.glass.plates
    drawn = tuple((plate.thickness_mm, plate.index) for plate in plates)
    return replace(cmos_single_aperture.PRESET.geometry, cover_glass=drawn)


def _iterations(preset: Any, spots: Floats) -> int:
    """Newton's steps after which every ray stands within 1e-9 rad of where it ends."""
    geometry = preset.geometry_for("glass")
    ((thickness, index),) = geometry.cover_glass
    gap = geometry.focal_length_mm - thickness
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


def _ray_by_ray(unit: int, sun: Floats) -> tuple[Floats, ...]:
    """Errors (N,) of the three, of rays in closed form."""
    camera = sensor_of(cmos_single_aperture.PRESET, unit, "glass").camera
    (plate,) = camera.glass.plates
    thickness, index = plate.thickness_mm, plate.index
    head = camera.assembly.to_head(sun)
    incidence = np.arccos(head[:, 2])
    out = head[:, :2] / np.linalg.norm(head[:, :2], axis=1, keepdims=True)
    offset = np.array([camera.assembly.offset_x_mm, camera.assembly.offset_y_mm])
    height, drawn = camera.height_mm, camera.focal_length_mm

    def falls(angle: Floats, high: float) -> Floats:
        within = np.arcsin(np.sin(angle) / index)
        return np.asarray((high - thickness) * np.tan(angle) + thickness * np.tan(within))

    under = out * falls(incidence, height)[:, None] + offset
    free = out * (height * np.tan(incidence))[:, None] + offset
    fallen = np.linalg.norm(under, axis=1)
    low, high = np.zeros(len(sun)), np.full(len(sun), np.pi / 2.0)
    for _ in range(60):
        middle = (low + high) / 2.0
        short = falls(middle, drawn) < fallen
        low, high = np.where(short, middle, low), np.where(short, high, middle)
    straight = under / fallen[:, None] * (drawn * np.tan(low))[:, None]
    said = (sun_from_tangents(spot[:, ::-1] / drawn) for spot in (under, straight, free))
    return tuple(separation(one, sun) for one in said)
