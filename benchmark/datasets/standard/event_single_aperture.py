"""`event-single-aperture`: a time-to-first-spike array behind one round hole."""

from __future__ import annotations

from benchmark.datasets.conditions.event_arrays import behind, design, event_array
from benchmark.datasets.conditions.pixel_arrays import hole
from benchmark.datasets.fields import AngleField

_SENSOR = behind(hole(0.1, 0.01), 0.6, events=20, pitch_mm=0.025)

PRESET = event_array(
    name="event-single-aperture",
    version=3,
    mask="Single-Ap.",
    sensor=_SENSOR,
    geometry=design(_SENSOR, 50.0, aperture_width_mm=0.1, aperture_shape="round"),
    directions=AngleField(50.0, steps=21, test_samples=1000),
    follows=("Bardallo2017a", "Bardallo2017b", "Merchan2023"),
    description=(
        "64 x 64 integrate-and-fire pixels in time-to-first-spike mode behind one round hole. The "
        "studies followed give the architecture, no geometry in what was mapped, and no built "
        "sensor publishes one. Round numbers: pixels of 25 um (such pixels are large); a 0.1 mm "
        "hole, as Foresail-1p's, 0.6 mm up lights about twenty of them, its edge as soft as 18 um "
        "and, at the field's edge, 35 um; 64 of them hold the spot at 50 deg. The array is reset "
        "after 20 events or "
        "after 5 ms, before pixels in stray light fire. The bound is that of the times of the "
        "pixels that fire before the reset, with what the silence of the others tells."
    ),
)
