"""`pd-maskless-cube`: six bare photodiodes on the faces of a cube."""

from __future__ import annotations

from benchmark.datasets.conditions.faces import (
    OF_THE_CUBE,
    faces,
    photodiode_conditions,
    photodiodes,
)
from benchmark.datasets.fields import SphereField
from benchmark.simulator.sensors.faces import CUBE

PRESET = faces(
    name="pd-maskless-cube",
    version=2,
    detector="PD",
    normals=CUBE,
    order=OF_THE_CUBE,
    setups=photodiode_conditions(photodiodes(CUBE), without=("hot", "stray-light")),
    directions=SphereField(),
    follows=("Allgeier2009", "Frezza2022"),
    description=(
        "One photodiode a face, Sun from anywhere on the sphere. The studies followed give the "
        "arrangement and the angular response (Kelly cosine: Yousefian2017), no electronics: full "
        "sunlight is set to 100 uA, the converter to twice that so that Sun and Earth together fit."
    ),
)
