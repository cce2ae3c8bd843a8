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
    version=4,
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
        "96 x 96 px windows of a 512 x 512 px array behind two slits at right angles, one an "
        "axis: the one along y tells x (beta), the one along x tells y (alpha). Slits, pixel "
        "array and windowed read-out are those of Jing2016, which gives no dimensions in what was "
        "mapped. Round numbers: slits of 0.1 mm by 0.57 mm, 1.2 mm up in a foil of 10 um, within "
        "what such slits have (tens of um to 0.2 mm), have a Fresnel number of 3.8 and sides as "
        "soft as 26 um; a web of 0.1 mm where the L's corner would be keeps the foil in one piece "
        "(light that both slits share is left out: the Sun is coherent over some 60 um only); "
        "512 px hold both at 60 deg. Windows miss the true spot by up to 8 whole px an axis."
    ),
    more=seen_with(_SENSOR, "albedo-clouds", "ghosts"),
)
