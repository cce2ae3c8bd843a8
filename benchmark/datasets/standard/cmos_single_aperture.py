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
    version=4,
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
        "64 x 64 px windows of a 512 x 512 px array behind one round hole. 512 px are the "
        "micro-DSS's (Xie2012, the paper's predecessor Xie2010), pixels of 6.5 um its flown "
        "heir's (TNO miniDSS: 368 px of 6.5 um, 102 deg), a hole of 0.1 mm that of Foresail-1p, "
        "the one such sensor that publishes it. None publishes the height: 0.75 mm, near the 0.97 "
        "mm that miniDSS cannot exceed, so that the array holds the spot at 60 deg. Its Fresnel "
        "number is 6: the spot is a shadow whose edge is as soft as it is wide, some 15 px "
        "(Xie2010: about 10), drawn out at the field's edge. Windows are placed from the true "
        "spot, rounded, plus a uniform whole offset of up to 8 px an axis."
    ),
)
