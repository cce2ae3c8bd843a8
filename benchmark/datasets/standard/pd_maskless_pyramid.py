"""`pd-maskless-pyramid`: six bare photodiodes on the faces of a pyramid."""

from __future__ import annotations

from dataclasses import replace

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.conditions.cone import ConeField
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.light.environment import Earth, Irradiance
from benchmark.simulator.readout.detectors import CurrentReadout, DarkCurrent
from benchmark.simulator.sensors.face_layouts import pyramid
from benchmark.simulator.sensors.faces import FaceSensor

_HALF_FOV_DEG = 55.0
_NORMALS = pyramid(6, 30.0)

_SENSOR = FaceSensor(
    normals=_NORMALS,
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
    name="pd-maskless-pyramid",
    version=1,
    detector="PD",
    mask="Maskless",
    observation=Observation.CURRENTS,
    units="microamperes, float64 (N, 6): faces at azimuths 0, 60, ..., 300 deg from +x to +y",
    geometry=SensorGeometry(face_normals=_NORMALS, half_fov_deg=_HALF_FOV_DEG),
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
        "hot": Condition(
            "The nominal sensor at 80 deg C: dark current doubles every 7 K.",
            replace(
                _SENSOR,
                readout=replace(
                    _SENSOR.readout, dark=replace(_SENSOR.readout.dark, temperature_c=80.0)
                ),
            ),
            _LIGHT,
        ),
        "stray-light": Condition(
            "The nominal sensor under stray light of 5 % of sunlight, 1 % from sample to sample: "
            "the interference, the same on all faces, that Wang2019 suppresses.",
            _SENSOR,
            Irradiance(stray=0.05, stray_spread=0.01),
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
    directions=ConeField(_HALF_FOV_DEG),
    follows=("Wang2019", "Yousefian2017"),
    description=(
        "Photodiodes on the lateral faces of a regular pyramid (eq:msfpyra1, Wang2019); their "
        "number, six, the Kelly cosine and the field, a cone of 110 deg, are Yousefian2017's. The "
        "tilt is not given in what was mapped: 30 deg from the boresight is the largest round "
        "number that leaves all six lit within that cone. Electronics as in pd-maskless-cube."
    ),
    regime={"propagation": "geometric", "reason": "nothing casts a shadow"},
)
