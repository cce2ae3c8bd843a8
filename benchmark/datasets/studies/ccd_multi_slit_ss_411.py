"""`ccd-multi-slit-ss-411`: crossed pairs of slits over a line that an 8-bit processor reads."""

from __future__ import annotations

from dataclasses import replace

from benchmark.datasets.conditions.cone import ConeField
from benchmark.datasets.conditions.line_arrays import SUN, behind, ccd, line_arrays
from benchmark.simulator.masks.slits import crossed_pairs
from benchmark.simulator.optics.plates import CoverGlass, Plate

_MASK = crossed_pairs(4.6, (0.7, 0.9), width_mm=0.1, length_mm=8.2, thickness_mm=0.0)
_CCD = ccd(2048, 0.014)
_COARSE = replace(
    _CCD, gain_e_per_dn=16.0 * _CCD.gain_e_per_dn, offset_dn=_CCD.offset_dn / 16.0, bits=8
)
_FILTER = CoverGlass((Plate(1.0, 1.52),))
_HALF_DEG = 70.0

_SQUARE = line_arrays(
    name="ccd-multi-slit-ss-411",
    version=1,
    detector="CCD",
    mask="Multi-Slit",
    sensor=behind(_MASK, 1.8, _COARSE, axes=("x",), sun=SUN, glass=_FILTER),
    half_fov_deg=_HALF_DEG,
    follows=("Enright2007a",),
    description=(
        "Two pairs of narrow slits at right angles to each other over one linear array, whose "
        "peaks an 8-bit processor reads (Enright2007a's abstract; the peak position estimate has "
        "two peaks a pair). From the survey: a CCD. From its heir, the NFSS-411 (hardware C07): a "
        "field of 140 deg, slits in a metal film and a filter below them. Assumed: readings of 8 "
        "bits, as the processor; a filter of 1 mm, index 1.52; the rest as in ccd-multi-slit: "
        "slits of 0.1 mm, 1.8 mm above 2048 pixels of 14 um, which fit into the heir's housing of "
        "34 mm, spacings of 0.7 and 0.9 mm, 9.2 mm between the pairs."
    ),
)
PRESET = replace(
    _SQUARE,
    setups={"nominal": _SQUARE.setups["nominal"]},
    directions=ConeField(_HALF_DEG),
)
