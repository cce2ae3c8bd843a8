"""Windows of frames in plain shadow, for tests whose oracle is a ray count or a closed form."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from benchmark.simulator.sensors.frames import FrameSensor


def shadows(sensor: Any, **changes: Any) -> FrameSensor:
    """Return a sensor of the same pixels whose light is not bent.

    `changes` are fields of `FrameSensor`, and ``pitch_mm`` of its pixels.
    """
    detector = sensor.detector
    if "pitch_mm" in changes:
        detector = replace(detector, pitch_mm=changes.pop("pitch_mm"))
    plain = FrameSensor(sensor.camera, detector, sensor.window_px, sensor.window_jitter_px)
    return replace(plain, **changes)
