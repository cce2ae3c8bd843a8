"""`ccd-orbit`: an area CCD whose assembly drifts with temperature and age along an orbit."""

from __future__ import annotations

from benchmark.datasets.conditions.orbits import SPACER, frames_aloft, in_orbit
from benchmark.datasets.standard import ccd_single_aperture
from benchmark.simulator.flight.attitude import Tumble

_GROUND = ccd_single_aperture.PRESET

PRESET = in_orbit(
    name="ccd-orbit",
    version=6,
    drawn_as=5,  # the context has a gyroscope since; the rest is as it was
    ground=_GROUND,
    setups=frames_aloft(_GROUND, SPACER),
    attitude=Tumble(24.0, nutation_deg=24.0, precession_deg_s=0.2531, inertia_ratio=0.75),
    step_s=20.0,
    follows=(),
    description=(
        "The sensor of ccd-single-aperture flown on a sun-synchronous orbit of 600 km, on a "
        "satellite whose nutation takes the Sun from the boresight to 48 deg and back in 24 min. "
        "Error sources are Radan2019's (model:assem): installation, shift of the CCD's centre, "
        "misalignment, and a filter in front; its mask is not known for certain (several slits, by "
        "inference) and is not followed. It gives no amounts: an aluminium spacer of 2 mm (23 "
        "ppm/K) lengthens by 46 nm/K, unequal expansion (15 ppm/K over 2 mm) shifts the mask by 30 "
        "and -20 nm/K, the bracket bends by 0.5 and -0.3 mdeg/K; creep of one to two um and "
        "hundredths of a degree a year. Calibration: sunlight of the first three orbits; test: "
        "three whole orbits a quarter of a year on. The sensor relaxes towards 35 deg C in "
        "sunlight and -25 deg C in eclipse with a time constant of 2000 s. In eclipse the window "
        "stays where the Sun was last seen. The sunlit Earth shines through the hole, too, where "
        "it is ahead: onto the window about a ten-thousandth of sunlight at most."
    ),
)
