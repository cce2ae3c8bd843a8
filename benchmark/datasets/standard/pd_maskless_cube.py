"""`pd-maskless-cube`: six bare photodiodes on the faces of a cube."""

from __future__ import annotations

from dataclasses import replace

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.fields import SphereField
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.light.environment import Earth, Irradiance
from benchmark.simulator.readout.detectors import CurrentReadout, DarkCurrent
from benchmark.simulator.sensors.faces import CUBE, FaceSensor

_SENSOR = FaceSensor(
    normals=CUBE,
    readout=CurrentReadout(
        sunlit_ua=100.0,
        gain_mismatch=0.01,
        noise_ua=0.1,
        full_scale_ua=200.0,
        bits=12,
        dark=DarkCurrent(0.05),
    ),
    normal_error_deg=0.1,
)
_LIGHT = Irradiance(stray=0.002, stray_spread=0.0004)

PRESET = Preset(
    name="pd-maskless-cube",
    version=1,
    detector="PD",
    mask="Maskless",
    observation=Observation.CURRENTS,
    units="microamperes, float64 (N, 6): faces +x, -x, +y, -y, +z, -z",
    geometry=SensorGeometry(face_normals=CUBE),
    setups={
        "nominal": Condition(
            "Kelly response, 1 % gain mismatch, normals within 0.1 deg, noise of 1e-3 of full "
            "sunlight, no Earth.",
            _SENSOR,
            _LIGHT,
        ),
        "cosine": Condition(
            "The nominal sensor with photodiodes that follow Lambert's cosine.",
            replace(_SENSOR, response="cosine"),
            _LIGHT,
        ),
        "low-noise": Condition(
            "The same sensor with a tenth of the noise and a 16-bit converter.",
            replace(_SENSOR, readout=replace(_SENSOR.readout, noise_ua=0.01, bits=16)),
            _LIGHT,
        ),
        "high-noise": Condition(
            "The same sensor with ten times the noise.",
            replace(_SENSOR, readout=replace(_SENSOR.readout, noise_ua=1.0)),
            _LIGHT,
        ),
        "misaligned": Condition(
            "The nominal sensor with photodiodes mounted 2 deg off their faces' normals.",
            replace(_SENSOR, normal_error_deg=2.0),
            _LIGHT,
        ),
        "albedo": Condition(
            "The nominal sensor in a 600 km orbit with the sunlit Earth in view on the test "
            "split, position random where the Sun is visible; calibrated on the ground without "
            "Earth.",
            _SENSOR,
            _LIGHT,
            earth=Earth(),
        ),
    },
    directions=SphereField(),
    follows=("Allgeier2009", "Frezza2022"),
    description=(
        "One photodiode a face, Sun from anywhere on the sphere. The studies followed give the "
        "arrangement and the angular response (Kelly cosine: Yousefian2017), no electronics: "
        "full sunlight is set to 100 uA, the converter to twice that so that Sun and Earth "
        "together fit."
    ),
    regime={"propagation": "geometric", "reason": "nothing casts a shadow"},
)
