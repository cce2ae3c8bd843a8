"""`ltf-maskless-cube`: light-to-frequency converters on the six faces of a cube."""

from __future__ import annotations

from dataclasses import replace

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.fields import SphereField
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.light.environment import Earth, Irradiance
from benchmark.simulator.readout.detectors import DarkCurrent
from benchmark.simulator.sensors.faces import CUBE
from benchmark.simulator.sensors.light_to_frequency import FrequencyCounter, FrequencySensor

_SENSOR = FrequencySensor(
    normals=CUBE,
    readout=FrequencyCounter(
        sunlit_hz=500_000.0,
        gate_s=0.02,
        gain_mismatch=0.05,
        full_scale_hz=1_000_000.0,
        dark=DarkCurrent(5.0),
    ),
    normal_error_deg=0.1,
)
_LIGHT = Irradiance(stray=0.002, stray_spread=0.0004)

PRESET = Preset(
    name="ltf-maskless-cube",
    version=1,
    detector="LTF",
    mask="Maskless",
    observation=Observation.CURRENTS,
    units="hertz, float64 (N, 6): faces +x, -x, +y, -y, +z, -z",
    geometry=SensorGeometry(face_normals=CUBE),
    setups={
        "nominal": Condition(
            "Cosine response, gains 5 % apart, normals within 0.1 deg, pulses counted for 20 ms: "
            "1 % of counting noise in full sunlight, no Earth.",
            _SENSOR,
            _LIGHT,
        ),
        "kelly": Condition(
            "The nominal sensor with converters of Kelly's response.",
            replace(_SENSOR, response="kelly"),
            _LIGHT,
        ),
        "low-noise": Condition(
            "The same sensor counting ten times as long.",
            replace(_SENSOR, readout=replace(_SENSOR.readout, gate_s=0.2)),
            _LIGHT,
        ),
        "high-noise": Condition(
            "The same sensor counting a tenth as long.",
            replace(_SENSOR, readout=replace(_SENSOR.readout, gate_s=0.002)),
            _LIGHT,
        ),
        "misaligned": Condition(
            "The nominal sensor with converters mounted 2 deg off their faces' normals.",
            replace(_SENSOR, normal_error_deg=2.0),
            _LIGHT,
        ),
        "hot": Condition(
            "The nominal sensor at 80 deg C: the dark frequency doubles every 7 K.",
            replace(
                _SENSOR,
                readout=replace(
                    _SENSOR.readout, dark=replace(_SENSOR.readout.dark, temperature_c=80.0)
                ),
            ),
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
    follows=("Allgeier2009",),
    description=(
        "One converter a face, Sun from anywhere on the sphere. No mapped study is known to use "
        "light-to-frequency converters (the survey lists them among its detectors); the "
        "arrangement is Allgeier2009's. Round numbers: such chips reach a megahertz, so full "
        "sunlight is set to half of it behind a neutral filter, gains to 5 %; 20 ms fit a 50 Hz "
        "attitude loop."
    ),
    regime={"propagation": "geometric", "reason": "nothing casts a shadow"},
)
