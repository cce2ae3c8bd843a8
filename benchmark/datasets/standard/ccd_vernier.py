"""`ccd-vernier`: two linear CCDs at right angles as fixed rulers of an optical vernier."""

from __future__ import annotations

from algorithms.contract import Observation
from benchmark.datasets.conditions.line_arrays import (
    ASSEMBLED,
    SLITS_ASSEMBLED,
    ccd,
    conditions,
    design,
    regime,
    units,
)
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Preset
from benchmark.simulator.masks.slits import periodic, without
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.sensors.lines import LineSensor

_HALF_FOV_DEG = 64.0
_SENSOR = LineSensor(
    camera=Camera(
        focal_length_mm=1.0,
        mask=without(periodic(16, 0.32, width_mm=0.15, length_mm=5.4, thickness_mm=0.01), (2, 11)),
        assembly=ASSEMBLED,
    ),
    detector=ccd(104, 0.1),
    pixel_height_mm=0.2,
    fill_factor=0.9,
    errors=SLITS_ASSEMBLED,
)

PRESET = Preset(
    name="ccd-vernier",
    version=1,
    detector="CCD",
    mask="Encoded",
    observation=Observation.PROFILES,
    units=units(_SENSOR),
    geometry=design(_SENSOR, _HALF_FOV_DEG),
    setups=conditions(_SENSOR, _HALF_FOV_DEG),
    directions=AngleField(_HALF_FOV_DEG),
    follows=("Chen2006",),
    description=(
        "An optical vernier (Chen2006): slits of the moving ruler 0.32 mm apart, 16/15 of "
        "the three pixels that make a mark of the fixed ruler, so that the slits cross the "
        "marks one after the other as the light moves by a fifteenth of a mark; two of 16 "
        "slits are left out as position code. Few, large pixels, as the abstract claims. "
        "The field of +-64 deg is the study's; it gives no dimensions. Round numbers "
        "instead: slits of 0.15 mm 1 mm up keep the Fresnel number above 10; 104 pixels of "
        "0.1 mm, 90 percent of it sensitive, hold the pattern."
    ),
    regime=regime(_SENSOR),
)
