"""`cmos-encoded-sizes`: a small CMOS array under groups of holes coded by spacing and size."""

from __future__ import annotations

from benchmark.datasets.conditions.many_spots import behind, many_spots
from benchmark.datasets.conditions.pixel_arrays import cmos
from benchmark.datasets.fields import AngleField
from benchmark.simulator.masks.coded import subfield_pitch_mm
from benchmark.simulator.masks.coded_groups import spacing_and_size_coded

_GROUP = {"narrow_mm": 0.105, "wide_mm": 0.15, "first_mm": 0.46, "step_mm": 0.02}
_PLACES = {"pitch_mm": subfield_pitch_mm(13, 60.0, 4.5), "focal_length_mm": 4.5}
_MASK = spacing_and_size_coded(13, **_GROUP, **_PLACES, thickness_mm=0.01)

PRESET = many_spots(
    name="cmos-encoded-sizes",
    version=3,
    drawn_as=1,
    detector="CMOS",
    mask="Encoded",
    # light gathers behind such holes to about twice the open light: a shorter exposure
    sensor=behind(_MASK, 4.5, cmos(256, 0.01, sunlit_e=12_000.0), widest_deg=70.0),
    diameter_mm=0.105,
    half_fov_deg=60.0,
    directions=AngleField(60.0, steps=13, test_samples=150),
    follows=("Wang2015",),
    description=(
        "13 x 13 sub-fields over 120 x 120 deg, each with three holes encoded by two spacings "
        "and two sizes that grow with incidence (Wang2015; dimensions are not known). "
        "Assumed: 256 x 256 px of 10 um, 4.5 mm below groups 1.2 mm apart; spacings of 0.46 "
        "mm + 20 um per two sub-fields; odd sub-fields have a hole of 0.15 mm, even ones of "
        "0.105 mm (Fresnel number 1.1), times the square root of 1/cos of incidence. Foil and "
        "tolerances as in cmos-encoded."
    ),
    known={"subfields": 13},
)
