"""`qpd-maskless-pyramid`: the four elements of a quadrant photodiode on a pyramid, no mask."""

from __future__ import annotations

from benchmark.datasets.conditions.cone import ConeField
from benchmark.datasets.conditions.faces import (
    QUADRANTS,
    TOWARDS_QUADRANTS,
    faces,
    photodiode_conditions,
    photodiodes,
)

PRESET = faces(
    name="qpd-maskless-pyramid",
    version=4,
    drawn_as=3,
    detector="QPD",
    normals=QUADRANTS,
    order=TOWARDS_QUADRANTS,
    setups=photodiode_conditions(
        photodiodes(QUADRANTS),
        without=("hot", "stray-light"),
        cosine_also=": the balances are linear in the tangents",
    ),
    half_fov_deg=55.0,
    directions=ConeField(55.0),
    follows=("Zhuo2020",),
    description=(
        "Four photodiodes that lean outwards into the four quadrants, read by their balances: "
        "with cosine responses and a tilt t, a balance is tan(t) / sqrt(2) times the tangent "
        "of the Sun angle. Zhuo2020 is filed under voltage balance and the pyramidal model; "
        "no geometry is known. Tilt, field and electronics as in pd-maskless-pyramid."
    ),
)
