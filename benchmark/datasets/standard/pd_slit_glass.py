"""`pd-slit-glass`: two pairs of photodiodes under cover glass, each pair under a slit."""

from __future__ import annotations

from dataclasses import replace

from benchmark.datasets.conditions import masked_photodiodes as diodes
from benchmark.datasets.conditions.alignment import careful_alignment, misalign
from benchmark.datasets.conditions.other_light import seen_with
from benchmark.datasets.conditions.propagation import measured_geometric
from benchmark.simulator.optics.plates import CoverGlass, Plate
from benchmark.simulator.sensors.slit_pairs import DiodePair, SlitPairSensor

_GLASS = CoverGlass((Plate(0.3, 1.52),))
_CAMERA = diodes.through(
    diodes.rectangular_opening(2.8, 5.0), 0.5, careful_alignment(0.001), _GLASS
)
_PAIR = DiodePair(reach_mm=2.9, breadth_mm=2.0, gap_mm=0.05)
_SENSOR = SlitPairSensor(_CAMERA, _PAIR, diodes.amplifiers(250.0, 0.02, 120.0))
_DRAWN = diodes.design(_SENSOR, 60.0, width_mm=2.0**0.5 * 2.8)
_NOMINAL = "Thin slits, 50 um gaps, 1 % gain mismatch, noise of 2e-4 of full sunlight."
_OFF = "focal length 2.5 % long, slits 50 and -40 um off centre"

PRESET = diodes.masked_photodiodes(
    name="pd-slit-glass",
    version=2,
    drawn_as=1,
    detector="PD",
    mask="Slit",
    readings=f"photodiodes {diodes.QUADRANTS}; Q2 and Q4 share a slit, Q1 and Q3 the other",
    geometry=replace(_DRAWN, cover_glass=((0.3, 1.52),)),
    setups=diodes.usual(_SENSOR, _NOMINAL, _OFF, misalign(0.0125)) | seen_with(_SENSOR, "albedo"),
    follows=("Hales2002",),
    description=(
        "The photodiodes and slits of pd-slit with a cover glass on the die, for Hales2002's "
        "optical compensation. The survey states only Hales2002's optical model. Assumed: "
        "glass of 0.3 mm (index 1.52) within the 0.5 mm from slits to die; thin slits."
    ),
    regime=measured_geometric(0.0005, (1.0, 1.0, 1.0)),
)
