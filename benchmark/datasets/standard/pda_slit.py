"""`pda-slit`: two linear photodiode arrays at right angles, a slit over each."""

from __future__ import annotations

from benchmark.datasets.conditions.line_arrays import behind, line_arrays, photodiode_array
from benchmark.simulator.masks.slits import slit_row

_MASK = slit_row((0.0,), width_mm=0.2, length_mm=11.6, thickness_mm=0.02)

PRESET = line_arrays(
    name="pda-slit",
    version=5,
    drawn_as=3,
    detector="PDA",
    mask="Slit",
    sensor=behind(_MASK, 2.5, photodiode_array(256, 0.05), pixel_height_mm=0.5, fill_factor=0.9),
    half_fov_deg=60.0,
    follows=("Alvi2014", "Diriker2021", "Strietzel2002"),
    description=(
        "Two linear photodiode arrays at right angles (Alvi2014), a slit over each "
        "(Strietzel2002, Diriker2021). No dimensions are known. Assumed: 256 pixels of 50 um, "
        "90 % of each sensitive, 2.5 mm below a slit of 0.2 mm (four pixels, so that "
        "interpolation has full pixels between two edges, Diriker2021); field +-60 deg; 10 "
        "bits."
    ),
)
