"""`qpd-single-aperture-glass`: a quadrant photodiode under a metallised cover glass."""

from __future__ import annotations

from dataclasses import replace

from benchmark.datasets.conditions import masked_photodiodes as diodes
from benchmark.datasets.conditions.alignment import careful_alignment, misalign
from benchmark.datasets.conditions.other_light import seen_with
from benchmark.datasets.conditions.propagation import measured_geometric
from benchmark.simulator.optics.plates import CoverGlass, Plate

_GLASS = CoverGlass((Plate(1.0, 1.52),))
_CAMERA = diodes.through(
    diodes.rectangular_opening(2.0, 2.0), 1.0, careful_alignment(0.002), _GLASS
)
_SENSOR = diodes.quadrants(_CAMERA, half_width_mm=1.8, gap_mm=0.05)
_GEOMETRY = replace(diodes.design(_SENSOR, 60.0, width_mm=2.0), cover_glass=((1.0, 1.52),))
_NOMINAL = "Square window, 2 um of glue, 1 % gain mismatch, noise of 2e-4 of full sunlight."
_OFF = "25 um of glue, window 50 and -40 um off centre"

PRESET = diodes.masked_photodiodes(
    name="qpd-single-aperture-glass",
    version=2,
    drawn_as=1,
    detector="QPD",
    mask="Single-Ap.",
    readings=diodes.QUADRANTS,
    geometry=_GEOMETRY,
    setups={
        **diodes.usual(_SENSOR, _NOMINAL, _OFF, misalign(0.025)),
        "round-aperture": diodes.round_aperture(_SENSOR, _GEOMETRY),
        **seen_with(_SENSOR, "albedo"),
    },
    follows=("Delgado2011", "Delgado2012a", "Delgado2012b", "Delgado2013"),
    description=(
        "The quadrants of qpd-single-aperture under a cover glass that fills the gap: the window "
        "is in the metal on the glass, as in sensors of the University of Seville (Ortega2010). "
        "The Delgado studies give no sizes. Assumed: sizes of qpd-single-aperture, 1 mm of glass "
        "of index 1.52. In glass rays stay within 41 deg of the boresight, so the field is +-60 "
        "deg instead of 40 deg; refraction makes the balance nonlinear (eq:refcomp1). Behind a "
        "round window a straight line in the tangent misses by 4.3 deg RMS over +-60 deg and by "
        "1.7 over +-45, as the factory table of a flown quadrant sensor does (4.4 and 1.6)."
    ),
    regime=measured_geometric(0.0005, (1.0, 1.0, 1.0)),
)
