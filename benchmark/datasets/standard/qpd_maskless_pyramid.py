"""`qpd-maskless-pyramid`: the four elements of a quadrant photodiode on a pyramid, no mask."""

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
_Q2, _Q1, _Q4, _Q3 = pyramid(4, 30.0, first_azimuth_deg=45.0)
_NORMALS = (_Q1, _Q2, _Q3, _Q4)

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
    name="qpd-maskless-pyramid",
    version=1,
    detector="QPD",
    mask="Maskless",
    observation=Observation.CURRENTS,
    units="microamperes, float64 (N, 4): faces towards Q1 (-x, +y), Q2 (+x, +y), Q3 (+x, -y), "
    "Q4 (-x, -y)",
    geometry=SensorGeometry(face_normals=_NORMALS, half_fov_deg=_HALF_FOV_DEG),
    setups={
        "nominal": Condition(
            "Kelly response, 1 % gain mismatch, normals within 0.1 deg, noise of 1e-3 of full "
            "sunlight, no Earth.",
            _SENSOR,
            _LIGHT,
        ),
        "cosine": Condition(
            "The nominal sensor with photodiodes that follow Lambert's cosine: the balances are "
            "linear in the tangents.",
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
    directions=ConeField(_HALF_FOV_DEG),
    follows=("Zhuo2020",),
    description=(
        "Four photodiodes that lean outwards into the four quadrants, read by their balances: "
        "with cosine responses and a tilt of t they are ``tan(t) / sqrt(2)`` times the tangents "
        "of the Sun angles. Zhuo2020 is filed under voltage balance and the pyramidal model; no "
        "geometry in what was mapped. Tilt, field and electronics as in pd-maskless-pyramid."
    ),
    regime={"propagation": "geometric", "reason": "nothing casts a shadow"},
)
