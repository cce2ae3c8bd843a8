"""`qpd-orbit`: a quadrant photodiode whose head and gains drift along an orbit."""

from __future__ import annotations

from benchmark.datasets.conditions.orbits import PHOTODIODES, SPACER, in_orbit
from benchmark.datasets.conditions.quadrants_aloft import quadrants_aloft
from benchmark.datasets.standard import qpd_single_aperture
from benchmark.simulator.flight.attitude import Tumble

_GROUND = qpd_single_aperture.PRESET

PRESET = in_orbit(
    name="qpd-orbit",
    version=3,
    drawn_as=1,
    ground=_GROUND,
    setups=quadrants_aloft(_GROUND, SPACER, PHOTODIODES),
    attitude=Tumble(18.0, nutation_deg=18.0, precession_deg_s=0.2531, inertia_ratio=0.75),
    step_s=20.0,
    follows=("Wu2001", "Wu2002"),
    description=(
        "The quadrants of qpd-single-aperture in a sun-synchronous orbit of 600 km. Nutation "
        "moves the Sun from the boresight to 36 deg and back in 24 min. Wu2002 calibrates a "
        "two-axis analogue sensor in orbit by its polynomial and by its geometry; no numbers "
        "are known. Assembly drifts as in ccd-orbit, gain drifts as in pd-orbit. Calibration: "
        "sunlight of the first three orbits. Test: three orbits a quarter of a year later. "
        "The temperature approaches 35 deg C in sunlight and -25 deg C in eclipse (time "
        "constant 2000 s). Earthlight enters through the opening."
    ),
)
