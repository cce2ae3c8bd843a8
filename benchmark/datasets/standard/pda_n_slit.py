"""`pda-n-slit`: one linear photodiode array behind three slits in the shape of an N."""

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
from benchmark.simulator.masks.slits import n_slit
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.sensors.lines import LineSensor

_HALF_FOV_DEG = 50.0
_SENSOR = LineSensor(
    camera=Camera(
        focal_length_mm=1.3,
        mask=n_slit(2.2, 45.0, width_mm=0.2, length_mm=4.4, thickness_mm=0.01),
        assembly=ASSEMBLED,
    ),
    detector=photodiode_array(256, 0.05),
    pixel_height_mm=0.2,
    axes=("y",),
    fill_factor=0.9,
    errors=SLITS_ASSEMBLED,
)

PRESET = Preset(
    name="pda-n-slit",
    version=1,
    detector="PDA",
    mask="N-Slit",
    observation=Observation.PROFILES,
    units=units(_SENSOR),
    geometry=design(_SENSOR, _HALF_FOV_DEG),
    setups=conditions(_SENSOR, _HALF_FOV_DEG),
    directions=AngleField(_HALF_FOV_DEG),
    follows=("Post2013",),
    description=(
        "Both angles from one linear photodiode array behind an N of slits; it lies along y: the "
        "middle slit is square to it and gives alpha, both outer ones are slanted and add beta "
        "(model:nslit). Post2013 puts a slit mask on a photodiode array; its second method, "
        "orthogonal solar cells without a mask, is pva-maskless-panels. What was mapped gives "
        "no dimensions. Round numbers: slits of 0.2 mm 1.3 mm up keep the Fresnel number above "
        "10; a slant of 45 deg makes both angles weigh alike; 2.2 mm between slits keep the "
        "three spots in order over +-50 deg; 256 pixels of 50 um, 90 percent of it sensitive, "
        "hold them; 10 bits."
    ),
    regime=regime(_SENSOR),
)
