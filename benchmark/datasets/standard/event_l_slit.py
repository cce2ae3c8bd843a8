"""`event-l-slit`: a time-to-first-spike array behind two slits that cast an L."""

from __future__ import annotations

from benchmark.datasets.conditions.event_arrays import behind, design, event_array
from benchmark.datasets.fields import AngleField
from benchmark.simulator.masks.layouts import l_slit

#: The L's corner lies over (-_CORNER_MM, -_CORNER_MM); its arms are _ARM_MM long.
_CORNER_MM, _ARM_MM, _WIDTH_MM, _WEB_MM = 0.58, 3.2, 0.15, 0.1
# the arm along y holds the corner, the other one begins a web beyond it
_SHORT_MM = _ARM_MM - _WIDTH_MM - _WEB_MM
_MASK = l_slit(
    _WIDTH_MM,
    -_CORNER_MM,
    along_y_mm=(-_CORNER_MM + (_ARM_MM - _WIDTH_MM) / 2.0, _ARM_MM),
    along_x_mm=(-_CORNER_MM + (_ARM_MM + _WEB_MM) / 2.0, _SHORT_MM),
)
_SENSOR = behind(_MASK, 1.0, events=384)
_LINES = ((-_CORNER_MM, 0.0, _WIDTH_MM),)

PRESET = event_array(
    name="event-l-slit",
    version=6,
    drawn_as=4,
    mask="L-Slit",
    sensor=_SENSOR,
    geometry=design(_SENSOR, 40.0, line_axes=("x", "y"), slits=_LINES),
    directions=AngleField(40.0, steps=13, test_samples=400),
    follows=("Farian2018", "Farian2022"),
    description=(
        "64 x 64 integrate-and-fire pixels in time-to-first-spike mode behind an L of two "
        "slits: the line along y gives beta, the one along x gives alpha (Farian2018, "
        "Farian2022, without dimensions). Assumed: pixels of 50 um, slits of 0.15 mm, 1 mm "
        "up, 0.1 mm apart, the corner 0.58 mm off both axes; field +-40 deg. Lines are three "
        "pixels wide. The array is reset after 384 events or 5 ms, before pixels in stray "
        "light fire. The bound uses the times of all pixels that fire before the reset, and "
        "the silence of the others."
    ),
)
