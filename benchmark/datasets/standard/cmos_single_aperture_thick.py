"""`cmos-single-aperture-thick`: a CMOS pixel array behind one hole through a thick mask."""

from __future__ import annotations

from dataclasses import replace

from benchmark.datasets.conditions import pixel_arrays as pixels
from benchmark.datasets.fields import AngleField

_MASK = pixels.hole(0.1, 0.05)
_SENSOR = pixels.window(_MASK, 0.75, pixels.cmos(512, 0.0065, sunlit_e=14_000.0))
_ALSO, _OFF = ", read noise of one digital number", "aperture eight and six pixels off centre"

PRESET = pixels.windows(
    name="cmos-single-aperture-thick",
    version=3,
    drawn_as=1,
    detector="CMOS",
    mask="Single-Ap.",
    sensor=_SENSOR,
    setups=pixels.pixel_conditions(_SENSOR, careful_also=_ALSO, off_centre=_OFF),
    geometry=replace(
        pixels.design(_SENSOR, 50.0, aperture_width_mm=0.1, aperture_shape="round"),
        mask_thickness_mm=0.05,
    ),
    directions=AngleField(50.0),
    follows=("Antonello2018",),
    description=(
        "The sensor of cmos-single-aperture with a mask half as thick as its hole is wide, "
        "which shades its own hole: lit is where the shadows of both rims overlap "
        "(model:shad, Antonello2018). At 45 deg half of the width is left, at 63.4 deg none; "
        "the field ends at 50 deg per axis. Antonello2018's own pinhole "
        "(cmos-single-aperture-pinhole) is too small for such shadows; here the hole is 0.1 "
        "mm at 0.75 mm. Light is diffracted at the open part."
    ),
)
