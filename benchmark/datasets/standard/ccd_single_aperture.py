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
    version=4,
    detector="CCD",
    mask="Single-Ap.",
    sensor=_SENSOR,
    setups={**pixels.pixel_conditions(_SENSOR), "spinning": spin(_SENSOR, rolls=False)},
    geometry=pixels.design(_SENSOR, 50.0, aperture_width_mm=0.2, aperture_shape="square"),
    directions=AngleField(50.0),
    follows=(),
    description=(
        "64 x 64 px windows of a 512 x 512 px CCD behind one square hole. No mapped study pairs a "
        "CCD with a single aperture and no built sensor is known that does; it stands beside "
        "cmos-single-aperture to tell the detector from the mask, with a square hole as one "
        "quadrant sensor has it (Caltech's, which gives no size). Round numbers: 13 um pixels "
        "with deep wells (100,000 electrons), 0.5 % gain spread, 20 electrons of read noise and "
        "12 bits, as area CCDs have; a 0.2 mm hole in a foil of 10 um, 2 mm up, its sides along "
        "the pixel rows: a Fresnel number of 9, edges as soft as 33 um; 512 px hold the spot at "
        "50 deg. Exposure keeps pixels below the full well: no blooming."
    ),
)
