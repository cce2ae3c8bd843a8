"""`ccd-multi-aperture`: an area CCD behind a foil with some hundred holes."""

from __future__ import annotations

from benchmark.datasets.conditions.many_spots import behind, many_spots
from benchmark.datasets.conditions.pixel_arrays import ccd
from benchmark.datasets.fields import AngleField
from benchmark.simulator.masks.apertures import Aperture
from benchmark.simulator.masks.layouts import grid

_MASK = grid(18, 18, 0.28, Aperture("round", 0.15, 0.15))


PRESET = many_spots(
    name="ccd-multi-aperture",
    version=1,
    detector="CCD",
    mask="Multi-Ap.",
    # the Sun's image is half a pixel wide at normal incidence: few points of it are enough
    sensor=behind(_MASK, 0.9, ccd(512, 0.015), directions_of_sun=48),
    diameter_mm=0.15,
    half_fov_deg=50.0,
    directions=AngleField(50.0, steps=11, test_samples=40),
    without=("hot",),
    follows=("Liebe2001", "Mobasser2001"),
    description=(
        "Full frames of 512 x 512 px behind 18 x 18 round holes. CCD, several hundred holes in one "
        "foil and less than 1 mm from foil to detector are those of Liebe2001 and Mobasser2001, "
        "which give no other size in what was mapped. Round numbers: holes of 0.15 mm stand 0.9 mm "
        "up (Fresnel number 11), 0.28 mm apart, so that spots of 10 px never touch and no two "
        "neighbours fall alike on the 15 um pixels. All 324 spots are whole on the detector over "
        "the field of +-50 deg, so that no direction looks like another one shifted by a hole. "
        "Holes are off by 1 um in position, 1 um in size (the unit as a whole) and 0.5 um an edge; "
        "the foil is thin. Pixels are those of ccd-single-aperture with 1 % gain spread; exposure "
        "keeps them below the full well: no blooming. Few samples, because a frame is 0.5 MB with "
        "324 spots to render. The Sun is sampled at 48 points: pixels are within 0.5 % of peak of "
        "a finer sampling."
    ),
)
