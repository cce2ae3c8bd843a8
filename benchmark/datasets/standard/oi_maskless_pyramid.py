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
    version=5,
    drawn_as=3,
    detector="OI",
    normals=QUADRANTS,
    order=TOWARDS_QUADRANTS,
    setups=opto_isolator_conditions(_SENSOR),
    half_fov_deg=55.0,
    directions=ConeField(55.0),
    follows=(),
    description=(
        "Four phototransistors of opto-isolators in Wang2019's pyramid. The survey lists "
        "opto-isolators among detectors, but no mapped study and no known sun sensor uses "
        "them. Assumed: a Gummel-Poon phototransistor whose gain halves at a tenth of "
        "sunlight, gains spread by a factor of 1.35, 1 mA in full sunlight, converter range "
        "four times that, mounting within 1 deg. Tilt and field as in pd-maskless-pyramid."
    ),
)
