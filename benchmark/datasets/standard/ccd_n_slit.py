"""`ccd-n-slit`: one linear CCD behind three slits in the shape of an N."""

from __future__ import annotations

from benchmark.datasets.conditions.line_arrays import SUN, behind, ccd, line_arrays
from benchmark.datasets.conditions.propagation import GLASS
from benchmark.simulator.masks.slits import n_slit

_MASK = n_slit(4.0, 45.0, width_mm=0.1, length_mm=7.2, thickness_mm=0.0)

PRESET = line_arrays(
    name="ccd-n-slit",
    version=3,
    detector="CCD",
    mask="N-Slit",
    sensor=behind(_MASK, 1.8, ccd(2048, 0.014), axes=("y",), sun=SUN, glass=GLASS),
    half_fov_deg=60.0,
    follows=("Wei2011", "Maji2015", "Kohli2019"),
    description=(
        "Both angles from one linear CCD, which lies along y: the middle slit is square to it and "
        "gives alpha, both outer ones are slanted and add beta (model:nslit as the survey states "
        "it after Maji2015). The field of +-60 deg, the cover glass of the CCD and a mask without "
        "thickness, micromachined, are those of Wei2011; nobody publishes the rest. Round numbers "
        "instead: slits of 0.1 mm, two or three times what light spreads 1.8 mm below; a slant of "
        "45 deg makes both angles weigh alike; 4 mm between slits keep the three spots in order "
        "over the field; 2048 pixels of 14 um hold them. Glass: 0.5 mm of index 1.52."
    ),
)
