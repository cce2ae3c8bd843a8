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
    version=5,
    detector="CMOS",
    mask="Multi-Ap.",
    sensor=_SENSOR,
    diameter_mm=0.1,
    half_fov_deg=60.0,
    directions=AngleField(60.0, steps=11, test_samples=60),
    without=("hot",),
    follows=("Rufino2009b", "Rufino2012", "Mobasser2003"),
    description=(
        "Full frames of 1024 x 1024 px behind 10 x 10 round holes. The count and a CMOS array with "
        "a 10-bit converter are those of Rufino2009b, which gives no other size in what was "
        "mapped. Others do: holes of 0.1 mm are those of the Foresail-1p sensor, and make spots "
        "ten pixels wide, as the TU Delft chip's are (Xie2010); JPL's pinholes stand 0.5 to 1 mm "
        "up (Mobasser2003 0.5 mm), here 1 mm. Round numbers without a model: a foil of 10 um, a "
        "pitch of 0.833 mm, so that no two spots of a row fall alike on the 10 um pixels. At a "
        "Fresnel number of 4.5 spots have bright rings of 1.4 times the open light at normal "
        "incidence; at the field's edge, where the foil's rims leave half of a hole, they are "
        "ovals six times as dim. All 100 spots are whole on the detector up to 50 deg in either "
        "angle (S-FOV), 90 of 100 with one angle and 81 with both at 60 deg, the field's edge "
        "(X-FOV). Holes are off by 1 um in position, 1 um in size (the unit as a whole) and 0.5 um "
        "an edge. Few samples, because a frame is 2 MB."
    ),
    # every spot is whole on the detector up to 50 deg (S-FOV); beyond, fewer are (X-FOV)
    regime={"all_spots_half_fov_deg": 50.0, "some_spots_half_fov_deg": 60.0},
)
