"""`ccd-multi-aperture`: an area CCD behind a foil with some hundred holes."""

from __future__ import annotations

from dataclasses import replace

from benchmark.datasets.conditions.many_spots import behind, many_spots
from benchmark.datasets.conditions.pixel_arrays import ccd
from benchmark.datasets.fields import AngleField
from benchmark.simulator.masks.apertures import Aperture
from benchmark.simulator.masks.layouts import grid

_MASK = grid(18, 18, 0.235, Aperture("round", 0.05, 0.05))
# light gathers behind such holes to 1.9 times the open light: the exposure is shorter for it
_SENSOR = behind(_MASK, 0.75, replace(ccd(512, 0.012), sunlit_e=40_000.0), widest_deg=61.0)

PRESET = many_spots(
    name="ccd-multi-aperture",
    version=5,
    detector="CCD",
    mask="Multi-Ap.",
    sensor=_SENSOR,
    diameter_mm=0.05,
    half_fov_deg=50.0,
    directions=AngleField(50.0, steps=11, test_samples=40),
    without=("hot",),
    follows=("Liebe2001", "Mobasser2001"),
    description=(
        "Full frames of 512 x 512 px behind 18 x 18 round holes. A CCD, several hundred holes in "
        "one foil and 0.75 mm from foil to detector are those of Liebe2001; holes of 50 um in a "
        "film of metal, which counts as thin, are those of the JPL sensor that was qualified for "
        "flight later. Round numbers without a model: 12 um pixels, and holes 0.235 mm apart, so "
        "that no two neighbours fall alike on them. The Fresnel number is 1.5: light gathers to "
        "1.9 times the open light in spots four pixels wide, each with a faint skirt that reaches "
        "its neighbours. All 324 spots are whole on the detector over the field of +-50 deg, so "
        "that no direction looks like another one shifted by a hole. Holes are off by 1 um in "
        "position, 1 um in size (the unit as a whole) and 0.5 um an edge. Pixels are those of "
        "ccd-single-aperture with 1 % gain spread; exposure keeps them below the full well: no "
        "blooming. Few samples, because a frame is 0.5 MB with 324 spots to render."
    ),
)
