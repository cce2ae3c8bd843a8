"""`pva-maskless-panels`: the currents of solar panels on the six faces of a satellite."""

from __future__ import annotations

from benchmark.datasets.conditions.faces import faces
from benchmark.datasets.conditions.solar_faces import cells_on, solar_conditions
from benchmark.datasets.fields import SphereField
from benchmark.simulator.sensors.faces import CUBE

PRESET = faces(
    name="pva-maskless-panels",
    version=4,
    drawn_as=2,
    detector="PVA",
    normals=CUBE,
    order="panels +x, -x, +y, -y, +z, -z",
    setups=solar_conditions(cells_on(CUBE, sunlit_ua=500_000.0, in_series=2)),
    directions=SphereField(),
    follows=("Nurgizat2021", "Lu2017b", "Post2013", "Hermoso2022b"),
    description=(
        "Short-circuit currents of solar panels on the body of a satellite (eq:msfsc); the "
        "Sun may be anywhere. From the studies: the arrangement and the errors (angular "
        "response, temperature, Earth, degradation). Assumed: two cells of 0.5 A per panel, "
        "0.06 %/K (typical of multi-junction cells), 40 K between the sunlit and the dark "
        "side."
    ),
)
