"""`pd-slit`: two pairs of photodiodes, each pair under a slit."""

from __future__ import annotations

from dataclasses import replace

from benchmark.datasets.conditions import masked_photodiodes as diodes
from benchmark.datasets.conditions.alignment import careful_alignment, misalign
from benchmark.datasets.conditions.other_light import seen_with
from benchmark.datasets.conditions.propagation import measured_geometric
from benchmark.simulator.sensors.slit_pairs import DiodePair, SlitPairSensor

_CAMERA = diodes.through(
    diodes.rectangular_opening(2.8, 5.0, thickness_mm=0.02), 0.5, careful_alignment(0.001)
)
_PAIR = DiodePair(reach_mm=2.9, breadth_mm=2.0, gap_mm=0.05)
_SENSOR = SlitPairSensor(_CAMERA, _PAIR, diodes.amplifiers(250.0, 0.02, 120.0))
_DRAWN = diodes.design(_SENSOR, 60.0, width_mm=2.0**0.5 * 2.8)
_SLITS = replace(_DRAWN, mask_thickness_mm=0.02, slits=((0.0, 45.0, 2.8), (0.0, -45.0, 2.8)))
_THICK = replace(diodes.thick_slit(_SENSOR), geometry=replace(_SLITS, mask_thickness_mm=0.1))
_NOMINAL = "Slits 20 um thick, 50 um gaps, 1 % gain mismatch, noise of 2e-4 of full sunlight."
_OFF = "focal length 2.5 % long, slits 50 and -40 um off centre"

PRESET = diodes.masked_photodiodes(
    name="pd-slit",
    version=5,
    drawn_as=3,
    detector="PD",
    mask="Slit",
    readings=f"photodiodes {diodes.QUADRANTS}; Q2 and Q4 share a slit, Q1 and Q3 the other",
    geometry=_SLITS,
    setups={
        **diodes.usual(_SENSOR, _NOMINAL, _OFF, misalign(0.0125)),
        "thick-slit": _THICK,
        **(diodes.temperatures(_SENSOR) | seen_with(_SENSOR, "ghosts", "albedo")),
    },
    follows=("Chang2006", "Abhilash2014", "Hales2002"),
    description=(
        "Photodiodes under slits, balanced in pairs. From Chang2006: field +-60 deg, shade of the "
        "slit's thickness. From Abhilash2014 and Hales2002: two axes on one die. Assumed: slits at "
        "45 deg to the axes, which put each photodiode into a quadrant, so that the voltage "
        "balance gives both axes; slits 2.8 mm wide and 5 mm long, 0.5 mm up; 100 uA per "
        "photodiode at normal incidence. The aperture width d is the slit width times sqrt(2)."
    ),
    regime=measured_geometric(0.02, (1.0, 1.0, 1.0)),
)
