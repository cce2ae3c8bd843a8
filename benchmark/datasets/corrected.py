"""Observations as methods get them: corrected by the unit's own dark and flat readings.

A bench takes the references of a unit once, and again of another detector: one with other noise.
Conditions that change only light or mounting, or the detector after its calibration, share the
nominal ones; where they are renewed in flight, the samples of the flight are corrected by those.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, cast

from algorithms.references import ReferenceCorrection
from benchmark.contract import SPLITS
from benchmark.simulator.light.memory import memory
from benchmark.simulator.sensor import UnitSpread

if TYPE_CHECKING:
    from benchmark.datasets.preset import Preset
    from benchmark.datasets.samples import Samples
    from benchmark.simulator.readout.references import References

#: Where a simulated sensor keeps what its references depend on.
_PARTS = ("detector", "readout")


def reference_condition(preset: Preset, condition: str) -> str:
    """Return the first condition calibrated with this detector: its references serve both."""
    wanted = _parts(preset, condition)
    return next(name for name in preset.conditions if _parts(preset, name) == wanted)


def correction(
    preset: Preset, condition: str, split: str = "calibration"
) -> ReferenceCorrection | None:
    """Return the correction of a split of this unit; None where a sensor has no references."""
    shared, known = preset.conditions[0], condition
    renewed = split != "calibration" and _renews(preset, condition)
    if not renewed:
        known, split = reference_condition(preset, condition), "calibration"
    names = (*preset.streams, preset.unit, known, split)
    unit = _Unit(names, preset.condition(known).referred(split), preset.offered, preset)
    return _shared(unit) if (known, renewed) == (shared, False) else _made(unit)


def corrections(preset: Preset, condition: str) -> dict[str, ReferenceCorrection | None]:
    """Return the correction of every split; one for all unless the references are renewed."""
    first = correction(preset, condition)
    later = correction(preset, condition, "test") if _renews(preset, condition) else first
    return {split: first if split == "calibration" else later for split in SPLITS}


def _renews(preset: Preset, condition: str) -> bool:
    """Say whether references are taken again after the calibration: at will, or on a mission."""
    setup = preset.condition(condition)
    return setup.renewed or setup.mission is not None


@dataclass(frozen=True)
class _Unit:
    """A unit under one condition, by all that its references depend on."""

    names: tuple[str | int, ...]
    sensor: Any
    offered: References
    preset: Preset = field(compare=False)


def _made(unit: _Unit) -> ReferenceCorrection | None:
    condition, split = str(unit.names[-2]), str(unit.names[-1])
    readings = unit.preset.references(condition, split)
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
    """Return the sensor that was calibrated, without what moves or ages it."""
    sensor: Any = preset.condition(condition).referred()
    while not any(hasattr(sensor, name) for name in _PARTS) and hasattr(sensor, "sensor"):
        sensor = sensor.sensor
    return sensor


def _parts(preset: Preset, condition: str) -> Any:
    """Return what a sensor's references depend on; the sensor where nothing of it is apart."""
    sensor = _sensor(preset, condition)
    return tuple(getattr(sensor, name) for name in _PARTS if hasattr(sensor, name)) or sensor
