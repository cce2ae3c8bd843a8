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
    version=7,
    drawn_as=5,
    detector="CCD",
    mask="Multi-Ap.",
    sensor=_SENSOR,
    diameter_mm=0.05,
    half_fov_deg=50.0,
    directions=AngleField(50.0, steps=11, test_samples=40),
    without=("hot",),
    follows=("Liebe2001", "Mobasser2001"),
    description=(
        "Full frames of 512 x 512 px behind 18 x 18 round holes. From Liebe2001: a CCD, "
        "several hundred holes in one foil, 0.75 mm from foil to detector. From the later JPL "
        "sensor: holes of 50 um in a thin metal film. Assumed: 12 um pixels, holes 0.235 mm "
        "apart, tolerances of 1 um in position, 1 um in size (per unit) and 0.5 um per edge. "
        "The Fresnel number is 1.5: spots are four pixels wide and their peak is 1.9 times "
        "the open light. All 324 spots stay on the detector over +-50 deg. Exposure keeps "
        "pixels below the full well."
    ),
)
