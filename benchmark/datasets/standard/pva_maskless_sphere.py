"""`pva-maskless-sphere`: sixteen solar cells spread over a spherical satellite."""

from __future__ import annotations

from benchmark.datasets.conditions.faces import faces
from benchmark.datasets.conditions.solar_faces import cells_on, solar_conditions
from benchmark.datasets.fields import SphereField
from benchmark.simulator.sensors.face_layouts import sphere

_NORMALS = sphere(16)

PRESET = faces(
    name="pva-maskless-sphere",
    version=4,
    drawn_as=2,
    detector="PVA",
    normals=_NORMALS,
    order="cells on a Fibonacci lattice from +z to -z (geometry.face_normals)",
    setups=solar_conditions(cells_on(_NORMALS, sunlit_ua=50_000.0)),
    directions=SphereField(test_samples=1000),
    follows=("Zhang2022b",),
    description=(
        "Sixteen single solar cells over a sphere, several of them always lit (eq:msfpano). "
        "Zhang2022b reads 16 of the 991 cells of a spherical satellite and compensates their "
        "temperature; which ones is not known. Assumed: a Fibonacci lattice, 50 mA per cell, "
        "otherwise as in pva-maskless-panels. Barnes2014 covers a hemisphere with photodiodes "
        "in the same way."
    ),
)
