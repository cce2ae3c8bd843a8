"""`ccd-periodic`: two linear CCDs at right angles, a periodic reticle of 16 slits over each."""

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
from benchmark.simulator.masks.slits import periodic
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.sensors.lines import LineSensor

_HALF_FOV_DEG = 60.0
_SENSOR = LineSensor(
    camera=Camera(
        focal_length_mm=1.8,
        mask=periodic(16, 0.4, width_mm=0.2, length_mm=7.6, thickness_mm=0.01),
        sun=SUN,
        assembly=ASSEMBLED,
    ),
    detector=ccd(1024, 0.014),
    pixel_height_mm=0.2,
    errors=SLITS_ASSEMBLED,
)

PRESET = Preset(
    name="ccd-periodic",
    version=1,
    detector="CCD",
    mask="Multi-Slit",
    observation=Observation.PROFILES,
    units=units(_SENSOR),
    geometry=design(_SENSOR, _HALF_FOV_DEG),
    setups=conditions(_SENSOR, _HALF_FOV_DEG),
    directions=AngleField(_HALF_FOV_DEG),
    follows=("Tsuno2019", "Kondo2024"),
    description=(
        "A reticle of 16 equally spaced slits over a linear CCD (Tsuno2019, Kondo2024), "
        "once an axis. The taxonomy value is the one the survey files these studies under. "
        "Period and height are not given. Round numbers instead: slits of 0.2 mm at twice "
        "that period, 1.8 mm up, keep the Fresnel number above 10; 1024 pixels of 14 um "
        "hold the whole pattern at 60 deg, so its ends tell which slit is which and the "
        "phase needs no coarse sensor."
    ),
    regime=regime(_SENSOR),
)
