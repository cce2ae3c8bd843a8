"""`pda-slit`: two linear photodiode arrays at right angles, a slit over each."""

from __future__ import annotations

from algorithms.contract import Observation
from benchmark.datasets.conditions.line_arrays import (
    ASSEMBLED,
    SLITS_ASSEMBLED,
    conditions,
    design,
    photodiode_array,
    regime,
    units,
)
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Preset
from benchmark.simulator.masks.slits import slit_row
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.sensors.lines import LineSensor

_HALF_FOV_DEG = 60.0
_SENSOR = LineSensor(
    camera=Camera(
        focal_length_mm=2.5,
        mask=slit_row((0.0,), width_mm=0.3, length_mm=10.8, thickness_mm=0.02),
        assembly=ASSEMBLED,
    ),
    detector=photodiode_array(256, 0.05),
    pixel_height_mm=0.5,
    fill_factor=0.9,
    errors=SLITS_ASSEMBLED,
)

PRESET = Preset(
    name="pda-slit",
    version=1,
    detector="PDA",
    mask="Slit",
    observation=Observation.PROFILES,
    units=units(_SENSOR),
    geometry=design(_SENSOR, _HALF_FOV_DEG),
    setups=conditions(_SENSOR, _HALF_FOV_DEG),
    directions=AngleField(_HALF_FOV_DEG),
    follows=("Alvi2014", "Diriker2021", "Strietzel2002"),
    description=(
        "Two linear photodiode arrays at right angles (Alvi2014), a slit over each "
        "(Strietzel2002, Diriker2021). The studies give the arrangement, no dimensions. "
        "Round numbers instead: a 0.3 mm slit 2.5 mm up keeps the Fresnel number above 10; "
        "256 pixels of 50 um, 90 percent of it sensitive, hold the light at 60 deg; 10 "
        "bits."
    ),
    regime=regime(_SENSOR),
)
