"""`ltf-maskless-cube`: light-to-frequency converters on the six faces of a cube."""

from __future__ import annotations

from benchmark.datasets.conditions.faces import OF_THE_CUBE, converter_conditions, faces
from benchmark.datasets.fields import SphereField
from benchmark.simulator.readout.detectors import DarkCurrent
from benchmark.simulator.sensors.faces import CUBE
from benchmark.simulator.sensors.light_to_frequency import FrequencyCounter, FrequencySensor

_COUNTER = FrequencyCounter(
    sunlit_hz=500_000.0,
    gate_s=0.02,
    gain_mismatch=0.05,
    full_scale_hz=1_000_000.0,
    dark=DarkCurrent(5.0),
)

PRESET = faces(
    name="ltf-maskless-cube",
    version=1,
    detector="LTF",
    normals=CUBE,
    order=OF_THE_CUBE,
    setups=converter_conditions(FrequencySensor(CUBE, _COUNTER, normal_error_deg=0.1)),
    directions=SphereField(),
    follows=("Allgeier2009",),
    description=(
        "One converter a face, Sun from anywhere on the sphere. No mapped study is known to use "
        "light-to-frequency converters (the survey lists them among its detectors); the "
        "arrangement is Allgeier2009's. Round numbers: such chips reach a megahertz, so full "
        "sunlight is set to half of it behind a neutral filter, gains to 5 %; 20 ms fit a 50 Hz "
        "attitude loop."
    ),
    unit="hertz",
)
