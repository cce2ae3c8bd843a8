"""`ccd-vernier`: two linear CCDs at right angles as fixed scales of an optical vernier."""

from __future__ import annotations

from benchmark.datasets.conditions.line_arrays import behind, ccd, line_arrays
from benchmark.simulator.masks.slits import periodic, without

_RULER = periodic(16, 0.32, width_mm=0.15, length_mm=5.8, thickness_mm=0.01)

PRESET = line_arrays(
    name="ccd-vernier",
    version=5,
    drawn_as=3,
    detector="CCD",
    mask="Encoded",
    sensor=behind(without(_RULER, (2, 11)), 1.0, ccd(104, 0.1), fill_factor=0.9),
    half_fov_deg=64.0,
    follows=("Chen2006",),
    description=(
        "An optical vernier (Chen2006): slits 0.32 mm apart over marks of three pixels each, "
        "16/15 of a mark apart, so that slits cross the marks one after the other. Two of 16 "
        "slits are left out as position code. From Chen2006: field +-64 deg, few large "
        "pixels. Assumed: slits of 0.15 mm, 1 mm above 104 pixels of 0.1 mm, 90 % of each "
        "sensitive."
    ),
)
