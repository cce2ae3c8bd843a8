"""C31: how the error falls with the number of slits whose light is averaged (Tsuno2019).

Behind 1, 2, 4, 8 and 16 slits of ccd-periodic's reticle, mounted without error, the phase of the
whole pattern is taken (`linear-phase`). The sentence is about independent slits: the error is that
which each pixel makes by itself, by its gain, dark signal and noise, and is counted from what the
same extractor finds in the profile of even pixels without noise. What all slits err by alike, as
oblique light does with this extractor, is in the plot's line of the whole error and in no
statistic. Every trial is another unit. The second method fits the exponent to the Cramer-Rao
bounds of the same profiles, unit known.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from algorithms.contract import Floats
from algorithms.extractors.profiles.linear_phase import LinearPhase
from benchmark.claims.benches import ConditionView, exponent, rms
from benchmark.claims.experiment import Sketch, Trial
from benchmark.claims.experiments.geometry.alterations import alter
from benchmark.datasets.conditions.line_arrays import design
from benchmark.datasets.preset import Preset
from benchmark.datasets.standard import ccd_periodic
from benchmark.simulator.masks.slits import SlitErrors, slit_row
from benchmark.simulator.optics.assembly import Assembly

SLITS = (1, 2, 4, 8, 16)
SKETCH = Sketch(log_x=True)
_BOUNDED = 60


def trial(number: int) -> Trial:
    """Measure one unit behind each number of slits."""
    found, whole, bounds = [], [], []
    for count in SLITS:
        preset = _with_slits(count)
        seen, unit = ConditionView(preset, unit=number), preset.for_unit(number)
        spots = seen.features(LinearPhase, "test")
        found.append(rms(spots - _without_noise(unit)))
        whole.append(rms(spots - _true_px(unit, seen.samples("test").sun)))
        bounds.append(_bound_px(unit))
    lines = {
        "error of independent pixels": (SLITS, found),
        "whole error": (SLITS, whole),
        "Cramer-Rao bound": (SLITS, bounds),
        "N to the -1/2": (SLITS, [found[0] * count**-0.5 for count in SLITS]),
    }
    exponents = ({"exponent": exponent(SLITS, errors)} for errors in (found, bounds))
    return Trial(next(exponents), lines, next(exponents))


def _with_slits(count: int) -> Preset:
    """Return ccd-periodic with its middle slits alone open, so many of them."""
    preset = ccd_periodic.PRESET
    built = _open_record(preset.condition("nominal").sensor, count)
    drawn = design(built, preset.geometry.half_fov_deg or 0.0)
    return alter(preset, partial(_open_record, count=count), drawn)


def _open_record(sensor: Any, count: int) -> Any:
    camera = sensor.camera
    slits, thickness = camera.mask.apertures, camera.mask.thickness_mm
    first = (len(slits) - count) // 2
    places = [slit.x_mm for slit in slits[first : first + count]]
    mask = slit_row(places, slits[0].width_mm, slits[0].height_mm, thickness)
    whole = replace(camera, mask=mask, assembly=Assembly())
    return replace(sensor, camera=whole, errors=SlitErrors())


def _scale_px(preset: Preset) -> float:
    """Pixels in one focal length."""
    geometry = preset.geometry_for("nominal")
    return (geometry.focal_length_mm or 0.0) / (geometry.pixel_pitch_mm or 1.0)


def _true_px(unit: Preset, sun: Floats) -> Floats:
    """(N, 2) where the drawing puts the spots, which is where they are."""
    middle = np.asarray(unit.geometry_for("nominal").centre_px)
    return np.asarray(middle + _scale_px(unit) * sun[:, :2] / sun[:, 2:])


def _without_noise(unit: Preset) -> Floats:
    """(N, 2) spots in the same light on even pixels, without noise."""
    pattern = dict(unit.fixed_pattern("nominal"))
    pattern["gain"] = np.ones_like(pattern["gain"])
    pattern["dark_e"] = np.full_like(pattern["dark_e"], pattern["dark_e"].mean())
    sensor: Any = unit.condition("nominal").sensor
    profiles = sensor.expected(unit.scene("nominal", "test"), pattern)
    return LinearPhase.for_sensor(unit.geometry_for("nominal")).extract(profiles)


def _bound_px(unit: Preset) -> float:
    """Root mean square of the bounds of both coordinates, px, at the first Suns of the split."""
    bound = unit.bound("nominal", n=_BOUNDED)
    # of a direction's projection angles: alpha along y, beta along x
    sun = unit.scene("nominal", "test", _BOUNDED).sun
    steepness = 1.0 + (sun[:, 1::-1] / sun[:, 2:]) ** 2
    angles = np.radians(np.column_stack([bound.alpha_deg, bound.beta_deg]))
    return rms((angles * steepness * _scale_px(unit))[bound.observable])
