"""Observations as methods get them: corrected by the unit's own dark and flat readings.

A bench takes the references of a unit once, and again where its detector has become another one:
hot, aged, with other noise. Conditions that change only light or mounting share the nominal ones.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, cast

from algorithms.references import ReferenceCorrection
from benchmark.simulator.light.memory import memory
from benchmark.simulator.sensor import UnitSpread

if TYPE_CHECKING:
    from benchmark.datasets.preset import Preset
    from benchmark.datasets.samples import Samples
    from benchmark.simulator.readout.references import References

#: Where a simulated sensor keeps what its references depend on.
_PARTS = ("detector", "readout")


def reference_condition(preset: Preset, condition: str) -> str:
    """Return the first condition whose detector is that of this one: its references serve both."""
    wanted = _parts(preset, condition)
    return next(name for name in preset.conditions if _parts(preset, name) == wanted)


def correction(preset: Preset, condition: str) -> ReferenceCorrection | None:
    """Return the correction of this unit's readings; None where a sensor has no references."""
    shared, known = preset.conditions[0], reference_condition(preset, condition)
    names = (*preset.streams, preset.unit, known)
    unit = _Unit(names, preset.condition(known).sensor, preset.offered, preset)
    return _shared(unit) if known == shared else _made(unit)


@dataclass(frozen=True)
class _Unit:
    """A unit under one condition, by all that its references depend on."""

    names: tuple[str | int, ...]
    sensor: Any
    offered: References
    preset: Preset = field(compare=False)


def _made(unit: _Unit) -> ReferenceCorrection | None:
    condition = str(unit.names[-1])
    readings = unit.preset.references(condition)
    dark = next((r for name, r in readings.items() if name.startswith("dark_")), None)
    flat = next((r for name, r in readings.items() if name.startswith("flat_")), None)
    if dark is None or flat is None:
        return None
    pixels = "dark_dn" in readings
    scale = float(_sensor(unit.preset, condition).detector.full_scale_dn) if pixels else None
    return ReferenceCorrection(dark, flat, scale, pixels)


#: Of the first condition, whose references most others share: made once for all of them.
_shared = memory.tables(1)(_made)


def correct(by: ReferenceCorrection | None, samples: Samples) -> Samples:
    """Return samples with their observations corrected; as they are for None."""
    if by is None:
        return samples
    observations = by.correct(
        samples.observations, samples.origin_px if by.dark.ndim == 2 else None
    )
    return cast("Samples", replace(cast("Any", samples), observations=observations))


def references_used(preset: Preset) -> str:
    """Say which references of the unit a data set's methods are given, in a few words."""
    sensor, offered = _sensor(preset, preset.conditions[0]), preset.offered
    if not isinstance(sensor, UnitSpread):
        return "nothing (lens cameras and event arrays have no dark and flat readings)"
    pixels = getattr(getattr(sensor, "detector", None), "full_scale_dn", None) is not None
    also = ", bad-pixel map" if pixels else ""
    return f"mean of {offered.darks} dark and {offered.flats} flat readings{also}"


def _sensor(preset: Preset, condition: str) -> Any:
    """Return the sensor itself, without what moves or ages it."""
    sensor = preset.condition(condition).sensor
    while not any(hasattr(sensor, name) for name in _PARTS) and hasattr(sensor, "sensor"):
        sensor = sensor.sensor
    return sensor


def _parts(preset: Preset, condition: str) -> Any:
    """Return what a sensor's references depend on; the sensor where nothing of it is apart."""
    sensor = _sensor(preset, condition)
    return tuple(getattr(sensor, name) for name in _PARTS if hasattr(sensor, name)) or sensor
