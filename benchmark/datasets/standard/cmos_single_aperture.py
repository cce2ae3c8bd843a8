"""`cmos-single-aperture`: a CMOS pixel array behind one round aperture."""

from __future__ import annotations

from benchmark.datasets.conditions import pixel_arrays as pixels
from benchmark.datasets.conditions.motion import spin
from benchmark.datasets.fields import AngleField

_MASK = pixels.hole(0.1, 0.01)
_SENSOR = pixels.window(_MASK, 0.75, pixels.cmos(512, 0.0065, sunlit_e=14_000.0))
_ALSO, _OFF = ", read noise of one digital number", "aperture eight and six pixels off centre"

PRESET = pixels.windows(
    name="cmos-single-aperture",
    version=6,
    drawn_as=4,
    detector="CMOS",
    mask="Single-Ap.",
    sensor=_SENSOR,
    setups={
        **pixels.pixel_conditions(_SENSOR, careful_also=_ALSO, off_centre=_OFF),
        "glass": pixels.glass(_SENSOR, "refraction pulls the spot inwards, reflection dims it"),
        "spinning": spin(_SENSOR, rolls=True),
    },
    geometry=pixels.design(_SENSOR, 60.0, aperture_width_mm=0.1, aperture_shape="round"),
    directions=AngleField(60.0),
    follows=("Chang2008", "Xie2012"),
    description=(
        "Windows of 64 x 64 px of a 512 x 512 px array behind one round hole. From the TU Delft "
        "micro-DSS (Xie2012): 512 px. From its successor, the TNO miniDSS: pixels of 6.5 um. From "
        "Foresail-1p: a hole of 0.1 mm. Height 0.75 mm, assumed below the 0.97 mm that the "
        "miniDSS's field permits; field +-60 deg. The Fresnel number is 6: the spot is a soft "
        "shadow some 15 px wide (Xie2010: about 10). Windows are off the spot by up to 8 px per "
        "axis."
    ),
)
