"""Data sets of sensors that were built, or stand in light, otherwise than their presets say."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, cast

from algorithms.contract import SensorGeometry
from benchmark.datasets.preset import Preset
from benchmark.simulator.optics.assembly import Assembly


def alter(
    preset: Preset,
    change: Callable[[Any], Any],
    geometry: SensorGeometry | None = None,
    condition: str = "nominal",
) -> Preset:
    """Return the data set with one condition alone, whose sensor is what `change` makes of it.

    Name and streams stay: Suns, elements and noise are those of the preset. `geometry` is the
    drawing, where that changes too.
    """
    setup = preset.condition(condition)
    drawn = geometry or setup.geometry
    other = replace(setup, sensor=change(setup.sensor), geometry=drawn)
    return replace(preset, setups={condition: other})


def assemble(
    preset: Preset, change: Callable[[Assembly], Assembly], condition: str = "nominal"
) -> Preset:
    """`alter` in its errors of assembly alone.

    Errors of other units are drawn within tolerances of those of unit 0, so that what is scaled or
    left out here is so in every unit.
    """

    def rebuilt(sensor: Any) -> Any:
        camera = sensor.camera
        return replace(sensor, camera=replace(camera, assembly=change(camera.assembly)))

    return alter(preset, rebuilt, condition=condition)


def misalign(assembly: Assembly, times: float) -> Assembly:
    """Tilts, rotation and offsets so many times as large; the focal length's error stays."""
    return replace(
        assembly,
        tilt_x_deg=times * assembly.tilt_x_deg,
        tilt_y_deg=times * assembly.tilt_y_deg,
        rotation_deg=times * assembly.rotation_deg,
        offset_x_mm=times * assembly.offset_x_mm,
        offset_y_mm=times * assembly.offset_y_mm,
    )


def sensor_of(preset: Preset, unit: int = 0, condition: str = "nominal") -> Any:
    """Return the sensor of a unit under a condition."""
    return cast("Any", preset.for_unit(unit).condition(condition).sensor)
