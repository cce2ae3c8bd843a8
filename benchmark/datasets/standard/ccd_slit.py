"""`ccd-slit`: two linear CCDs at right angles, a slit over each."""

from __future__ import annotations

from benchmark.datasets.conditions.line_arrays import SUN, behind, ccd, line_arrays, saturate
from benchmark.simulator.masks.slits import slit_row

_MASK = slit_row((0.0,), width_mm=0.1, length_mm=15.2, thickness_mm=0.01)
_SENSOR = behind(_MASK, 3.5, ccd(1024, 0.014), sun=SUN)

PRESET = line_arrays(
    name="ccd-slit",
    version=3,
    detector="CCD",
    mask="Slit",
    sensor=_SENSOR,
    half_fov_deg=60.0,
    follows=("Chum2003", "KeQiang2020", "Godard2006", "Enright2008a", "Enright2008c"),
    description=(
        "One slit over each of two linear CCDs at right angles (Chum2003), with the slit "
        "deflection and inclination that the slit model corrects (KeQiang2020). Chum2003 has lines "
        "of 2048 pixels and a field of +-60 deg; nobody publishes slit or height. Here 1024 pixels "
        "of 14 um, 14 mm as 2048 of 7 um would be, which the light fills at 3.5 mm; a slit of 0.1 "
        "mm, twice what light spreads there, as a narrower one gains no sharper a spot. The slit "
        "is as long as the Sun needs at the edge of the field. The focal length counts to the "
        "middle of the foil. Each array measures one angle; together they see both."
    ),
    more={"saturated": saturate(_SENSOR)},
)
