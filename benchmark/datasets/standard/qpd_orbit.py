"""`qpd-orbit`: a quadrant photodiode whose head and gains drift along an orbit."""

from __future__ import annotations

from benchmark.datasets.conditions.orbits import PHOTODIODES, SPACER, in_orbit
from benchmark.datasets.conditions.quadrants_aloft import quadrants_aloft
from benchmark.datasets.standard import qpd_single_aperture
from benchmark.simulator.flight.attitude import Tumble

_GROUND = qpd_single_aperture.PRESET

PRESET = in_orbit(
    name="qpd-orbit",
    version=1,
    ground=_GROUND,
    setups=quadrants_aloft(_GROUND, SPACER, PHOTODIODES),
    attitude=Tumble(18.0, nutation_deg=18.0, precession_deg_s=0.2531, inertia_ratio=0.75),
    step_s=20.0,
    follows=("Wu2001", "Wu2002"),
    description=(
        "The quadrants of qpd-single-aperture flown on a sun-synchronous orbit of 600 km, on a "
        "satellite whose nutation takes the Sun from the boresight to 36 deg and back in 24 min. "
        "An analogue sensor of two axes, calibrated in orbit by its polynomial and by its geometry "
        "(assembly and electronics), is Wu2002's; sensor and orbits have no numbers in what was "
        "mapped. Drifts are those of the other flights: the head's of ccd-orbit (spacer, bracket, "
        "creep), the gains' of pd-orbit. Calibration: sunlight of the first three orbits; test: "
        "three whole orbits a quarter of a year on. The sensor relaxes towards 35 deg C in "
        "sunlight and -25 deg C in eclipse with a time constant of 2000 s. The sunlit Earth shines "
        "through the opening, too, where it is ahead."
    ),
)
