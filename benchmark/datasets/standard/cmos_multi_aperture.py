"""`cmos-multi-aperture`: a large CMOS pixel array behind a 10 x 10 grid of holes."""

from __future__ import annotations

from benchmark.datasets.conditions.many_spots import behind, many_spots
from benchmark.datasets.conditions.pixel_arrays import cmos
from benchmark.datasets.fields import AngleField
from benchmark.simulator.masks.apertures import Aperture
from benchmark.simulator.masks.layouts import grid

_MASK = grid(10, 10, 0.833, Aperture("round", 0.16, 0.16), thickness_mm=0.01)


PRESET = many_spots(
    name="cmos-multi-aperture",
    version=1,
    detector="CMOS",
    mask="Multi-Ap.",
    # the Sun's image is one pixel wide at normal incidence, seven at the field's corners
    sensor=behind(_MASK, 1.0, cmos(1024, 0.01), directions_of_sun=112),
    diameter_mm=0.16,
    half_fov_deg=60.0,
    directions=AngleField(60.0, steps=11, test_samples=60),
    without=("hot",),
    follows=("Rufino2009b", "Rufino2012", "Mobasser2003"),
    description=(
        "Full frames of 1024 x 1024 px behind 10 x 10 round holes, the count of Rufino2009b, which "
        "gives no other size in what was mapped. Round numbers: holes of 0.16 mm stand 1 mm up "
        "(Fresnel number 12; Mobasser2003 has 0.5 mm), 0.833 mm apart, so that spots of 16 px "
        "never touch and no two of a row fall alike on the 10 um pixels. All 100 spots are whole "
        "on the detector up to 50 deg in either angle (S-FOV), 90 of 100 with one angle and 81 "
        "with both at 60 deg, the field's edge (X-FOV). Holes are off by 1 um in position, 1 um in "
        "size (the unit as a whole) and 0.5 um an edge. Few samples, because a frame is 2 MB. The "
        "Sun is sampled at 112 points: pixels are within 0.5 % of peak of a finer sampling over "
        "the whole field."
    ),
    # every spot is whole on the detector up to 50 deg (S-FOV); beyond, fewer are (X-FOV)
    regime={"all_spots_half_fov_deg": 50.0, "some_spots_half_fov_deg": 60.0},
)
