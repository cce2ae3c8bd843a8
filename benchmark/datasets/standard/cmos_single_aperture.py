"""`cmos-single-aperture`: a CMOS pixel array behind one round aperture."""

from __future__ import annotations

from benchmark.datasets.conditions import pixel_arrays as pixels
from benchmark.datasets.conditions.alignment import careful
from benchmark.datasets.conditions.propagation import geometric
from benchmark.datasets.fields import AngleField

_MASK = pixels.hole(0.2, 0.01)
_SENSOR = pixels.windowed(_MASK, 1.2, pixels.cmos(512, 0.012), assembly=careful(0.002))
_ALSO, _OFF = ", read noise of one digital number", "aperture four pixels off centre"

PRESET = pixels.windows(
    name="cmos-single-aperture",
    version=1,
    detector="CMOS",
    mask="Single-Ap.",
    sensor=_SENSOR,
    setups={
        **pixels.pixel_conditions(_SENSOR, careful_also=_ALSO, off_centre=_OFF),
        "glass": pixels.glass(_SENSOR, "refraction pulls the spot inwards, reflection dims it"),
    },
    geometry=pixels.design(_SENSOR, 60.0, aperture_width_mm=0.2, aperture_shape="round"),
    directions=AngleField(60.0),
    follows=("Chang2008", "Rufino2017", "Xie2012"),
    description=(
        "64 x 64 px windows of a 512 x 512 px array behind one round hole. The studies followed "
        "give the architecture, no full geometry; the one published pinhole (Antonello2018: 20 um "
        "at 7 mm) is diffraction-limited. Round numbers instead: a 0.2 mm hole 1.2 mm up keeps the "
        "Fresnel number at 15; 12 um pixels make the spot 17 px wide, inside the 21 px regions of "
        "windowed centroids (Xie2014); 512 px hold the spot at 60 deg; the foil is 10 um thick. "
        "Windows are placed from the true spot, rounded, plus a uniform whole offset of up to 8 px "
        "an axis. The focal length counts to the middle of the foil."
    ),
    regime=geometric(0.2, 1.2),
)
