"""`cmos-multi-aperture-glass`: a CMOS pixel array under its cover glass, behind 6 x 6 holes."""

from __future__ import annotations

from dataclasses import replace

from benchmark.datasets.conditions.many_spots import behind, many_spots
from benchmark.datasets.conditions.pixel_arrays import cmos
from benchmark.datasets.conditions.propagation import GLASS
from benchmark.datasets.fields import AngleField
from benchmark.simulator.masks.apertures import Aperture
from benchmark.simulator.masks.layouts import grid

_MASK = grid(6, 6, 0.467, Aperture("round", 0.1, 0.1), thickness_mm=0.01)
_OPEN = behind(_MASK, 1.2, cmos(512, 0.01, sunlit_e=16_000.0), widest_deg=61.0)
_SENSOR = replace(_OPEN, camera=replace(_OPEN.camera, glass=GLASS))

PRESET = many_spots(
    name="cmos-multi-aperture-glass",
    version=3,
    drawn_as=1,
    detector="CMOS",
    mask="Multi-Ap.",
    sensor=_SENSOR,
    diameter_mm=0.1,
    half_fov_deg=50.0,
    directions=AngleField(50.0, steps=11, test_samples=60),
    without=("hot",),
    known={"cover_glass": tuple((plate.thickness_mm, plate.index) for plate in GLASS.plates)},
    follows=("Xing2008", "You2011", "Li2012"),
    description=(
        "Full frames of 512 x 512 px behind 6 x 6 round holes, read through the glass of the "
        "package as in the Tsinghua sensors: Li2012 removes refraction before its polynomial. "
        "Dimensions are not known. Assumed: glass of 0.5 mm, index 1.52, under a foil 1.2 mm "
        "up; pitch 0.467 mm; field +-50 deg; holes, pixels and exposure as in "
        "cmos-multi-aperture. At 50 deg the glass shifts the pattern by 30 of 143 px."
    ),
)
