"""`cmos-encoded`: a small CMOS array under a large mask of coded groups of holes."""

from __future__ import annotations

from benchmark.datasets.conditions.many_spots import behind, many_spots
from benchmark.datasets.conditions.pixel_arrays import cmos
from benchmark.datasets.fields import AngleField
from benchmark.simulator.masks.coded import spacing_coded, subfield_pitch_mm

_PITCH_MM = subfield_pitch_mm(13, 52.5, 12.0)
_MASK = spacing_coded(
    13, pitch_mm=_PITCH_MM, diameter_mm=0.52, first_mm=0.92, step_mm=0.022, thickness_mm=0.01
)


PRESET = many_spots(
    name="cmos-encoded",
    version=1,
    detector="CMOS",
    mask="Encoded",
    sensor=behind(_MASK, 12.0, cmos(256, 0.02), directions_of_sun=288),
    diameter_mm=0.52,
    half_fov_deg=52.5,
    directions=AngleField(52.5, steps=13, test_samples=150),
    follows=("Wei2014", "Wang2015"),
    description=(
        "13 x 13 sub-fields over 105 x 105 deg, each with a group of three holes whose two "
        "spacings name it (Wei2014; sizes as a second code, Wang2015, are `size_coded`). The "
        "studies' sizes are not in what was mapped; here geometric shadows set them. Three spots, "
        "blurred by the Sun, must fit a group of pitch 2 h tan(52.5 deg) / 13 without touching "
        "while the Fresnel number stays above 10: that needs h = 12 mm, holes of 0.52 mm and "
        "groups 2.41 mm apart. Spacings are 0.92 mm + 22 um times the sub-field's number: 1.1 px a "
        "step. The detector of 5.12 mm holds at least one whole group wherever the Sun is, and "
        "parts of its neighbours; 256 px of 20 um see what more and smaller ones would, the Sun's "
        "image being 5.6 px wide. It is sampled at 288 points: pixels are within 0.5 % of peak of "
        "a finer sampling up to the field's corners, where its image is 25 px long."
    ),
    known={"subfields": 13},
)
