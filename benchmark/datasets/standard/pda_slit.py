"""`pda-slit`: two linear photodiode arrays at right angles, a slit over each."""

from __future__ import annotations

from benchmark.datasets.conditions.line_arrays import behind, line_arrays, photodiode_array
from benchmark.simulator.masks.slits import slit_row

_MASK = slit_row((0.0,), width_mm=0.3, length_mm=10.8, thickness_mm=0.02)

PRESET = line_arrays(
    name="pda-slit",
    version=1,
    detector="PDA",
    mask="Slit",
    sensor=behind(_MASK, 2.5, photodiode_array(256, 0.05), pixel_height_mm=0.5, fill_factor=0.9),
    half_fov_deg=60.0,
    follows=("Alvi2014", "Diriker2021", "Strietzel2002"),
    description=(
        "Two linear photodiode arrays at right angles (Alvi2014), a slit over each (Strietzel2002, "
        "Diriker2021). The studies give the arrangement, no dimensions. Round numbers instead: a "
        "0.3 mm slit 2.5 mm up keeps the Fresnel number above 10; 256 pixels of 50 um, 90 percent "
        "of it sensitive, hold the light at 60 deg; 10 bits."
    ),
)
