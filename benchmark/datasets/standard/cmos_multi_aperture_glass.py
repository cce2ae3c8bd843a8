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
    version=1,
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
        "Full frames of 512 x 512 px behind 6 x 6 round holes, the pattern of the Tsinghua "
        "sensors, whose arrays are read through the glass of their package: refraction is one of "
        "the three errors that Li2012 takes out, before its polynomial. Neither glass nor lengths "
        "are in what was mapped: 0.5 mm of index 1.52, the cover of every other data set that has "
        "one, under a foil 1.2 mm up, so that no spot leaves the array within +-50 deg. Holes, "
        "pixels and exposure are those of cmos-multi-aperture, a pitch of 0.467 mm keeps "
        "neighbours from falling alike on the 10 um pixels. At 50 deg the glass pulls the pattern "
        "in by 30 px of 143. Few samples, because a frame is 0.5 MB with 36 spots to render."
    ),
)
