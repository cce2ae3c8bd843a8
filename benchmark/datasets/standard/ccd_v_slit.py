"""`ccd-v-slit`: one linear CCD behind two slits in the shape of a V."""

from __future__ import annotations

from benchmark.datasets.conditions.line_arrays import SUN, behind, ccd, line_arrays
from benchmark.datasets.conditions.propagation import GLASS
from benchmark.simulator.masks.slits import v_slit

_MASK = v_slit((-3.3, 0.5), 45.0, width_mm=0.1, length_mm=7.2, thickness_mm=0.0)

PRESET = line_arrays(
    name="ccd-v-slit",
    version=3,
    detector="CCD",
    mask="V-Slit",
    sensor=behind(_MASK, 1.8, ccd(2048, 0.008), axes=("y",), sun=SUN, glass=GLASS),
    half_fov_deg=60.0,
    follows=("Fan2015", "Fan2016"),
    description=(
        "Both angles from one linear CCD, which lies along y: a slit square to it gives alpha, one "
        "slanted by 45 deg adds beta (Fan2015, Fan2016; model:vslit). The studies give the shape "
        "and the refraction that must be corrected, nobody the dimensions. Round numbers instead: "
        "slits of 0.1 mm in a metal film, two or three times what light spreads 1.8 mm below; 3.8 "
        "mm between them keep the two spots in order over the field; 2048 pixels of 8 um hold "
        "them. Glass: 0.5 mm of index 1.52."
    ),
)
