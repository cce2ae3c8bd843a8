"""`pda-multi-slit`: two linear photodiode arrays at right angles, five slits over each."""

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

_HALF_FOV_DEG = 51.5
_SENSOR = LineSensor(
    camera=Camera(
        focal_length_mm=1.2,
        mask=slit_row((-1.1, -0.6, 0.0, 0.7, 1.5), width_mm=0.2, length_mm=4.0, thickness_mm=0.05),
        assembly=ASSEMBLED,
    ),
    detector=photodiode_array(144, 0.05, bits=8),
    pixel_height_mm=0.2,
    fill_factor=0.9,
    errors=SLITS_ASSEMBLED,
)

PRESET = Preset(
    name="pda-multi-slit",
    version=1,
    detector="PDA",
    mask="Multi-Slit",
    observation=Observation.PROFILES,
    units=units(_SENSOR),
    geometry=design(_SENSOR, _HALF_FOV_DEG),
    setups=conditions(_SENSOR, _HALF_FOV_DEG),
    directions=AngleField(_HALF_FOV_DEG),
    follows=("Bolshakov2020",),
    description=(
        "Five slits over a linear photodiode array (Bolshakov2020, model:mslit), once an "
        "axis. The field of +-51.5 deg and the growing distance from slit to slit are those "
        "reported for it; one edge of each spot comes from the foil's lower rim at h, the "
        "other from its upper rim at h + t, as the model has it (the focal length here "
        "counts to the middle, h + t/2). Dimensions are not given. Round numbers instead: "
        "slits of 0.2 mm 1.2 mm up keep the Fresnel number above 10; distances of 0.5, 0.6, "
        "0.7 and 0.8 mm; 144 pixels of 50 um; 8 bits as in the same laboratory's later work "
        "(Diriker2021)."
    ),
    regime=regime(_SENSOR),
)
