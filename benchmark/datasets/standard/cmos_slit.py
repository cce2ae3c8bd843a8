"""`cmos-slit`: a CMOS pixel array behind one slit."""

from __future__ import annotations

from benchmark.datasets.conditions import pixel_arrays as pixels
from benchmark.datasets.fields import AngleField
from benchmark.simulator.masks.layouts import slit

_MASK = slit(0.1, 0.72, thickness_mm=0.01)
_DETECTOR = pixels.cmos(512, 0.012, sunlit_e=16_000.0)
_SENSOR = pixels.window(_MASK, 1.2, _DETECTOR, window_px=(64, 96))

PRESET = pixels.windows(
    name="cmos-slit",
    version=6,
    drawn_as=4,
    detector="CMOS",
    mask="Slit",
    sensor=_SENSOR,
    setups={
        **pixels.pixel_conditions(_SENSOR),
        "inclined": pixels.incline(_SENSOR, slit(0.1, 0.72, 5.0, thickness_mm=0.01)),
    },
    geometry=pixels.design(_SENSOR, 60.0, aperture_width_mm=0.1),
    directions=AngleField(60.0),
    follows=("Chum2003",),
    description=(
        "Windows of 64 x 96 px of a 512 x 512 px array behind one slit along y. From Chum2003: a "
        "slit sensor of +-60 deg on CCD or CMOS, without dimensions; its two lines of pixels are "
        "one array here, so the ends of the slit give the second angle, less accurately. Assumed: "
        "a slit of 0.1 x 0.72 mm, 1.2 mm up in a foil of 10 um, 12 um pixels. The Fresnel number "
        "is 3.8: sides are 26 um soft. Windows are off the spot by up to 8 px per axis."
    ),
)
