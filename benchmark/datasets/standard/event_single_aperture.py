"""`event-single-aperture`: a time-to-first-spike array behind one round hole."""

from __future__ import annotations

from dataclasses import replace

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.plates import fresnel_number
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import DarkCurrent
from benchmark.simulator.sensors.events import EventSensor, SpikingArray

_DIAMETER_MM, _FOCAL_MM, _HALF_FOV_DEG = 0.2, 1.0, 50.0

_DETECTOR = SpikingArray(
    columns=64,
    rows=64,
    pitch_mm=0.05,
    sunlit_us=100.0,
    threshold_e=50_000.0,
    threshold_mismatch=0.02,
    prnu=0.01,
    dark=DarkCurrent(100_000.0),
    jitter=0.01,
    clock_us=0.1,
    latency_us=0.2,
    events=20,
    timeout_us=5_000.0,
)
_SENSOR = EventSensor(
    camera=Camera(
        focal_length_mm=_FOCAL_MM,
        mask=Mask((Aperture("round", _DIAMETER_MM, _DIAMETER_MM),), thickness_mm=0.01),
        assembly=Assembly(
            tilt_x_deg=0.05,
            tilt_y_deg=-0.03,
            rotation_deg=0.05,
            focal_length_error_mm=0.002,
            offset_x_mm=0.004,
            offset_y_mm=-0.003,
        ),
    ),
    detector=_DETECTOR,
)
_LIGHT = Irradiance(stray=0.002, stray_spread=0.0004)

PRESET = Preset(
    name="event-single-aperture",
    version=1,
    detector="Event",
    mask="Single-Ap.",
    observation=Observation.EVENTS,
    units=(
        "float64 (N, 20, 3): column and row of the pixel, microseconds since the reset; by time, "
        "rows of NaN after the last event"
    ),
    geometry=SensorGeometry(
        focal_length_mm=_FOCAL_MM,
        pixel_pitch_mm=_DETECTOR.pitch_mm,
        centre_px=_DETECTOR.centre_px,
        aperture_width_mm=_DIAMETER_MM,
        aperture_shape="round",
        half_fov_deg=_HALF_FOV_DEG,
    ),
    setups={
        "nominal": Condition(
            "Jitter of 1 % of the time, threshold mismatch of 2 %, clock of 0.1 us.",
            _SENSOR,
            _LIGHT,
        ),
        "low-noise": Condition(
            "The same unit with a tenth of the jitter, ten times the charge at the threshold and "
            "a tenth of the delays on the bus.",
            replace(
                _SENSOR,
                detector=replace(
                    _DETECTOR, jitter=0.001, threshold_e=500_000.0, latency_us=0.02, clock_us=0.01
                ),
            ),
            _LIGHT,
        ),
        "high-noise": Condition(
            "The same unit with five times the jitter and delays on the bus of 2 us.",
            replace(_SENSOR, detector=replace(_DETECTOR, jitter=0.05, latency_us=2.0)),
            _LIGHT,
        ),
        "misaligned": Condition(
            "The nominal unit tilted by 1.0 and -0.7 deg, turned by 0.5 deg, focal length 2.5 % "
            "long, mask one and 0.8 pixels off centre.",
            replace(
                _SENSOR,
                camera=replace(
                    _SENSOR.camera,
                    assembly=Assembly(
                        tilt_x_deg=1.0,
                        tilt_y_deg=-0.7,
                        rotation_deg=0.5,
                        focal_length_error_mm=0.025,
                        offset_x_mm=0.05,
                        offset_y_mm=-0.04,
                    ),
                ),
            ),
            _LIGHT,
        ),
        "mismatched": Condition(
            "The nominal unit with its threshold mismatch grown to 10 %.",
            replace(_SENSOR, detector=replace(_DETECTOR, threshold_mismatch=0.1)),
            _LIGHT,
        ),
        "hot": Condition(
            "The nominal unit at 80 deg C: dark current doubles every 7 K and hastens dim pixels.",
            replace(
                _SENSOR, detector=replace(_DETECTOR, dark=replace(_DETECTOR.dark, temperature_c=80))
            ),
            _LIGHT,
        ),
    },
    directions=AngleField(_HALF_FOV_DEG, steps=21, test_samples=1000),
    follows=("Bardallo2017a", "Bardallo2017b", "Merchan2023"),
    description=(
        "64 x 64 integrate-and-fire pixels in time-to-first-spike mode behind one round hole. The "
        "studies followed give the architecture, no geometry in what was mapped. Round numbers "
        "instead: pixels of 50 um (such pixels are large); a 0.2 mm hole 1 mm up keeps the Fresnel "
        "number at 18 and lights about twenty pixels; 64 of them hold the spot at 50 deg; the foil "
        "is 10 um thick. The array is reset after 20 events or after 5 ms, before pixels in stray "
        "light fire. The bound is that of the times of the pixels that fire before the reset, with "
        "what the silence of the others tells."
    ),
    regime={
        "propagation": "geometric",
        "fresnel_number": round(fresnel_number(_DIAMETER_MM / 2.0, _FOCAL_MM), 2),
        "wavelength_nm": 550,
        "reason": "a^2 / (lambda h) at normal incidence is above 10; diffraction is left out",
    },
)
