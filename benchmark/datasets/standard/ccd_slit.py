"""`ccd-slit`: two linear CCDs at right angles, a slit over each."""

from __future__ import annotations

import dataclasses

from algorithms.contract import Observation
from benchmark.datasets.conditions.line_arrays import (
    ASSEMBLED,
    LIGHT,
    SLITS_ASSEMBLED,
    SUN,
    ccd,
    conditions,
    design,
    regime,
    units,
)
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.masks.slits import slit_row
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.sensors.blooming_lines import BloomingLineSensor
from benchmark.simulator.sensors.lines import LineSensor

_HALF_FOV_DEG = 60.0
_SENSOR = LineSensor(
    camera=Camera(
        focal_length_mm=2.5,
        mask=slit_row((0.0,), width_mm=0.25, length_mm=10.4, thickness_mm=0.01),
        sun=SUN,
        assembly=ASSEMBLED,
    ),
    detector=ccd(1024, 0.014),
    pixel_height_mm=0.2,
    errors=SLITS_ASSEMBLED,
)

_SATURATED = Condition(
    "The nominal sensor exposed eight times as long, without anti-blooming drains: full pixels "
    "spill their charge along the line, so that the spot is flat and wider on either side.",
    BloomingLineSensor(
        camera=_SENSOR.camera,
        detector=dataclasses.replace(_SENSOR.detector, sunlit_e=8.0 * _SENSOR.detector.sunlit_e),
        pixel_height_mm=_SENSOR.pixel_height_mm,
        errors=_SENSOR.errors,
    ),
    LIGHT,
)

PRESET = Preset(
    name="ccd-slit",
    version=1,
    detector="CCD",
    mask="Slit",
    observation=Observation.PROFILES,
    units=units(_SENSOR),
    geometry=design(_SENSOR, _HALF_FOV_DEG),
    setups={**conditions(_SENSOR, _HALF_FOV_DEG), "saturated": _SATURATED},
    directions=AngleField(_HALF_FOV_DEG),
    follows=("Chum2003", "KeQiang2020", "Godard2006", "Enright2008a", "Enright2008c"),
    description=(
        "One slit over each of two linear CCDs at right angles (Chum2003), with the slit "
        "deflection and inclination that the slit model corrects (KeQiang2020). The studies "
        "followed give the arrangement, no full geometry. Round numbers instead: a 0.25 mm "
        "slit 2.5 mm up keeps the Fresnel number above 10; 1024 pixels of 14 um hold the "
        "light at 60 deg; the slit is as long as the Sun needs at the edge of the field. "
        "The focal length counts to the middle of the foil. Each array measures one angle; "
        "together they see both."
    ),
    regime=regime(_SENSOR),
)
