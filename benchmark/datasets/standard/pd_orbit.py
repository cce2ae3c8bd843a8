"""`pd-orbit`: the photodiode cube on a tumbling satellite, Earth in view, in and out of eclipse."""

from __future__ import annotations

from benchmark.datasets.conditions.orbits import PHOTODIODES, in_orbit, photodiodes_aloft
from benchmark.datasets.standard import pd_maskless_cube
from benchmark.simulator.flight.attitude import Tumble

_GROUND = pd_maskless_cube.PRESET

PRESET = in_orbit(
    name="pd-orbit",
    version=3,
    drawn_as=2,  # the context has a gyroscope since; the rest is as it was
    ground=_GROUND,
    setups=photodiodes_aloft(_GROUND, PHOTODIODES),
    attitude=Tumble(90.0, nutation_deg=75.0, precession_deg_s=0.2531, inertia_ratio=0.4),
    step_s=10.0,
    follows=("Frezza2022", "OKeefe2017"),
    description=(
        "The cube of pd-maskless-cube flown on a sun-synchronous orbit of 600 km (node at 10:30, a "
        "third of every orbit in eclipse) on a satellite that tumbles slowly, as after detumbling, "
        "so that the Sun passes over nearly the whole sphere. Six cosine-type photodiodes aided by "
        "a magnetometer are Frezza2022's arrangement; albedo that ends with eclipse and "
        "calibration in orbit are OKeefe2017's (eq:mnoise). Neither gives orbit or drift in what "
        "was mapped: round numbers instead. Calibration: sunlight of the first three orbits, Earth "
        "in view as later; test: three whole orbits a quarter of a year on, the same unit aged. "
        "The sensor relaxes towards 35 deg C in sunlight and -25 deg C in eclipse with a time "
        "constant of 2000 s."
    ),
)
