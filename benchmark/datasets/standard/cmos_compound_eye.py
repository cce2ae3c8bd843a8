"""`cmos-compound-eye`: a CMOS array under a lensless compound eye of coded sub-eyes."""

from __future__ import annotations

from benchmark.datasets.conditions.cone import ConeField
from benchmark.datasets.conditions.many_spots import behind, many_spots
from benchmark.datasets.conditions.pixel_arrays import cmos
from benchmark.simulator.masks.coded import compound_eye

_MASK = compound_eye(
    apertures=1026,
    rings=3,
    pitch_mm=1.31,
    diameter_mm=0.52,
    code_mm=0.05,
    focal_length_mm=12.0,
    thickness_mm=0.01,
)


PRESET = many_spots(
    name="cmos-compound-eye",
    version=1,
    detector="CMOS",
    mask="Encoded",
    sensor=behind(_MASK, 12.0, cmos(192, 0.02), directions_of_sun=256),
    diameter_mm=0.52,
    half_fov_deg=60.0,
    directions=ConeField(60.0, calibration_samples=150, test_samples=150),
    follows=("Zhang2021", "Zhang2022a"),
    description=(
        "A round pattern of 1026 holes of varying size in 37 sub-eyes over a cone of 120 deg, the "
        "counts and field of Zhang2021 and Zhang2022a; their sizes are not in what was mapped. As "
        "in cmos-encoded, geometric shadows ask for h = 12 mm and holes of 0.52 mm, growing "
        "outwards with the slant ray. A triangular lattice of 1.31 mm lets 1026 holes cover what a "
        "detector of 3.84 mm sees over the whole cone; each is moved by 50 um in a direction drawn "
        "for its sub-eye, so that the pattern seen tells the sub-eye. The Sun is sampled at 256 "
        "points: pixels are within 0.5 % of peak of a finer sampling."
    ),
)
