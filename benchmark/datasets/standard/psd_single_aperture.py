"""`psd-single-aperture`: a two-axis position-sensitive device behind a sharp round aperture."""

from __future__ import annotations

from benchmark.datasets.conditions import masked_photodiodes as diodes
from benchmark.datasets.conditions.alignment import careful_alignment, misalign
from benchmark.datasets.conditions.other_light import seen_with
from benchmark.datasets.conditions.pixel_arrays import hole
from benchmark.datasets.conditions.propagation import measured_geometric
from benchmark.simulator.sensors.position_sensitive import LateralEffect, PositionSensor

_CAMERA = diodes.through(hole(0.56), 1.5, careful_alignment(0.004, 0.01, -0.008))
_READOUT = diodes.amplifiers(100.0, 0.01, 120.0, gain_mismatch=0.005)
_SENSOR = PositionSensor(_CAMERA, LateralEffect(4.0, nonlinearity=0.01), _READOUT)
_NOMINAL = "Non-linear by 1 % at an edge's middle, amplifiers within 0.5 %, noise 1e-4 of sunlight."
_OFF = "focal length 2.5 % long, aperture 50 and -40 um off centre"

PRESET = diodes.masked_photodiodes(
    name="psd-single-aperture",
    version=5,
    drawn_as=3,
    detector="PSD",
    mask="Single-Ap.",
    readings=f"corner electrodes {diodes.QUADRANTS}",
    geometry=diodes.design(_SENSOR, 45.0, width_mm=4.0, shape=None),
    setups={
        **diodes.usual(_SENSOR, _NOMINAL, _OFF, misalign(0.0375)),
        "linear": diodes.linear(_SENSOR),
        **diodes.temperatures(_SENSOR),
        **seen_with(_SENSOR, "ghosts", "albedo"),
    },
    follows=("Lin2016",),
    description=(
        "One aperture over a position-sensitive device with electrodes at its corners; the "
        "balance S of quadrants gives the position S L / 2, with the active length L as the "
        "geometry's aperture width d. From Lin2016: a pinhole and a field of 120 x 120 deg, "
        "without lengths. From the Foresail-1 sensor: a hole of 0.56 mm, 1.5 mm above a "
        "device of 4 x 4 mm. Its field is +-50 deg, here +-45 deg, so that the whole spot "
        "stays on the device. Assumed: 100 uA and the noise."
    ),
    regime=measured_geometric(0.06, (1.0, 1.0, 1.0)),
)
