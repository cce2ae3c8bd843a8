"""`ccd-multi-slit`: one linear CCD behind two pairs of slits at right angles to each other."""

from __future__ import annotations

from benchmark.datasets.conditions.line_arrays import SUN, behind, ccd, line_arrays
from benchmark.simulator.masks.slits import crossed_pairs

_MASK = crossed_pairs(4.6, (0.7, 0.9), width_mm=0.1, length_mm=8.2, thickness_mm=0.0)

PRESET = line_arrays(
    name="ccd-multi-slit",
    version=3,
    detector="CCD",
    mask="Multi-Slit",
    sensor=behind(_MASK, 1.8, ccd(2048, 0.014), axes=("x",), sun=SUN),
    half_fov_deg=60.0,
    follows=("Enright2007a", "Enright2006b", "Enright2007b", "Enright2008b", "Radan2019"),
    description=(
        "Two pairs of narrow slits at right angles to each other over one linear CCD, as the "
        "studies of the peak position estimate describe: the peaks of one pair move with tan(beta) "
        "- tan(alpha), those of the other with tan(beta) + tan(alpha), both at 45 deg to the "
        "array. The sensors they are about (SS-411, NFSS-411 after it) have slits etched into a "
        "metal film under a window; nobody publishes dimensions. Round numbers instead: slits of "
        "0.1 mm, two or three times what light spreads 1.8 mm below; spacings of 0.7 and 0.9 mm "
        "tell the pairs apart; 9.2 mm between the pairs keep their slits from crossing in the "
        "mask, and so their peaks from overlapping anywhere in the field (image type 0 of "
        "alg:PPE); 2048 pixels of 14 um hold them."
    ),
)
