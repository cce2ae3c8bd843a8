"""Conditions of linear arrays of the ground in orbit: the head drifts, Earth seen."""

from __future__ import annotations

from dataclasses import replace
from typing import cast

from benchmark.datasets.conditions.aloft import (
    FIRM,
    UNDER_GLASS,
    conditions_aloft,
    ground_conditions,
)
from benchmark.datasets.conditions.line_arrays import design
from benchmark.datasets.conditions.propagation import GLASS
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.flight.drift import AssemblyDrift
from benchmark.simulator.flight.drifting_lines import DriftingLineSensor
from benchmark.simulator.sensors.line_sensor import LineSensor


def under_a_filter(ground: Preset, half_fov_deg: float) -> Preset:
    """Return a ground dataset of lines with a filter of glass in its drawing."""
    still = cast("LineSensor", ground.condition("nominal").sensor)
    camera = replace(still.camera, glass=GLASS)
    return replace(ground, geometry=design(replace(still, camera=camera), half_fov_deg))


def lines_aloft(ground: Preset, drift: AssemblyDrift) -> dict[str, Condition]:
    """Return the conditions of a ground dataset's lines in orbit, under glass."""

    def flying(condition: str) -> DriftingLineSensor:
        same = ground_conditions(ground, condition, LineSensor)
        same["camera"] = replace(same["camera"], glass=GLASS)
        return DriftingLineSensor(**same, drift=drift)

    still = replace(flying("nominal"), drift=AssemblyDrift())
    texts = {"nominal": f"The nominal sensor of {ground.name} {UNDER_GLASS}", "stable": FIRM}
    return conditions_aloft(ground, flying, still, texts)
