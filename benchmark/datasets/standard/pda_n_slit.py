"""`pda-n-slit`: one linear photodiode array behind three slits in the shape of an N."""

from __future__ import annotations

from benchmark.datasets.conditions.line_arrays import behind, line_arrays, photodiode_array
from benchmark.simulator.masks.slits import n_slit

_MASK = n_slit(2.2, 45.0, width_mm=0.2, length_mm=5.0, thickness_mm=0.01)

PRESET = line_arrays(
    name="pda-n-slit",
    version=5,
    drawn_as=3,
    detector="PDA",
    mask="N-Slit",
    sensor=behind(_MASK, 1.3, photodiode_array(256, 0.05), axes=("y",), fill_factor=0.9),
    half_fov_deg=50.0,
    follows=("Post2013",),
    description=(
        "Both angles from one linear photodiode array along y behind an N of slits: the "
        "middle slit gives alpha, the two slanted outer ones add beta (model:nslit). From "
        "Post2013: a slit mask on a photodiode array, without dimensions (its solar cells are "
        "pva-maskless-panels). Assumed: 256 pixels of 50 um, 90 % of each sensitive, 1.3 mm "
        "below slits of 0.2 mm; a slant of 45 deg; 2.2 mm between slits; field +-50 deg; 10 "
        "bits."
    ),
)
