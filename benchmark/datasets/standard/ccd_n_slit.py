"""`ccd-n-slit`: one linear CCD behind three slits in the shape of an N."""

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
from benchmark.simulator.masks.slits import n_slit
from benchmark.simulator.optics.plates import CoverGlass
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.sensors.lines import LineSensor

_HALF_FOV_DEG = 60.0
_SENSOR = LineSensor(
    camera=Camera(
        focal_length_mm=1.8,
        mask=n_slit(4.0, 45.0, width_mm=0.2, length_mm=6.6, thickness_mm=0.01),
        glass=CoverGlass((PLATE,)),
        sun=SUN,
        assembly=ASSEMBLED,
    ),
    detector=ccd(2048, 0.014),
    pixel_height_mm=0.2,
    axes=("y",),
    errors=SLITS_ASSEMBLED,
)

PRESET = Preset(
    name="ccd-n-slit",
    version=1,
    detector="CCD",
    mask="N-Slit",
    observation=Observation.PROFILES,
    units=units(_SENSOR),
    geometry=design(_SENSOR, _HALF_FOV_DEG),
    setups=conditions(_SENSOR, _HALF_FOV_DEG),
    directions=AngleField(_HALF_FOV_DEG),
    follows=("Wei2011", "Maji2015", "Kohli2019"),
    description=(
        "Both angles from one linear CCD, which lies along y: the middle slit is square to "
        "it and gives alpha, both outer ones are slanted and add beta (model:nslit as the "
        "survey states it after Maji2015). The field of +-60 deg and the cover glass of the "
        "CCD are those of Wei2011; the rest is not given. Round numbers instead: slits of "
        "0.2 mm 1.8 mm up keep the Fresnel number above 10; a slant of 45 deg makes both "
        "angles weigh alike; 4 mm between slits keep the three spots in order over the "
        "field; 2048 pixels of 14 um hold them. Glass: 0.5 mm of index 1.52."
    ),
    regime=regime(_SENSOR),
)
