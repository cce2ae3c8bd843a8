"""`ccd-v-slit`: one linear CCD behind two slits in the shape of a V."""

from __future__ import annotations

from algorithms.contract import Observation
from benchmark.datasets.conditions.line_arrays import (
    ASSEMBLED,
    PLATE,
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
from benchmark.simulator.masks.slits import v_slit
from benchmark.simulator.optics.plates import CoverGlass
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.sensors.lines import LineSensor

_HALF_FOV_DEG = 60.0
_SENSOR = LineSensor(
    camera=Camera(
        focal_length_mm=1.8,
        mask=v_slit((-3.3, 0.5), 45.0, width_mm=0.2, length_mm=6.6, thickness_mm=0.01),
        glass=CoverGlass((PLATE,)),
        sun=SUN,
        assembly=ASSEMBLED,
    ),
    detector=ccd(2048, 0.008),
    pixel_height_mm=0.2,
    axes=("y",),
    errors=SLITS_ASSEMBLED,
)

PRESET = Preset(
    name="ccd-v-slit",
    version=1,
    detector="CCD",
    mask="V-Slit",
    observation=Observation.PROFILES,
    units=units(_SENSOR),
    geometry=design(_SENSOR, _HALF_FOV_DEG),
    setups=conditions(_SENSOR, _HALF_FOV_DEG),
    directions=AngleField(_HALF_FOV_DEG),
    follows=("Fan2015", "Fan2016"),
    description=(
        "Both angles from one linear CCD, which lies along y: a slit square to it gives "
        "alpha, one slanted by 45 deg adds beta (Fan2015, Fan2016; model:vslit). The "
        "studies give the shape and the refraction that must be corrected, no dimensions. "
        "Round numbers instead: slits of 0.2 mm 1.8 mm up keep the Fresnel number above 10; "
        "3.8 mm between them keep the two spots in order over the field; 2048 pixels of 8 "
        "um hold them. Glass: 0.5 mm of index 1.52."
    ),
    regime=regime(_SENSOR),
)
