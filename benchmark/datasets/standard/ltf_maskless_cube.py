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
    version=4,
    drawn_as=2,
    detector="LTF",
    normals=CUBE,
    order=OF_THE_CUBE,
    setups=converter_conditions(FrequencySensor(CUBE, _COUNTER, normal_error_deg=0.1)),
    directions=SphereField(),
    follows=(),
    description=(
        "A light-to-frequency converter on each face of a cube; the Sun may be anywhere. No "
        "mapped study and no known sun sensor uses such converters; the arrangement is "
        "Allgeier2009's. From the data sheet of the TI TSL230B: up to 1 MHz, frequencies "
        "within 5 % (two sigma), nonlinearity 0.2 % at 100 kHz, 100 ppm/K, 1.4 mm2. Assumed: "
        "100 kHz in full sunlight behind a neutral filter, 1 Hz in the dark, a gate of 20 ms, "
        "jitter of 0.01 pulse."
    ),
    unit="hertz",
)
