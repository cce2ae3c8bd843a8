"""`cmos-compound-eye`: a CMOS array under a lensless compound eye of coded sub-eyes."""

from __future__ import annotations

from benchmark.datasets.conditions.cone import ConeField
from benchmark.datasets.conditions.many_spots import behind, many_spots
from benchmark.datasets.conditions.pixel_arrays import cmos
from benchmark.simulator.masks.coded import compound_eye

_MASK = compound_eye(
    apertures=1026,
    rings=3,
    pitch_mm=0.655,
    diameter_mm=0.12,
    code_mm=0.025,
    focal_length_mm=6.0,
    thickness_mm=0.01,
)

PRESET = many_spots(
    name="cmos-compound-eye",
    version=7,
    drawn_as=5,
    detector="CMOS",
    mask="Encoded",
    # light gathers behind such holes to 1.9 times the open light: a shorter exposure
    sensor=behind(_MASK, 6.0, cmos(192, 0.01, sunlit_e=13_000.0), widest_deg=62.0),
    diameter_mm=0.12,
    half_fov_deg=60.0,
    directions=ConeField(60.0, calibration_samples=150, test_samples=150),
    follows=("Zhang2021", "Zhang2022a"),
    description=(
        "A round pattern of 1026 holes of varying size in 37 sub-eyes over a cone of 120 deg "
        "(counts and field: Zhang2021, Zhang2022a; one-piece mask of long focal length: "
        "Zhang2022a). Sizes are not known. Assumed: 192 x 192 px of 10 um, 6 mm below holes "
        "of 0.12 mm (Fresnel number 1) that grow outwards to 0.16 mm on a triangular lattice "
        "of 0.655 mm. Each hole is moved by 25 um in a direction that encodes its sub-eye."
    ),
)
