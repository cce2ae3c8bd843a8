"""`cmos-n-slit`: one linear CMOS pixel array behind three slits in the shape of an N."""

from __future__ import annotations

from benchmark.datasets.conditions.line_arrays import SUN, active_pixels, behind, line_arrays
from benchmark.datasets.conditions.propagation import GLASS
from benchmark.simulator.masks.slits import n_slit

_MASK = n_slit(3.0, 45.0, width_mm=0.1, length_mm=6.4, thickness_mm=0.0)

PRESET = line_arrays(
    name="cmos-n-slit",
    version=3,
    detector="CMOS",
    mask="N-Slit",
    sensor=behind(_MASK, 1.2, active_pixels(2048, 0.008), axes=("y",), sun=SUN, glass=GLASS),
    half_fov_deg=64.0,
    follows=("He2013",),
    description=(
        "Both angles from one linear active pixel sensor behind an N of slits; it lies along y: "
        "the middle slit is square to it and gives alpha, both outer ones are slanted and add beta "
        "(model:nslit). Detector, N and the field of +-64 deg on both axes are those of He2013, "
        "and so is refraction among the errors: 0.5 mm of glass of index 1.52 here. Nobody "
        "publishes the rest. Round numbers instead: slits of 0.1 mm in a metal film, three times "
        "what light spreads 1.2 mm below; a slant of 45 deg makes both angles weigh alike; 3 mm "
        "between slits keep the three spots in order over the field; 2048 pixels of 8 um hold "
        "them. Pixels "
        "of 60,000 electrons, 2 % gain spread, 60 electrons of read noise, 10 bits: noisier than "
        "ccd-n-slit's, as active pixels of 2013 are."
    ),
)
