"""`qpd-single-aperture`: a quadrant photodiode behind a square (or round) aperture."""

from __future__ import annotations

from benchmark.datasets.conditions import masked_photodiodes as diodes
from benchmark.datasets.conditions.alignment import careful_alignment, misalign
from benchmark.datasets.conditions.other_light import seen_with
from benchmark.datasets.conditions.propagation import measured_geometric

_MASK = diodes.rectangular_opening(2.0, 2.0, thickness_mm=0.02, rotation_deg=0.1)
_CAMERA = diodes.through(_MASK, 1.0, careful_alignment(0.002))
_SENSOR = diodes.quadrants(_CAMERA, half_width_mm=1.8, gap_mm=0.05)
_GEOMETRY = diodes.design(_SENSOR, 40.0, width_mm=2.0)
_NOMINAL = "Square aperture, 50 um gap, 1 % gain mismatch, noise of 2e-4 of full sunlight."
_OFF = "focal length 2.5 % long, aperture 50 and -40 um off centre"

PRESET = diodes.masked_photodiodes(
    name="qpd-single-aperture",
    version=4,
    drawn_as=3,
    detector="QPD",
    mask="Single-Ap.",
    readings=diodes.QUADRANTS,
    geometry=_GEOMETRY,
    setups={
        **diodes.usual(_SENSOR, _NOMINAL, _OFF, misalign(0.025)),
        "wide-gap": diodes.wide_gap(_SENSOR),
        "round-aperture": diodes.round_aperture(_SENSOR, _GEOMETRY),
        **seen_with(_SENSOR, "stray-gradient", "ghosts", "albedo", "albedo-clouds"),
    },
    follows=("Boslooper2017", "Faizullin2017"),
    description=(
        "Four photodiodes under one aperture: square as in Boslooper2017, round as in "
        "Faizullin2017. Neither study, nor any maker of quadrant sensors, gives the geometry. "
        "Assumed: an aperture of 2 mm, 1 mm up, so that the balance saturates at 45 deg "
        "(alg:VB); a field of +-40 deg; a detector of 3.6 mm, which cuts the spot from 38.7 "
        "deg on."
    ),
    regime=measured_geometric(0.25, (1.0, 1.0, 1.0)),
)
