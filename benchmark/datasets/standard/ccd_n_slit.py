"""`ccd-n-slit`: one linear CCD behind three slits in the shape of an N."""

from __future__ import annotations

from benchmark.datasets.conditions.line_arrays import SUN, behind, ccd, line_arrays
from benchmark.datasets.conditions.propagation import GLASS
from benchmark.simulator.masks.slits import n_slit

_MASK = n_slit(4.0, 45.0, width_mm=0.1, length_mm=7.2, thickness_mm=0.0)

PRESET = line_arrays(
    name="ccd-n-slit",
    version=5,
    drawn_as=3,
    detector="CCD",
    mask="N-Slit",
    sensor=behind(_MASK, 1.8, ccd(2048, 0.014), axes=("y",), sun=SUN, glass=GLASS),
    half_fov_deg=60.0,
    follows=("Wei2011", "Maji2015", "Kohli2019"),
    description=(
        "Both angles from one linear CCD along y behind an N of slits: the middle slit gives "
        "alpha, the two slanted outer ones add beta (model:nslit, Maji2015). From Wei2011: "
        "field +-60 deg, cover glass, thin micromachined mask. Assumed: slits of 0.1 mm, 1.8 "
        "mm above 2048 pixels of 14 um; a slant of 45 deg; 4 mm between slits, which keeps "
        "the three spots in order; glass of 0.5 mm, index 1.52."
    ),
)
