"""`cmos-n-slit`: one linear CMOS pixel array behind three slits in the shape of an N."""

from __future__ import annotations

from benchmark.datasets.conditions.line_arrays import SUN, active_pixels, behind, line_arrays
from benchmark.datasets.conditions.propagation import GLASS
from benchmark.simulator.masks.slits import n_slit

_MASK = n_slit(3.0, 45.0, width_mm=0.1, length_mm=6.4, thickness_mm=0.0)

PRESET = line_arrays(
    name="cmos-n-slit",
    version=5,
    drawn_as=3,
    detector="CMOS",
    mask="N-Slit",
    sensor=behind(_MASK, 1.2, active_pixels(2048, 0.008), axes=("y",), sun=SUN, glass=GLASS),
    half_fov_deg=64.0,
    follows=("He2013",),
    description=(
        "Both angles from one linear active pixel sensor along y behind an N of slits: the "
        "middle slit gives alpha, the two slanted outer ones add beta (model:nslit). From "
        "He2013: detector, mask, field +-64 deg, refraction. Assumed: slits of 0.1 mm, 1.2 mm "
        "above 2048 pixels of 8 um; a slant of 45 deg; 3 mm between slits; glass of 0.5 mm, "
        "index 1.52; pixels of 60,000 electrons, 2 % gain spread, read noise of 60 electrons, "
        "10 bits."
    ),
)
