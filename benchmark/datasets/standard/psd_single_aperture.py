"""`psd-single-aperture`: a two-axis position-sensitive device behind a sharp round aperture."""

from __future__ import annotations

from benchmark.datasets.conditions import masked_photodiodes as diodes
from benchmark.datasets.conditions import other_light
from benchmark.datasets.conditions.alignment import careful, misaligned
from benchmark.datasets.conditions.pixel_arrays import hole
from benchmark.datasets.conditions.propagation import geometric
from benchmark.simulator.sensors.position_sensitive import LateralEffect, PositionSensor

_CAMERA = diodes.through(hole(0.3), 2.2, careful(0.004, 0.01, -0.008))
_READOUT = diodes.amplifiers(50.0, 0.005, 60.0, gain_mismatch=0.005)
_SENSOR = PositionSensor(_CAMERA, LateralEffect(9.0, nonlinearity=0.01), _READOUT)
_NOMINAL = (
    "Position non-linearity of 1 % at the middle of an edge, amplifiers matched to 0.5 %, noise of "
    "1e-4 of full sunlight an electrode."
)
_OFF = "focal length 2.5 % long, aperture 50 and -40 um off centre"

PRESET = diodes.masked_photodiodes(
    name="psd-single-aperture",
    version=2,
    detector="PSD",
    mask="Single-Ap.",
    readings=f"corner electrodes {diodes.QUADRANTS}",
    geometry=diodes.design(_SENSOR, 60.0, width_mm=9.0, shape=None),
    setups={
        **diodes.usual(_SENSOR, _NOMINAL, _OFF, misaligned(0.055)),
        "linear": diodes.linear(_SENSOR),
        **diodes.temperatures(_SENSOR),
        "albedo": other_light.with_albedo(_SENSOR),
    },
    follows=("Lin2016",),
    description=(
        "One aperture over a position-sensitive device with electrodes at its corners, so that the "
        "voltage balance of quadrants gives both positions: a balance S is a spot at S L / 2, and "
        "the active length L = 9 mm stands in the geometry as the aperture's width d. Lin2016 "
        "gives a pinhole, a 120 x 120 deg field and an aperture of V-shaped cross-section, here an "
        "edge without thickness; no lengths in what was mapped. Round numbers: 9 mm is a common "
        "size of such devices; an aperture 2.2 mm up keeps the spot on it to 60 deg on both axes, "
        "misaligned too; 0.3 mm of diameter keep the Fresnel number above 10."
    ),
    regime=geometric(0.3, 2.2),
)
