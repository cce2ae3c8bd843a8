"""C30: a mask that thickens upwards, and the shadowing model (Antonello2018).

The lower face stays where it is and the drawing's h counts to it, as in eq:shadcomp: light passes
the lower and the upper rim, and its middle moves out by half a thickness more. How much farther out
the balance places it, in the mean over the field, than under a foil is the shift. `shadow + spm` is
given thickness and aperture. The thickest mask is a tenth of the aperture: balances of a thicker
one saturate within the field. Of both sensors' correlations the mean is taken, of their ratios the
geometric mean.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from algorithms.chain import Chain, ChainModel
from algorithms.compensations.interference.shadow import MaskShadow
from algorithms.contract import Floats
from algorithms.extractors.currents.photodiode import VoltageBalance
from algorithms.models.geometric.standard_projection import StandardProjection
from benchmark.claims.benches import ConditionView, rank_correlation, ratio, rms
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.geometry.alterations import alter, sensor_of
from benchmark.datasets.preset import Preset
from benchmark.datasets.standard import pd_slit, qpd_single_aperture

#: Thickness over the aperture's width.
SHARES = (0.001, 0.01, 0.02, 0.03, 0.05, 0.075, 0.1)


def trial(number: int) -> Trial:
    """Measure one unit of both sensors with each mask."""
    lines, correlations, ratios = {}, [], []
    for module in (pd_slit, qpd_single_aperture):
        name = module.PRESET.name
        seen = [ConditionView(_thick(module.PRESET, share), unit=number) for share in SHARES]
        thin, bare, corrected = _places(seen[0]), [], []
        shifts = [float(np.nanmean(_outwards(_places(one), thin))) for one in seen]
        for one, share in zip(seen, SHARES, strict=True):
            bare.append(rms(one.errors(VoltageBalance, StandardProjection)))
            corrected.append(rms(one.errors(VoltageBalance, _shadow(module.PRESET, share))))
        correlations.append(rank_correlation(SHARES, shifts))
        ratios.append(ratio(bare[-1], corrected[-1]))
        lines[f"{name}, spm"] = (SHARES, bare)
        lines[f"{name}, shadow + spm"] = (SHARES, corrected)
    values = {"shifts": sum(correlations) / 2.0, "corrects": math.sqrt(math.prod(ratios))}
    return Trial(values, lines)


def _thick(preset: Preset, share: float) -> Preset:
    """Return the data set behind a mask so thick; its drawing's h is that of the lower face."""
    mask = sensor_of(preset).camera.mask
    thickness = share * mask.apertures[0].width_mm
    low = (preset.geometry.focal_length_mm or 0.0) - mask.thickness_mm / 2.0
    drawn = replace(preset.geometry, focal_length_mm=low)
    return alter(preset, partial(_thicker, low_mm=low, thickness_mm=thickness), drawn)


def _thicker(sensor: Any, low_mm: float, thickness_mm: float) -> Any:
    camera = sensor.camera
    mask = replace(camera.mask, thickness_mm=thickness_mm)
    middle = low_mm + thickness_mm / 2.0
    return replace(sensor, camera=replace(camera, mask=mask, focal_length_mm=middle))


def _shadow(preset: Preset, share: float) -> Any:
    """Return `shadow + spm`, which both count h from the lower face."""
    model = StandardProjection.for_sensor(
        _thick(preset, share).geometry_for("nominal"), VoltageBalance.about.kind
    )
    width = sensor_of(preset).camera.mask.apertures[0].width_mm
    shadow = MaskShadow(
        focal_length_mm=model.focal_length_mm,
        unit_mm=model.unit_mm,
        thickness_mm=share * width,
        aperture_mm=width,
    )
    return ChainModel(Chain((MaskShadow,), StandardProjection).about, (shadow,), model)


def _places(seen: ConditionView) -> Floats:
    """Places (N, 2) of the light by its balances, in balances."""
    return seen.features(VoltageBalance, "test")


def _outwards(places: Floats, thin: Floats) -> Floats:
    """How much farther out (N,) places are."""
    return np.asarray(((places - thin) * thin).sum(axis=1) / np.linalg.norm(thin, axis=1))
