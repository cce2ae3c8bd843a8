"""`ltf-maskless-cube`: light-to-frequency converters on the six faces of a cube."""

from __future__ import annotations

from benchmark.datasets.conditions.faces import OF_THE_CUBE, converter_conditions, faces
from benchmark.datasets.fields import SphereField
from benchmark.simulator.readout.detectors import DarkCurrent
from benchmark.simulator.sensors.faces import CUBE
from benchmark.simulator.sensors.light_to_frequency import FrequencyCounter, FrequencySensor

_COUNTER = FrequencyCounter(
    sunlit_hz=100_000.0,
    gate_s=0.02,
    gain_mismatch=0.025,
    full_scale_hz=1_000_000.0,
    dark=DarkCurrent(1.0),
    nonlinearity=0.002,
    gain_per_k=1e-4,
)

PRESET = faces(
    name="ltf-maskless-cube",
    version=2,
    detector="LTF",
    normals=CUBE,
    order=OF_THE_CUBE,
    setups=converter_conditions(FrequencySensor(CUBE, _COUNTER, normal_error_deg=0.1)),
    directions=SphereField(),
    follows=(),
    description=(
        "One converter a face, Sun from anywhere on the sphere. No mapped study is known to use "
        "light-to-frequency converters, and no sun sensor of that kind was found: an idealisation, "
        "in Allgeier2009's arrangement. The converter is that of a data sheet (TI TSL230B): up to "
        "1 MHz, frequencies within 5 % from part to part, taken as two standard deviations, 0.2 % "
        "short of proportion at 100 kHz, 100 ppm/K, 1.4 mm2 of silicon, whose 5 pC a pulse average "
        "the light's noise away. Round numbers: full sunlight at 100 kHz, behind a neutral filter; "
        "a dark frequency of 1 Hz; a gate of 20 ms and a hundredth of a pulse of jitter."
    ),
    unit="hertz",
)
