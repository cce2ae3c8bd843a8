"""`ccd-multi-slit`: one linear CCD behind two pairs of slits at right angles to each other."""

from __future__ import annotations

from algorithms.contract import Observation
from benchmark.datasets.conditions.line_arrays import (
    ASSEMBLED,
    SLITS_ASSEMBLED,
    SUN,
    ccd,
    conditions,
    design,
    regime,
    units,
)
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Preset
from benchmark.simulator.masks.slits import crossed_pairs
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.sensors.lines import LineSensor

_HALF_FOV_DEG = 60.0
_SENSOR = LineSensor(
    camera=Camera(
        focal_length_mm=1.8,
        mask=crossed_pairs(4.6, (0.7, 0.9), width_mm=0.2, length_mm=7.7, thickness_mm=0.01),
        sun=SUN,
        assembly=ASSEMBLED,
    ),
    detector=ccd(2048, 0.014),
    pixel_height_mm=0.2,
    axes=("x",),
    errors=SLITS_ASSEMBLED,
)

PRESET = Preset(
    name="ccd-multi-slit",
    version=1,
    detector="CCD",
    mask="Multi-Slit",
    observation=Observation.PROFILES,
    units=units(_SENSOR),
    geometry=design(_SENSOR, _HALF_FOV_DEG),
    setups=conditions(_SENSOR, _HALF_FOV_DEG),
    directions=AngleField(_HALF_FOV_DEG),
    follows=("Enright2007a", "Enright2006b", "Enright2007b", "Enright2008b", "Radan2019"),
    description=(
        "Two pairs of narrow slits at right angles to each other over one linear CCD, as "
        "the studies of the peak position estimate describe: the peaks of one pair move "
        "with tan(beta) - tan(alpha), those of the other with tan(beta) + tan(alpha), both "
        "at 45 deg to the array. No dimensions are given. Round numbers instead: slits of "
        "0.2 mm 1.8 mm up keep the Fresnel number above 10; spacings of 0.7 and 0.9 mm tell "
        "the pairs apart; 9.2 mm between the pairs keep their slits from crossing in the "
        "mask, and so their peaks from overlapping anywhere in the field (image type 0 of "
        "alg:PPE); 2048 pixels of 14 um hold them."
    ),
    regime=regime(_SENSOR),
)
