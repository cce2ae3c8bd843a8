"""`cmos-multi-aperture`: a large CMOS pixel array behind a 10 x 10 grid of holes."""

from __future__ import annotations

from benchmark.datasets.conditions.many_spots import behind, many_spots
from benchmark.datasets.conditions.pixel_arrays import cmos
from benchmark.datasets.fields import AngleField
from benchmark.simulator.masks.apertures import Aperture
from benchmark.simulator.masks.layouts import grid

_MASK = grid(10, 10, 0.833, Aperture("round", 0.1, 0.1), thickness_mm=0.01)
# bright rings of diffraction have 1.4 times the open light: the exposure is shorter for them
_SENSOR = behind(_MASK, 1.0, cmos(1024, 0.01, sunlit_e=16_000.0), widest_deg=69.0)

PRESET = many_spots(
    name="cmos-multi-aperture",
    version=7,
    drawn_as=5,
    detector="CMOS",
    mask="Multi-Ap.",
    sensor=_SENSOR,
    diameter_mm=0.1,
    half_fov_deg=60.0,
    directions=AngleField(60.0, steps=11, test_samples=60),
    without=("hot",),
    follows=("Rufino2009b", "Rufino2012", "Mobasser2003"),
    description=(
        "Full frames of 1024 x 1024 px behind 10 x 10 round holes. From Rufino2009b: the "
        "number of holes, a CMOS array, 10 bits. From Foresail-1p: holes of 0.1 mm. Height 1 "
        "mm (JPL 0.5 to 1 mm, Mobasser2003). Assumed: 10 um pixels, foil of 10 um, pitch "
        "0.833 mm, tolerances of 1 um in position, 1 um in size (per unit) and 0.5 um per "
        "edge. The Fresnel number is 4.5. All 100 spots are visible up to 50 deg in each "
        "angle (S-FOV); at 60 deg, the edge of the field, 90 or 81 (X-FOV), and spots are six "
        "times as dim."
    ),
    # every spot is whole on the detector up to 50 deg (S-FOV); beyond, fewer are (X-FOV)
    regime={"all_spots_half_fov_deg": 50.0, "some_spots_half_fov_deg": 60.0},
)
