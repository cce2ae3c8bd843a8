"""`cmos-l-slit`: a CMOS pixel array behind two slits at right angles."""

from __future__ import annotations

from benchmark.datasets.conditions import pixel_arrays as pixels
from benchmark.datasets.conditions.other_light import seen_with
from benchmark.datasets.fields import AngleField
from benchmark.simulator.masks.layouts import l_slit

#: The slits' middle lines lie at -_LINE_MM; each begins 0.1 mm beyond the other one's near side.
_LINE_MM = 0.3
_MIDDLE_MM = -_LINE_MM + 0.1 / 2.0 + 0.1 + 0.57 / 2.0
_MASK = l_slit(0.1, -_LINE_MM, (_MIDDLE_MM, 0.57), (_MIDDLE_MM, 0.57), thickness_mm=0.01)
_DETECTOR = pixels.cmos(512, 0.012, sunlit_e=16_000.0)
_SENSOR = pixels.window(_MASK, 1.2, _DETECTOR, window_px=(96, 96))

PRESET = pixels.windows(
    name="cmos-l-slit",
    version=6,
    drawn_as=4,
    detector="CMOS",
    mask="L-Slit",
    sensor=_SENSOR,
    setups=pixels.pixel_conditions(_SENSOR),
    geometry=pixels.design(
        _SENSOR, 60.0, line_axes=("x", "y"), slits=((-_LINE_MM, 0.0, 0.1),), mask_thickness_mm=0.01
    ),
    directions=AngleField(60.0, steps=13, test_samples=400),
    follows=("Jing2016",),
    description=(
        "Windows of 96 x 96 px of a 512 x 512 px array behind an L of two slits: the one along y "
        "gives beta, the one along x gives alpha. From Jing2016: slits, pixel array, windowed "
        "read-out; no dimensions. Assumed: slits of 0.1 x 0.57 mm, 1.2 mm up in a foil of 10 um, "
        "0.1 mm apart at the corner; field +-60 deg. The Fresnel number is 3.8: sides are 26 um "
        "soft. Windows are off the spot by up to 8 px per axis."
    ),
    more=seen_with(_SENSOR, "albedo-clouds", "ghosts"),
)
