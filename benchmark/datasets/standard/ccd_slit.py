"""`ccd-slit`: two linear CCDs at right angles, a slit over each."""

from __future__ import annotations

from benchmark.datasets.conditions.line_arrays import SUN, behind, ccd, line_arrays, saturate
from benchmark.simulator.masks.slits import slit_row

_MASK = slit_row((0.0,), width_mm=0.1, length_mm=15.2, thickness_mm=0.01)
_SENSOR = behind(_MASK, 3.5, ccd(1024, 0.014), sun=SUN)

PRESET = line_arrays(
    name="ccd-slit",
    version=5,
    drawn_as=3,
    detector="CCD",
    mask="Slit",
    sensor=_SENSOR,
    half_fov_deg=60.0,
    follows=("Chum2003", "KeQiang2020", "Godard2006", "Enright2008a", "Enright2008c"),
    description=(
        "One slit over each of two linear CCDs at right angles; each array measures one "
        "angle. From Chum2003: lines of 2048 pixels, field +-60 deg. From KeQiang2020: slit "
        "deflection and inclination, which the slit model corrects. Slit and height are not "
        "published. Assumed: 1024 pixels of 14 um, 3.5 mm below a slit of 0.1 mm that is long "
        "enough for the whole field. The focal length counts to the middle of the foil."
    ),
    more={"saturated": saturate(_SENSOR)},
)
