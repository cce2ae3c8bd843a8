"""C30: a mask that thickens upwards, and the shadowing model (Antonello2018).

A CMOS array behind one round hole. The lower face stays where it is and the drawing's h counts to
it, as in eq:shadcomp: light passes the lower and the upper rim, and its middle moves out by half a
thickness more. How much farther out the centroid places it, in the mean over the field, than under
a foil is the shift. `shadow + spm` is given thickness and diameter. The thickest mask is half as
thick as its hole is wide, as the data set's.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from algorithms.chain import Chain, ChainModel
from algorithms.compensations.interference.shadow import MaskShadow
from algorithms.contract import Floats
from algorithms.extractors.frames.centroid import ThresholdedCentroid
from algorithms.models.geometric.standard_projection import StandardProjection
from benchmark.claims.benches import ConditionView, rank_correlation, ratio, rms
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.geometry.alterations import alter, sensor_of
from benchmark.datasets.preset import Preset
from benchmark.datasets.standard.cmos_single_aperture_thick import PRESET

#: Thickness over the hole's diameter.
SHARES = (0.001, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5)
_HOLE_MM = sensor_of(PRESET).camera.mask.apertures[0].width_mm
#: Of the mask's lower face, by the drawing.
_LOW_MM = (PRESET.geometry.focal_length_mm or 0.0) - sensor_of(PRESET).camera.mask.thickness_mm / 2


def trial(number: int) -> Trial:
    """Measure one unit with each mask."""
    seen = [ConditionView(_thick(share), unit=number) for share in SHARES]
    thin, bare, corrected = _places(seen[0]), [], []
    shifts = [float(np.nanmean(_outwards(_places(one), thin))) for one in seen]
    for one, share in zip(seen, SHARES, strict=True):
        bare.append(rms(one.errors(ThresholdedCentroid, StandardProjection)))
        corrected.append(rms(one.errors(ThresholdedCentroid, _shadow(share))))
    return Trial(
        {"shifts": rank_correlation(SHARES, shifts), "corrects": ratio(bare[-1], corrected[-1])},
        {"spm": (SHARES, bare), "shadow + spm": (SHARES, corrected)},
    )


def _thick(share: float) -> Preset:
    """Return the data set behind a mask so thick; its drawing's h is that of the lower face."""
    thickness = share * _HOLE_MM
    drawn = replace(PRESET.geometry, focal_length_mm=_LOW_MM, mask_thickness_mm=thickness)
    return alter(PRESET, partial(_thicker, thickness_mm=thickness), drawn)


def _thicker(sensor: Any, thickness_mm: float) -> Any:
    camera = sensor.camera
    mask = replace(camera.mask, thickness_mm=thickness_mm)
    middle = _LOW_MM + thickness_mm / 2.0
    return replace(sensor, camera=replace(camera, mask=mask, focal_length_mm=middle))


def _shadow(share: float) -> Any:
    """Return `shadow + spm`, which both count h from the lower face."""
    drawn = _thick(share).geometry_for("nominal")
    model = StandardProjection.for_sensor(drawn, ThresholdedCentroid.about.kind)
    shadow = MaskShadow(
        focal_length_mm=model.focal_length_mm,
        unit_mm=model.unit_mm,
        centre=model.centre,
        thickness_mm=share * _HOLE_MM,
        aperture_mm=_HOLE_MM,
    )
    return ChainModel(Chain((MaskShadow,), StandardProjection).about, (shadow,), model)


def _places(seen: ConditionView) -> Floats:
    """Places (N, 2) of the spots from the drawing's centre, px."""
    centre = np.asarray(PRESET.geometry.centre_px)
    return np.asarray(seen.features(ThresholdedCentroid, "test") - centre)


def _outwards(places: Floats, thin: Floats) -> Floats:
    """How much farther out (N,) places are."""
    return np.asarray(((places - thin) * thin).sum(axis=1) / np.linalg.norm(thin, axis=1))
