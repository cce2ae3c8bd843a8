"""`pd-single-aperture`: four photodiodes on one die under a window in their cover glass."""

from __future__ import annotations

from dataclasses import replace

from benchmark.datasets.conditions import masked_photodiodes as diodes
from benchmark.datasets.conditions import other_light
from benchmark.datasets.conditions.alignment import careful_alignment, misalign
from benchmark.datasets.conditions.propagation import GLASS, measured_geometric

_CAMERA = diodes.through(
    diodes.rectangular_opening(0.8, 0.8), 0.5, careful_alignment(0.002, 0.002, -0.0015), GLASS
)
_SENSOR = diodes.quadrants(_CAMERA, half_width_mm=0.8, gap_mm=0.02)
_NOMINAL = "Almost no tilt, 2 um of glue, 1 % gain mismatch, noise of 2e-4 of full sunlight."
_OFF = "12 um of glue, window 20 and -15 um off centre"

PRESET = diodes.masked_photodiodes(
    name="pd-single-aperture",
    version=5,
    drawn_as=3,
    detector="PD",
    mask="Single-Ap.",
    readings=f"photodiodes {diodes.QUADRANTS}",
    geometry=replace(diodes.design(_SENSOR, 60.0, width_mm=0.8), cover_glass=((0.5, 1.52),)),
    setups={
        **diodes.usual(_SENSOR, _NOMINAL, _OFF, misalign(0.012, 0.02, -0.015)),
        **diodes.temperatures(_SENSOR),
        "albedo": other_light.with_albedo(_SENSOR),
    },
    follows=("Ortega2009", "Ortega2010"),
    description=(
        "Four photodiodes on one die under a metallised cover glass with one window, field "
        "+-60 deg (Ortega2010). Sizes are not known. Assumed: glass of 0.5 mm (index 1.52), "
        "directly on the die; a window of 0.8 mm, with which light reaches all four "
        "photodiodes up to 60 deg."
    ),
    regime=measured_geometric(0.01, (1.0, 1.0, 1.01)),
)
