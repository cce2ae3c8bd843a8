"""Arrays of pixels that fire once: pixels, conditions, design."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any, Final

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.conditions.alignment import MISALIGNED, careful_alignment, misalign
from benchmark.datasets.conditions.other_light import with_albedo
from benchmark.datasets.conditions.propagation import LIGHT
from benchmark.datasets.conditions.since_calibration import since_calibration
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.masks.apertures import Mask
from benchmark.simulator.optics.diffraction import propagation
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import DarkCurrent
from benchmark.simulator.sensors.events import EventSensor, SpikingArray

#: Microseconds an event keeps the bus busy: 12 million a second, the most that a DAVIS346 puts out
#: (346 x 260 pixels; a DVS128 some 2 million). The studies followed give no figure in what was
#: mapped.
SERVICE_US: Final = 1.0 / 12.0


def event_array(
    *,
    name: str,
    version: int,
    drawn_as: int | None = None,
    mask: str,
    sensor: EventSensor,
    geometry: SensorGeometry,
    directions: AngleField,
    follows: tuple[str, ...],
    description: str,
) -> Preset:
    """Return a dataset of times to the first spike behind openings `width_mm` wide."""
    return Preset(
        name=name,
        version=version,
        drawn_as=drawn_as,
        detector="Event",
        mask=mask,
        observation=Observation.EVENTS,
        units=f"float64 (N, {sensor.detector.events}, 3): column and row of the pixel, "
        "microseconds since the reset; by time, rows of NaN after the last event",
        geometry=geometry,
        setups=conditions(sensor),
        directions=directions,
        follows=follows,
        description=description,
        regime=propagation(sensor.camera.mask, sensor.camera.focal_length_mm, sensor.spectrum),
    )


def behind(mask: Mask, focal_length_mm: float, events: int, pitch_mm: float = 0.05) -> EventSensor:
    """Return a carefully assembled sensor of 64 x 64 pixels, reset after so many events."""
    return EventSensor(
        camera=Camera(
            focal_length_mm=focal_length_mm,
            mask=mask,
            assembly=careful_alignment(round(0.002 * focal_length_mm, 6)),
        ),
        detector=SpikingArray(
            columns=64,
            rows=64,
            pitch_mm=pitch_mm,
            sunlit_us=100.0,
            threshold_e=50_000.0,
            threshold_mismatch=0.02,
            prnu=0.01,
            dark=DarkCurrent(100_000.0),
            jitter=0.01,
            clock_us=0.1,
            latency_us=0.2,
            events=events,
            timeout_us=5_000.0,
            service_us=SERVICE_US,
        ),
    )


def design(sensor: EventSensor, half_fov_deg: float, **known: Any) -> SensorGeometry:
    """Return what the builder of a sensor knows of it: of its mask, what is `known`."""
    return SensorGeometry(
        focal_length_mm=sensor.camera.focal_length_mm,
        pixel_pitch_mm=sensor.detector.pitch_mm,
        centre_px=sensor.detector.centre_px,
        half_fov_deg=half_fov_deg,
        **known,
    )


def conditions(sensor: EventSensor) -> dict[str, Condition]:
    """Return the conditions of a nominal sensor."""
    camera, pixels = sensor.camera, sensor.detector
    quiet = replace(pixels, jitter=0.001, threshold_e=500_000.0, latency_us=0.02, clock_us=0.01)
    errors = misalign(round(0.025 * camera.focal_length_mm, 6))
    hot = replace(pixels, dark=replace(pixels.dark, temperature_c=80))
    seen = partial(Condition, irradiance=LIGHT)
    return {
        "nominal": seen(
            "Jitter of 1 % of the time, threshold mismatch of 2 %, clock of 0.1 us, a bus of 12 "
            "events/us.",
            sensor,
        ),
        "low-noise": seen(
            "The same unit with a tenth of the jitter, ten times the charge at the threshold and "
            "a tenth of the requests' delays; the bus is the same.",
            replace(sensor, detector=quiet),
        ),
        "high-noise": seen(
            "The same unit with five times the jitter and requests delayed by 2 us.",
            replace(sensor, detector=replace(pixels, jitter=0.05, latency_us=2.0)),
        ),
        "misaligned": seen(
            f"The nominal unit {MISALIGNED}, focal length 2.5 % long, mask one and 0.8 pixels off "
            "centre.",
            replace(sensor, camera=replace(camera, assembly=errors)),
        ),
        "mismatched": seen(
            "The nominal unit with its threshold mismatch grown to 10 %.",
            replace(sensor, detector=replace(pixels, threshold_mismatch=0.1)),
        ),
        **since_calibration(
            "hot",
            "The nominal unit at 80 deg C: dark current doubles every 7 K and hastens dim pixels",
            replace(sensor, detector=hot),
            sensor,
            LIGHT,
        ),
        "albedo": with_albedo(sensor),
    }
