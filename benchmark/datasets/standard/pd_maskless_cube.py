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
    version=3,
    drawn_as=2,
    detector="PD",
    normals=CUBE,
    order=OF_THE_CUBE,
    setups=photodiode_conditions(photodiodes(CUBE), without=("hot", "stray-light")),
    directions=SphereField(),
    follows=("Allgeier2009", "Frezza2022"),
    description=(
        "A photodiode on each face of a cube; the Sun may be anywhere. From Allgeier2009 and "
        "Frezza2022: the arrangement. From Yousefian2017: the angular response (Kelly "
        "cosine). Assumed: 100 uA in full sunlight; converter range twice that, for Sun and "
        "Earth together."
    ),
)
