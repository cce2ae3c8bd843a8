"""`oi-maskless-pyramid`: four opto-isolators used as light sensors on a pyramid."""

from __future__ import annotations

from dataclasses import replace

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.conditions.cone import ConeField
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.light.environment import Earth, Irradiance
from benchmark.simulator.readout.detectors import CurrentReadout, DarkCurrent
from benchmark.simulator.sensors.face_layouts import pyramid
from benchmark.simulator.sensors.opto_isolator import OptoIsolatorSensor

_HALF_FOV_DEG = 55.0
_Q2, _Q1, _Q4, _Q3 = pyramid(4, 30.0, first_azimuth_deg=45.0)
_NORMALS = (_Q1, _Q2, _Q3, _Q4)

_SENSOR = OptoIsolatorSensor(
    normals=_NORMALS,
    readout=CurrentReadout(
        sunlit_ua=1_000.0,
        gain_mismatch=0.3,
        noise_ua=1.0,
        full_scale_ua=4_000.0,
        bits=14,
        dark=DarkCurrent(0.1),
    ),
    normal_error_deg=1.0,
)
_LIGHT = Irradiance(stray=0.002, stray_spread=0.0004)

PRESET = Preset(
    name="oi-maskless-pyramid",
    version=1,
    detector="OI",
    mask="Maskless",
    observation=Observation.CURRENTS,
    units="microamperes, float64 (N, 4): faces towards Q1 (-x, +y), Q2 (+x, +y), Q3 (+x, -y), "
    "Q4 (-x, -y)",
    geometry=SensorGeometry(face_normals=_NORMALS, half_fov_deg=_HALF_FOV_DEG),
    setups={
        "nominal": Condition(
            "Output as the light to the power 1.5, gains e^0.3 apart, normals within 1 deg, "
            "noise of 1e-3 of full sunlight, no Earth.",
            _SENSOR,
            _LIGHT,
        ),
        "low-noise": Condition(
            "The same sensor with a tenth of the noise and an 18-bit converter.",
            replace(_SENSOR, readout=replace(_SENSOR.readout, noise_ua=0.1, bits=18)),
            _LIGHT,
        ),
        "high-noise": Condition(
            "The same sensor with ten times the noise.",
            replace(_SENSOR, readout=replace(_SENSOR.readout, noise_ua=10.0)),
            _LIGHT,
        ),
        "misaligned": Condition(
            "The nominal sensor with opto-isolators mounted 5 deg off their faces' normals.",
            replace(_SENSOR, normal_error_deg=5.0),
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
        "matched": Condition(
            "The nominal sensor with opto-isolators selected for gains within 2 %.",
            replace(_SENSOR, readout=replace(_SENSOR.readout, gain_mismatch=0.02)),
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
    follows=("Wang2019",),
    description=(
        "The phototransistors of four opto-isolators, opened towards the Sun, in Wang2019's "
        "pyramid. No mapped study is known to use opto-isolators (the survey lists them among "
        "its detectors), so the detector is made of round numbers: an "
        "exponent of 1.5, between a photodiode's 1 and a square law, because a transistor's gain "
        "grows with its current; gains that spread by a factor e^0.3 = 1.35, as the current "
        "transfer ratios of one type do; 1 mA in full sunlight, four times that before the "
        "converter is full; mounting within 1 deg. Tilt and field as in pd-maskless-pyramid."
    ),
    regime={"propagation": "geometric", "reason": "nothing casts a shadow"},
)
