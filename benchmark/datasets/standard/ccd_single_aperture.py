"""`ccd-single-aperture`: an area CCD behind one square aperture."""

from __future__ import annotations

from benchmark.datasets.conditions import pixel_arrays as pixels
from benchmark.datasets.conditions.motion import spin
from benchmark.datasets.fields import AngleField
from benchmark.simulator.masks.apertures import Aperture, Mask

_MASK = Mask((Aperture("rectangle", 0.2, 0.2),), thickness_mm=0.01)
_SENSOR = pixels.window(_MASK, 2.0, pixels.ccd(512, 0.013, prnu=0.005))


PRESET = pixels.windows(
    name="ccd-single-aperture",
    version=6,
    drawn_as=4,
    detector="CCD",
    mask="Single-Ap.",
    sensor=_SENSOR,
    setups={**pixels.pixel_conditions(_SENSOR), "spinning": spin(_SENSOR, rolls=False)},
    geometry=pixels.design(_SENSOR, 50.0, aperture_width_mm=0.2, aperture_shape="square"),
    directions=AngleField(50.0),
    follows=(),
    description=(
        "Windows of 64 x 64 px of a 512 x 512 px CCD behind one square hole. No mapped study "
        "and no known sensor pairs a CCD with a single aperture; it separates the effect of "
        "the detector from that of the mask, beside cmos-single-aperture. Assumed: 13 um "
        "pixels of 100,000 electrons, 0.5 % gain spread, read noise of 20 electrons, 12 bits; "
        "a hole of 0.2 mm in a foil of 10 um, 2 mm up; field +-50 deg. The Fresnel number is "
        "9: edges are 33 um soft. Exposure keeps pixels below the full well."
    ),
)
