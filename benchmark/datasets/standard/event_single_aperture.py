"""`event-single-aperture`: a time-to-first-spike array behind one round hole."""

from __future__ import annotations

from benchmark.datasets.conditions.event_arrays import behind, design, event_array
from benchmark.datasets.conditions.pixel_arrays import hole
from benchmark.datasets.fields import AngleField

_SENSOR = behind(hole(0.1, 0.01), 0.6, events=20, pitch_mm=0.025)

PRESET = event_array(
    name="event-single-aperture",
    version=6,
    drawn_as=4,
    mask="Single-Ap.",
    sensor=_SENSOR,
    geometry=design(_SENSOR, 50.0, aperture_width_mm=0.1, aperture_shape="round"),
    directions=AngleField(50.0, steps=21),
    follows=("Bardallo2017a", "Bardallo2017b", "Merchan2023"),
    description=(
        "64 x 64 integrate-and-fire pixels in time-to-first-spike mode behind one round hole "
        "(Bardallo2017a, Bardallo2017b, Merchan2023, without dimensions). Assumed: pixels of "
        "25 um, a hole of 0.1 mm (Foresail-1p's), 0.6 mm up; field +-50 deg. The spot lights "
        "about twenty pixels. The array is reset after 20 events or 5 ms, before pixels in "
        "stray light fire. The bound uses the times of all pixels that fire before the reset, "
        "and the silence of the others."
    ),
)
