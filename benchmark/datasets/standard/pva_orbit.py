"""`pva-orbit`: sixteen solar cells of a spherical satellite, Earth in view, warm and cold."""

from __future__ import annotations

from benchmark.datasets.conditions.orbits import in_orbit, photodiodes_aloft
from benchmark.datasets.standard import pva_maskless_sphere
from benchmark.simulator.flight.attitude import Tumble
from benchmark.simulator.flight.drift import PhotodiodeDrift

_GROUND = pva_maskless_sphere.PRESET
_CELLS = PhotodiodeDrift(
    gain_per_k=6e-4, gain_per_k_spread=1e-4, loss_per_year=0.02, loss_per_year_spread=0.01
)

PRESET = in_orbit(
    name="pva-orbit",
    version=3,
    drawn_as=1,
    ground=_GROUND,
    setups=photodiodes_aloft(_GROUND, _CELLS, "cells"),
    attitude=Tumble(90.0, nutation_deg=75.0, precession_deg_s=0.2531, inertia_ratio=0.4),
    step_s=10.0,
    follows=("Zhang2022b",),
    description=(
        "The cells of pva-maskless-sphere with a thermometer, in orbit, for Zhang2022b's "
        "temperature term (eq:msfpano) and albedo. The satellite has been in orbit since 2020; "
        "orbit, attitude and drift are not known. Orbit, tumbling, calibration, test and "
        "temperature as in pd-orbit. Assumed: a cell in full sunlight is 40 K warmer than the "
        "body; 0.06 %/K (typical of multi-junction cells)."
    ),
)
