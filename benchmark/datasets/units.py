"""Other units of a sensor: built alike, with other errors of assembly within the tolerances.

Unit 0 is the standard one, whose errors the preset names. Its tolerances follow from them: an
error of any other unit is uniform within ``sqrt(3)`` times its size in unit 0 (of two axes, the
larger one's), which makes that size its standard deviation. Rates at which a head bends with
temperature and creeps are drawn alike, each by its own size. Elements' own errors (gains, dark
signal, normals, apertures) are drawn by each sensor for the unit's name.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from typing import Any, TypeVar, cast

from benchmark.seeds import generator
from benchmark.simulator.flight.drift import AssemblyDrift
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.projection import Camera

Sensor = TypeVar("Sensor")

_WIDTH = math.sqrt(3.0)


def tolerance_of(assembly: Assembly) -> Assembly:
    """Return the largest errors, all positive, of units built like the one with these."""
    tilt = max(abs(assembly.tilt_x_deg), abs(assembly.tilt_y_deg))
    offset = max(abs(assembly.offset_x_mm), abs(assembly.offset_y_mm))
    sizes = Assembly(
        tilt_x_deg=tilt,
        tilt_y_deg=tilt,
        rotation_deg=abs(assembly.rotation_deg),
        focal_length_error_mm=abs(assembly.focal_length_error_mm),
        offset_x_mm=offset,
        offset_y_mm=offset,
    )
    return _scale(sizes, [_WIDTH] * len(dataclasses.fields(Assembly)))


def tolerances(sensor: object) -> dict[str, Assembly]:
    """Return the tolerance of every assembly in a sensor, by its place in it."""
    return {place: tolerance_of(assembly) for place, assembly in _assemblies(sensor, "")}


def assemble(sensor: Sensor, *names: str | int) -> Sensor:
    """Return the sensor as the unit of this name is assembled.

    The same draws serve every condition of a dataset: where two have the same tolerances, they
    see the same unit.
    """
    return cast("Sensor", _assemble(sensor, "", names))


def _assemble(value: Any, place: str, names: tuple[str | int, ...]) -> Any:
    if isinstance(value, Assembly):
        stream = generator(*names, "assembly", place)
        share = 2.0 * stream.random(len(dataclasses.fields(Assembly))) - 1.0
        return _scale(tolerance_of(value), share.tolist())
    if isinstance(value, AssemblyDrift):
        rates = dataclasses.astuple(value)
        share = 2.0 * generator(*names, "drift of the head", place).random(len(rates)) - 1.0
        return AssemblyDrift(*(_WIDTH * r * s for r, s in zip(rates, share.tolist(), strict=True)))
    if isinstance(value, Camera):
        return value.assemble(_assemble(value.assembly, f"{place}.assembly", names))
    if not dataclasses.is_dataclass(value) or isinstance(value, type):
        return value
    parts = {
        field.name: (part, _assemble(part, f"{place}.{field.name}", names))
        for field in dataclasses.fields(value)
        if field.init
        for part in (getattr(value, field.name),)
    }
    changed = {name: new for name, (old, new) in parts.items() if new is not old}
    return dataclasses.replace(value, **changed) if changed else value


def _assemblies(value: object, place: str) -> Iterator[tuple[str, Assembly]]:
    if isinstance(value, Assembly):
        yield place.lstrip("."), value
    elif dataclasses.is_dataclass(value) and not isinstance(value, type):
        for field in dataclasses.fields(value):
            yield from _assemblies(getattr(value, field.name), f"{place}.{field.name}")


def _scale(assembly: Assembly, factors: list[float]) -> Assembly:
    values = dataclasses.astuple(assembly)
    return Assembly(*(value * factor for value, factor in zip(values, factors, strict=True)))
