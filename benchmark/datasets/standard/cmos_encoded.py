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
    version=5,
    detector="CMOS",
    mask="Encoded",
    # light gathers behind such holes to 1.9 times the open light: a shorter exposure
    sensor=behind(_MASK, 6.0, cmos(256, 0.01, sunlit_e=13_000.0), widest_deg=63.0),
    diameter_mm=0.12,
    half_fov_deg=52.5,
    directions=AngleField(52.5, steps=13, test_samples=150),
    follows=("Wei2014", "Wang2015"),
    description=(
        "13 x 13 sub-fields over 105 x 105 deg, each with a group of three holes whose two "
        "spacings name it (Wei2014; sizes as a second code, Wang2015, are `size_coded`). The "
        "studies' sizes are not in what was mapped, but for a long focal length and spots that "
        "diffraction rules (Wang2015). A detector that shows one whole group wherever the Sun is "
        "must be two groups wide, and groups are 2 h tan(52.5 deg) / 13 apart: 256 px of 10 um "
        "ask for h = 6 mm and groups 1.2 mm apart, a mask of 16 mm. Holes of 0.12 mm are near the "
        "Fresnel number of 1, where a pinhole's spot is narrowest: ten pixels at normal incidence, "
        "and 1.9 times the open light in the middle. At the field's corners spots are 40 px long "
        "and twenty times as dim. Spacings are 0.46 mm + 11 um times the sub-field's number: 1.1 "
        "px a step. The foil is 10 um thick; holes are off by 1 um in position, 1 um in size (the "
        "unit as a whole) and 0.5 um an edge: round numbers without a model."
    ),
    known={"subfields": 13},
)
