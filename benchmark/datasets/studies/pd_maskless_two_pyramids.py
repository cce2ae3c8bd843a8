"""`pd-maskless-two-pyramids`: three photodiodes on each of two pyramids, in a thermal chamber."""

from __future__ import annotations

import math

from benchmark.datasets.conditions.faces import OF_THE_CUBE, faces, photodiodes
from benchmark.datasets.conditions.orbits import PHOTODIODES
from benchmark.datasets.conditions.propagation import LIGHT
from benchmark.datasets.conditions.thermal_chamber import Chamber, ThermalChamberPreset
from benchmark.datasets.fields import SphereField
from benchmark.datasets.preset import Condition
from benchmark.simulator.flight.time_series import DriftingFaceSensor
from benchmark.simulator.sensors.faces import CUBE

_STILL = photodiodes(CUBE)
_SENSOR = DriftingFaceSensor(
    normals=CUBE,
    readout=_STILL.readout,
    normal_error_deg=_STILL.normal_error_deg,
    drift=PHOTODIODES,
)
#: Between a pyramid's axis and each of three faces at right angles to each other.
_TILT_DEG = math.degrees(math.acos(1.0 / math.sqrt(3.0)))
_CALIBRATED_C, _HOTTER_C = (-20.0, 40.0), (60.0, 80.0)

PRESET = ThermalChamberPreset.of(
    faces(
        name="pd-maskless-two-pyramids",
        version=2,
        drawn_as=1,
        detector="PD",
        normals=CUBE,
        order=f"{OF_THE_CUBE}: +x, +y, +z on one pyramid, -x, -y, -z on the other",
        setups={
            "nominal": Condition(
                "Kelly response, 1 % gain mismatch, normals within 0.1 deg, gain +0.1 %/K with "
                "0.02 %/K from face to face; every pose between -20 and 40 deg C, no Earth.",
                _SENSOR,
                LIGHT,
            ),
            "hot": Condition(
                "The nominal sensor, calibrated between -20 and 40 deg C and tested between 60 and "
                "80 deg C.",
                _SENSOR,
                LIGHT,
            ),
        },
        directions=SphereField(),
        follows=("Lu2017a",),
        description=(
            "Two triangular pyramids of three photodiodes each, at opposite corners of a "
            "nanosatellite, whose Sun may be anywhere (Lu2017a's abstract). eq:tempcomp takes the "
            "currents of three faces as the components x, y and z of the Sun's direction: the "
            "faces of a pyramid stand at right angles, 54.7 deg from its axis. The six normals "
            "are then those of a cube, and far light does not tell the two apart. Its temperature "
            "coefficient was found by experiment: every pose has a temperature of its own, and a "
            "thermometer is read. Assumed: temperatures, the coefficient, its spread, response "
            "and electronics, as in pd-maskless-cube and pd-orbit."
        ),
    ),
    {
        "nominal": Chamber(_CALIBRATED_C, _CALIBRATED_C),
        "hot": Chamber(_CALIBRATED_C, _HOTTER_C),
    },
    {"layout": "two pyramids", "tilt_deg": _TILT_DEG},
)
