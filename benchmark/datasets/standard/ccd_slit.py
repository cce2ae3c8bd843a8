"""`ccd-slit`: two linear CCDs at right angles, a slit over each."""

from __future__ import annotations

from benchmark.datasets.conditions.line_arrays import SUN, behind, ccd, line_arrays, saturated
from benchmark.simulator.masks.slits import slit_row

_MASK = slit_row((0.0,), width_mm=0.25, length_mm=10.4, thickness_mm=0.01)
_SENSOR = behind(_MASK, 2.5, ccd(1024, 0.014), sun=SUN)

PRESET = line_arrays(
    name="ccd-slit",
    version=1,
    detector="CCD",
    mask="Slit",
    sensor=_SENSOR,
    half_fov_deg=60.0,
    follows=("Chum2003", "KeQiang2020", "Godard2006", "Enright2008a", "Enright2008c"),
    description=(
        "One slit over each of two linear CCDs at right angles (Chum2003), with the slit "
        "deflection and inclination that the slit model corrects (KeQiang2020). The studies "
        "followed give the arrangement, no full geometry. Round numbers instead: a 0.25 mm slit "
        "2.5 mm up keeps the Fresnel number above 10; 1024 pixels of 14 um hold the light at 60 "
        "deg; the slit is as long as the Sun needs at the edge of the field. The focal length "
        "counts to the middle of the foil. Each array measures one angle; together they see both."
    ),
    more={"saturated": saturated(_SENSOR)},
)
