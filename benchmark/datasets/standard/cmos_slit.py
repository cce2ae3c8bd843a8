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
    version=4,
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
        "64 x 96 px windows (columns x rows) of a 512 x 512 px array behind one slit along y. "
        "Chum2003 is a slit sensor of +-60 deg on CCD or CMOS; it gives no width and no height in "
        "what was mapped, and its two lines of pixels are an area array here, so that the slit's "
        "ends give the second angle, less well than its sides give the first. Round numbers: a "
        "slit of 0.1 mm by 0.72 mm, 1.2 mm up in a foil of 10 um, within what such slits have "
        "(tens of um to 0.2 mm), has a Fresnel number of 3.8 and sides as soft as 26 um; 12 um "
        "pixels make it 8 by 60 px; 512 px hold it at 60 deg. Windows are placed from the true "
        "spot, rounded, plus a uniform whole offset of up to 8 px an axis."
    ),
)
