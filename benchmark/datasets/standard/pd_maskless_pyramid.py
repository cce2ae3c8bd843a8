"""`pd-maskless-pyramid`: six bare photodiodes on the faces of a pyramid."""

from __future__ import annotations

from benchmark.datasets.conditions.cone import ConeField
from benchmark.datasets.conditions.faces import faces, photodiode_conditions, photodiodes
from benchmark.simulator.sensors.face_layouts import pyramid

_NORMALS = pyramid(6, 30.0)

PRESET = faces(
    name="pd-maskless-pyramid",
    version=3,
    detector="PD",
    normals=_NORMALS,
    order="faces at azimuths 0, 60, ..., 300 deg from +x to +y",
    setups=photodiode_conditions(photodiodes(_NORMALS)),
    half_fov_deg=55.0,
    directions=ConeField(55.0),
    follows=("Wang2019", "Yousefian2017"),
    description=(
        "Photodiodes on the lateral faces of a regular pyramid (eq:msfpyra1, Wang2019); their "
        "number, six, the Kelly cosine and the field, a cone of 110 deg, are Yousefian2017's. The "
        "tilt is not given in what was mapped: 30 deg from the boresight is the largest round "
        "number that leaves all six lit within that cone. Electronics as in pd-maskless-cube."
    ),
)
