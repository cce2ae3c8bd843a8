"""`ccd-orbit`: an area CCD whose assembly drifts with temperature and age along an orbit."""

from __future__ import annotations

from benchmark.datasets.conditions.orbits import SPACER, frames_aloft, in_orbit
from benchmark.datasets.standard import ccd_single_aperture
from benchmark.simulator.flight.attitude import Tumble

_GROUND = ccd_single_aperture.PRESET

PRESET = in_orbit(
    name="ccd-orbit",
    version=8,
    drawn_as=5,  # what changed since drew nothing anew
    ground=_GROUND,
    setups=frames_aloft(_GROUND, SPACER),
    attitude=Tumble(24.0, nutation_deg=24.0, precession_deg_s=0.2531, inertia_ratio=0.75),
    step_s=20.0,
    follows=(),
    description=(
        "The sensor of ccd-single-aperture in a sun-synchronous orbit of 600 km. Nutation "
        "moves the Sun from the boresight to 48 deg and back in 24 min. From Radan2019 "
        "(model:assem): installation, shift of the CCD's centre, misalignment, a filter in "
        "front; its mask is not known. Assumed drifts: an aluminium spacer of 2 mm lengthens "
        "by 46 nm/K; the mask shifts by 30 and -20 nm/K; the bracket bends by 0.5 and -0.3 "
        "mdeg/K; creep of 1 to 2 um and hundredths of a degree a year. Calibration: sunlight "
        "of the first three orbits. Test: three orbits a quarter of a year later. The "
        "temperature approaches 35 deg C in sunlight and -25 deg C in eclipse (time constant "
        "2000 s). Earthlight is at most 1/10,000 of sunlight."
    ),
)
