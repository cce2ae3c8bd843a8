"""C13: one slit against five, by incidence (Bolshakov2020).

The data set with five slits in a row is pda-multi-slit, which follows the study (ccd-multi-slit has
two crossed pairs and no middle slit). Its five slits are calibrated by `multi-slit`, the study's
model; the same sensor with all slits but the middle one closed by `slit`, as `multi-slit` needs
several. One extractor reads both. All that differs is the mask.

The data set's slits stand whole pixels apart, so that all five spots fall alike on their pixels.
The plot, and no statistic, shows five slits beside it that do not.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from algorithms.extractors.profiles.eigen_analysis import EigenAnalysis
from algorithms.models.geometric.multi_slit import MultiSlit
from algorithms.models.geometric.single_slit import DeflectedSlits
from benchmark.claims.benches import ConditionView, middles, ratio, rms, rms_within
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.geometry.alterations import alter
from benchmark.datasets.conditions.line_arrays import design
from benchmark.datasets.preset import Preset
from benchmark.datasets.standard import pda_multi_slit
from benchmark.simulator.masks.slits import slit_row, without

LOW_DEG, HIGH_DEG = 15.0, 45.0
EDGES_DEG = (0.0, LOW_DEG, 25.0, 35.0, HIGH_DEG, 55.0, 70.0)
#: Places like the data set's, a fifth of a pixel of 0.05 mm apart from whole ones.
_UNEVEN_MM = (-1.11, -0.58, 0.0, 0.72, 1.54)


def trial(number: int) -> Trial:
    """Measure one unit with both masks."""
    many, one, uneven = (
        ConditionView(preset, unit=number)
        for preset in (pda_multi_slit.PRESET, _behind(_close), _behind(_unevenly_spaced))
    )
    incidence = many.incidence_deg()
    single = one.errors(EigenAnalysis, DeflectedSlits)
    five = many.errors(EigenAnalysis, MultiSlit)
    low, high = (
        ratio(rms(single, where), rms(five, where))
        for where in (incidence < LOW_DEG, incidence > HIGH_DEG)
    )
    found = {
        "middle slit alone": single,
        "five slits": five,
        "five slits, not whole pixels apart": uneven.errors(EigenAnalysis, MultiSlit),
    }
    lines = {
        name: (middles(EDGES_DEG), rms_within(errors, incidence, EDGES_DEG))
        for name, errors in found.items()
    }
    return Trial({"reduces": ratio(rms(single), rms(five)), "low": ratio(low, high)}, lines)


def _behind(change: Callable[[Any], Any]) -> Preset:
    """Return the data set behind another mask, which its drawing shows."""
    preset = pda_multi_slit.PRESET
    built = change(preset.condition("nominal").sensor)
    return alter(preset, change, design(built, preset.geometry.half_fov_deg or 0.0))


def _close(sensor: Any) -> Any:
    """Return the sensor with its auxiliary slits closed."""
    camera = sensor.camera
    auxiliary = [n for n, slit in enumerate(camera.mask.apertures) if slit.x_mm != 0.0]
    return replace(sensor, camera=replace(camera, mask=without(camera.mask, auxiliary)))


def _unevenly_spaced(sensor: Any) -> Any:
    camera = sensor.camera
    (first, *_), thickness = camera.mask.apertures, camera.mask.thickness_mm
    mask = slit_row(_UNEVEN_MM, first.width_mm, first.height_mm, thickness)
    return replace(sensor, camera=replace(camera, mask=mask))
