"""`pda-multi-slit`: two linear photodiode arrays at right angles, five slits over each."""

from __future__ import annotations

from benchmark.datasets.conditions.line_arrays import behind, line_arrays, photodiode_array
from benchmark.simulator.masks.slits import slit_row

_PLACES_MM = (-1.1, -0.6, 0.0, 0.7, 1.5)
_MASK = slit_row(_PLACES_MM, width_mm=0.2, length_mm=4.6, thickness_mm=0.05)

PRESET = line_arrays(
    name="pda-multi-slit",
    version=5,
    drawn_as=3,
    detector="PDA",
    mask="Multi-Slit",
    sensor=behind(_MASK, 1.2, photodiode_array(144, 0.05, bits=8), fill_factor=0.9),
    half_fov_deg=51.5,
    follows=("Bolshakov2020",),
    description=(
        "Five slits over a linear photodiode array, one per axis (Bolshakov2020, "
        "model:mslit). From reports of it: field +-51.5 deg, growing distances between slits. "
        "Assumed: 144 pixels of 50 um, 1.2 mm below slits of 0.2 mm, at distances of 0.5, "
        "0.6, 0.7 and 0.8 mm; 8 bits (Diriker2021, same laboratory). One edge of each spot "
        "comes from the lower rim of the foil, the other from the upper rim; the focal length "
        "counts to the middle."
    ),
)
