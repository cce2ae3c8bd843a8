"""`ccd-multi-slit`: one linear CCD behind two pairs of slits at right angles to each other."""

from __future__ import annotations

from benchmark.datasets.conditions.line_arrays import SUN, behind, ccd, line_arrays
from benchmark.simulator.masks.slits import crossed_pairs

_MASK = crossed_pairs(4.6, (0.7, 0.9), width_mm=0.1, length_mm=8.2, thickness_mm=0.0)

PRESET = line_arrays(
    name="ccd-multi-slit",
    version=5,
    drawn_as=3,
    detector="CCD",
    mask="Multi-Slit",
    sensor=behind(_MASK, 1.8, ccd(2048, 0.014), axes=("x",), sun=SUN),
    half_fov_deg=60.0,
    follows=("Enright2007a", "Enright2006b", "Enright2007b", "Enright2008b", "Radan2019"),
    description=(
        "Two pairs of narrow slits at right angles to each other over one linear CCD, as in the "
        "studies of the peak position estimate. Peaks of one pair move with tan(beta) - "
        "tan(alpha), those of the other with tan(beta) + tan(alpha). The sensors of these studies "
        "(SS-411, NFSS-411) have slits in a metal film under a window; no dimensions are "
        "published. Assumed: slits of 0.1 mm, 1.8 mm above 2048 pixels of 14 um; spacings of 0.7 "
        "and 0.9 mm distinguish the pairs; 9.2 mm between the pairs keeps their peaks apart over "
        "the whole field."
    ),
)
