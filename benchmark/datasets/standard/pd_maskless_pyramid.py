"""`pd-maskless-pyramid`: six bare photodiodes on the faces of a pyramid."""

from __future__ import annotations

from benchmark.datasets.conditions.cone import ConeField
from benchmark.datasets.conditions.faces import faces, photodiode_conditions, photodiodes
from benchmark.simulator.sensors.face_layouts import pyramid

_NORMALS = pyramid(6, 30.0)

PRESET = faces(
    name="pd-maskless-pyramid",
    version=5,
    drawn_as=3,
    detector="PD",
    normals=_NORMALS,
    order="faces at azimuths 0, 60, ..., 300 deg from +x to +y",
    setups=photodiode_conditions(photodiodes(_NORMALS)),
    half_fov_deg=55.0,
    directions=ConeField(55.0),
    follows=("Wang2019", "Yousefian2017"),
    description=(
        "Photodiodes on the six lateral faces of a regular pyramid (eq:msfpyra1, Wang2019). "
        "From Yousefian2017: six faces, Kelly cosine, a field of a cone of 110 deg. Assumed: "
        "a tilt of 30 deg from the boresight, with which all faces are lit over the field. "
        "Electronics as in pd-maskless-cube."
    ),
)
