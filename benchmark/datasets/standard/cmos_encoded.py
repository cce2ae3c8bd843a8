"""`cmos-encoded`: a small CMOS array under a large mask of coded groups of holes."""

from __future__ import annotations

from benchmark.datasets.conditions.many_spots import behind, many_spots
from benchmark.datasets.conditions.pixel_arrays import cmos
from benchmark.datasets.fields import AngleField
from benchmark.simulator.masks.coded import spacing_coded, subfield_pitch_mm

_PITCH_MM = subfield_pitch_mm(13, 52.5, 6.0)
_MASK = spacing_coded(
    13, pitch_mm=_PITCH_MM, diameter_mm=0.12, first_mm=0.46, step_mm=0.011, thickness_mm=0.01
)

PRESET = many_spots(
    name="cmos-encoded",
    version=7,
    drawn_as=5,
    detector="CMOS",
    mask="Encoded",
    # light gathers behind such holes to 1.9 times the open light: a shorter exposure
    sensor=behind(_MASK, 6.0, cmos(256, 0.01, sunlit_e=13_000.0), widest_deg=63.0),
    diameter_mm=0.12,
    half_fov_deg=52.5,
    directions=AngleField(52.5, steps=13, test_samples=150),
    follows=("Wei2014", "Wang2015"),
    description=(
        "13 x 13 sub-fields over 105 x 105 deg, each with three holes whose two spacings "
        "encode it (Wei2014; codes by size, Wang2015, are in cmos-encoded-sizes). From "
        "Wang2015: long focal length, diffraction-limited spots. Assumed: 256 x 256 px of 10 "
        "um, 6 mm below groups 1.2 mm apart, so that one whole group is always visible; holes "
        "of 0.12 mm (Fresnel number 1), spacings of 0.46 mm + 11 um per sub-field; foil of 10 "
        "um; tolerances of 1 um in position, 1 um in size (per unit) and 0.5 um per edge. "
        "Spots are 10 px wide at normal incidence; in the corners 40 px, and 20 times as dim."
    ),
    known={"subfields": 13},
)
