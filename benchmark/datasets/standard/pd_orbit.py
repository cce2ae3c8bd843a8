"""`pd-orbit`: the photodiode cube on a tumbling satellite, Earth in view, in and out of eclipse."""

from __future__ import annotations

from benchmark.datasets.conditions.orbits import PHOTODIODES, in_orbit, photodiodes_aloft
from benchmark.datasets.standard import pd_maskless_cube
from benchmark.simulator.flight.attitude import Tumble

_GROUND = pd_maskless_cube.PRESET

PRESET = in_orbit(
    name="pd-orbit",
    version=5,
    drawn_as=2,  # what changed since drew nothing anew
    ground=_GROUND,
    setups=photodiodes_aloft(_GROUND, PHOTODIODES),
    attitude=Tumble(90.0, nutation_deg=75.0, precession_deg_s=0.2531, inertia_ratio=0.4),
    step_s=10.0,
    follows=("Frezza2022", "OKeefe2017"),
    description=(
        "The cube of pd-maskless-cube in a sun-synchronous orbit of 600 km (node at 10:30, a "
        "third of each orbit in eclipse) on a slowly tumbling satellite, so that the Sun passes "
        "over nearly the whole sphere. From Frezza2022: six photodiodes aided by a magnetometer. "
        "From OKeefe2017: no albedo in eclipse, calibration in orbit (eq:mnoise). Orbit and drift "
        "are assumed. Calibration: sunlight of the first three orbits, Earth in view. Test: three "
        "orbits a quarter of a year later, the same unit aged. The temperature approaches 35 deg "
        "C in sunlight and -25 deg C in eclipse (time constant 2000 s)."
    ),
)
