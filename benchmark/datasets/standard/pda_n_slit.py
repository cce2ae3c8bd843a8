"""`pda-n-slit`: one linear photodiode array behind three slits in the shape of an N."""

from __future__ import annotations

from benchmark.datasets.conditions.line_arrays import behind, line_arrays, photodiode_array
from benchmark.simulator.masks.slits import n_slit

_MASK = n_slit(2.2, 45.0, width_mm=0.2, length_mm=5.0, thickness_mm=0.01)

PRESET = line_arrays(
    name="pda-n-slit",
    version=3,
    detector="PDA",
    mask="N-Slit",
    sensor=behind(_MASK, 1.3, photodiode_array(256, 0.05), axes=("y",), fill_factor=0.9),
    half_fov_deg=50.0,
    follows=("Post2013",),
    description=(
        "Both angles from one linear photodiode array behind an N of slits; it lies along y: the "
        "middle slit is square to it and gives alpha, both outer ones are slanted and add beta "
        "(model:nslit). Post2013 puts a slit mask on a photodiode array; its second method, "
        "orthogonal solar cells without a mask, is pva-maskless-panels. What was mapped gives no "
        "dimensions. Round numbers: 256 pixels of 50 um, 90 percent of it sensitive; slits of 0.2 "
        "mm, four pixels, 1.3 mm up; a slant of 45 deg makes both angles weigh alike; 2.2 mm "
        "between slits keep the three spots in order over +-50 deg; 10 bits."
    ),
)
