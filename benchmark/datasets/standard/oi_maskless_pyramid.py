"""`oi-maskless-pyramid`: four opto-isolators used as light sensors on a pyramid."""

from __future__ import annotations

from benchmark.datasets.conditions.cone import ConeField
from benchmark.datasets.conditions.faces import (
    QUADRANTS,
    TOWARDS_QUADRANTS,
    faces,
    opto_isolator_conditions,
)
from benchmark.simulator.readout.detectors import CurrentReadout, DarkCurrent
from benchmark.simulator.sensors.opto_isolator import OptoIsolatorSensor

_READOUT = CurrentReadout(1_000.0, 0.3, 1.0, 4_000.0, bits=14, dark=DarkCurrent(0.1))
_SENSOR = OptoIsolatorSensor(QUADRANTS, _READOUT, normal_error_deg=1.0)

PRESET = faces(
    name="oi-maskless-pyramid",
    version=3,
    detector="OI",
    normals=QUADRANTS,
    order=TOWARDS_QUADRANTS,
    setups=opto_isolator_conditions(_SENSOR),
    half_fov_deg=55.0,
    directions=ConeField(55.0),
    follows=(),
    description=(
        "The phototransistors of four opto-isolators, opened towards the Sun, in Wang2019's "
        "pyramid. No mapped study is known to use opto-isolators (the survey lists them among its "
        "detectors), and no sun sensor of that kind was found: an idealisation, of a "
        "phototransistor by Gummel and Poon's law. Its numbers are round: recombination halves the "
        "gain in a tenth of sunlight, as the current transfer ratio of such parts falls at small "
        "currents; gains spread by a factor e^0.3 = 1.35, as those ratios do within one type; 1 mA "
        "in full sunlight, four times that before the converter is full; mounting within 1 deg. "
        "Tilt and field as in pd-maskless-pyramid."
    ),
)
