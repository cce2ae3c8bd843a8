"""A head as it stands at each sample of a flight: its design, its errors of assembly and drift."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from benchmark.simulator.flight.drift import AssemblyDrift
from benchmark.simulator.flight.time_series import TimedScene
from benchmark.simulator.optics.projection import Camera


def moved_heads(camera: Camera, drift: AssemblyDrift, scene: TimedScene) -> Iterator[Camera]:
    """Yield the camera of each sample, its assembly moved by temperature and age.

    Parameters
    ----------
    camera
        As built, with its errors of assembly.
    drift
        How it moves.
    scene
        Samples with temperatures and ages.
    """
    built = camera.assembly
    for moved in drift.moved(scene.temperature_k, scene.age_years).tolist():
        tilt_x, tilt_y, longer, x, y = moved
        yield camera.assemble(
            replace(
                built,
                tilt_x_deg=built.tilt_x_deg + tilt_x,
                tilt_y_deg=built.tilt_y_deg + tilt_y,
                focal_length_error_mm=built.focal_length_error_mm + longer,
                offset_x_mm=built.offset_x_mm + x,
                offset_y_mm=built.offset_y_mm + y,
            )
        )
