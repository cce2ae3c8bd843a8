"""`ccd-multi-slit-orbit`: one linear CCD behind pairs of slits that drift along an orbit."""

from __future__ import annotations

from benchmark.datasets.conditions.lines_aloft import lines_aloft, under_a_filter
from benchmark.datasets.conditions.orbits import SPACER, in_orbit
from benchmark.datasets.standard import ccd_multi_slit
from benchmark.simulator.flight.attitude import Tumble

_GROUND = under_a_filter(ccd_multi_slit.PRESET, 60.0)

PRESET = in_orbit(
    name="ccd-multi-slit-orbit",
    version=1,
    ground=_GROUND,
    setups=lines_aloft(_GROUND, SPACER),
    attitude=Tumble(24.0, nutation_deg=24.0, precession_deg_s=0.2531, inertia_ratio=0.75),
    step_s=20.0,
    follows=("Radan2019", "Enright2007a"),
    description=(
        "The sensor of ccd-multi-slit flown on a sun-synchronous orbit of 600 km, on a satellite "
        "whose nutation takes the Sun from the boresight to 48 deg and back in 24 min. Error "
        "sources are Radan2019's (model:assem): installation, shift of the CCD's centre, "
        "misalignment, and a filter in front, which an extended Kalman filter follows in orbit; "
        "that its mask has several slits is inferred. It gives no amounts: those of ccd-orbit, "
        "whose distance from mask to detector is nearly the same (spacer, bracket, creep). "
        "Calibration: sunlight of the first three orbits; test: three whole orbits a quarter of a "
        "year on. The sensor relaxes towards 35 deg C in sunlight and -25 deg C in eclipse with a "
        "time constant of 2000 s. The sunlit Earth shines through the slits, too, where it is "
        "ahead. The drawing names the filter (0.5 mm, index 1.52)."
    ),
)
