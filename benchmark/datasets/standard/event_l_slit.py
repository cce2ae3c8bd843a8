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
    version=3,
    mask="L-Slit",
    sensor=_SENSOR,
    geometry=design(_SENSOR, 40.0, line_axes=("x", "y"), slits=_LINES),
    directions=AngleField(40.0, steps=13, test_samples=400),
    follows=("Farian2018", "Farian2022"),
    description=(
        "64 x 64 integrate-and-fire pixels in time-to-first-spike mode behind an L of two slits; "
        "the line along y tells x (beta), the one along x tells y (alpha). The studies followed "
        "give the architecture, no geometry in what was mapped, and no built sensor publishes "
        "one. Round numbers: pixels of 50 um (such pixels are large); slits of 0.15 mm 1 mm up "
        "have a Fresnel number of 10 and make lines three pixels wide, their sides as soft as 23 "
        "um; a web of 0.1 mm parts them; the corner lies 0.58 mm off both axes so that it stays "
        "on the array over +-40 deg with at least 25 pixels of either arm. The mask has no "
        "thickness (chrome on glass, its refraction left out). The array is reset after 384 "
        "events, which is all fully lit pixels and most of the lines' edges, or after 5 ms, "
        "before pixels in stray light fire. The bound is that of the times of the pixels that "
        "fire before the reset, with what the silence of the others tells."
    ),
)
