"""`ccd-v-slit`: one linear CCD behind two slits in the shape of a V."""

from __future__ import annotations

from benchmark.datasets.conditions.line_arrays import SUN, behind, ccd, line_arrays
from benchmark.datasets.conditions.propagation import GLASS
from benchmark.simulator.masks.slits import v_slit

_MASK = v_slit((-3.3, 0.5), 45.0, width_mm=0.1, length_mm=7.2, thickness_mm=0.0)

PRESET = line_arrays(
    name="ccd-v-slit",
    version=5,
    drawn_as=3,
    detector="CCD",
    mask="V-Slit",
    sensor=behind(_MASK, 1.8, ccd(2048, 0.008), axes=("y",), sun=SUN, glass=GLASS),
    half_fov_deg=60.0,
    follows=("Fan2015", "Fan2016"),
    description=(
        "Both angles from one linear CCD along y: a slit square to it gives alpha, one "
        "slanted by 45 deg adds beta (Fan2015, Fan2016; model:vslit). The studies give the "
        "shape and the refraction, no dimensions. Assumed: slits of 0.1 mm, 1.8 mm above 2048 "
        "pixels of 8 um; 3.8 mm between them keeps the two spots in order; glass of 0.5 mm, "
        "index 1.52."
    ),
)
