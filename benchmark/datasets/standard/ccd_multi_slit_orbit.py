"""`ccd-multi-slit-orbit`: one linear CCD behind pairs of slits that drift along an orbit."""

from __future__ import annotations

from benchmark.datasets.conditions.lines_aloft import lines_aloft, under_a_filter
from benchmark.datasets.conditions.orbits import SPACER, in_orbit
from benchmark.datasets.standard import ccd_multi_slit
from benchmark.simulator.flight.attitude import Tumble

_GROUND = under_a_filter(ccd_multi_slit.PRESET, 60.0)

PRESET = in_orbit(
    name="ccd-multi-slit-orbit",
    version=3,
    drawn_as=1,
    ground=_GROUND,
    setups=lines_aloft(_GROUND, SPACER),
    attitude=Tumble(24.0, nutation_deg=24.0, precession_deg_s=0.2531, inertia_ratio=0.75),
    step_s=20.0,
    follows=("Radan2019", "Enright2007a"),
    description=(
        "The sensor of ccd-multi-slit in a sun-synchronous orbit of 600 km. Nutation moves "
        "the Sun from the boresight to 48 deg and back in 24 min. From Radan2019 (model:assem): "
        "errors of installation, a shift of the CCD's centre, misalignment, and a filter in "
        "front (0.5 mm, index 1.52). That its mask has several slits is inferred; amounts of "
        "drift are those of ccd-orbit. Calibration: sunlight of the first three orbits. Test: "
        "three orbits a quarter of a year later. The temperature approaches 35 deg C in "
        "sunlight and -25 deg C in eclipse (time constant 2000 s). Earthlight enters through "
        "the slits."
    ),
)
