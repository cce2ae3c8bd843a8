"""`cmos-encoded-oblique`: a CMOS array under seven groups of holes placed obliquely."""

from __future__ import annotations

from benchmark.datasets.conditions.cone import ConeField
from benchmark.datasets.conditions.many_spots import behind, many_spots
from benchmark.datasets.conditions.pixel_arrays import cmos
from benchmark.simulator.masks.coded_groups import oblique_coded

_WORDS = ("20314", "02413", "14203", "31042", "42031", "13024", "30421")
_ORDERS = tuple(tuple(int(place) for place in word) for word in _WORDS)
_MASK = oblique_coded(_ORDERS, pitch_mm=1.86, cell_mm=0.14, diameter_mm=0.066, thickness_mm=0.01)

PRESET = many_spots(
    name="cmos-encoded-oblique",
    version=3,
    drawn_as=1,
    detector="CMOS",
    mask="Encoded",
    # light gathers behind such holes to about twice the open light: a shorter exposure
    sensor=behind(_MASK, 1.8, cmos(272, 0.01, sunlit_e=13_000.0), widest_deg=55.0),
    diameter_mm=0.066,
    half_fov_deg=50.0,
    directions=ConeField(50.0, calibration_samples=150, test_samples=150),
    follows=("Wei2017",),
    description=(
        "Seven sub-fields over a cone of 100 deg, each with an oblique, asymmetric group of "
        "holes (counts: Wei2017; dimensions and code are not known). Wei2017's detector reads "
        "sums over rows and columns; here whole frames are read. Assumed: 272 x 272 px of 10 "
        "um, 1.8 mm below groups of five holes of 0.066 mm (Fresnel number 1.1), 1.86 mm "
        "apart; no two holes share a row or column of cells of 0.14 mm. Foil and tolerances "
        "as in cmos-encoded."
    ),
)
