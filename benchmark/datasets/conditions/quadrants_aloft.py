"""Conditions of a quadrant photodiode of the ground in orbit: head and gains drift, Earth seen."""

from __future__ import annotations

from dataclasses import replace

from benchmark.datasets.conditions.aloft import conditions_aloft, ground_conditions
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.flight.drift import AssemblyDrift, PhotodiodeDrift
from benchmark.simulator.flight.drifting_quadrants import DriftingQuadrantSensor
from benchmark.simulator.sensors.quadrants import QuadrantSensor


def quadrants_aloft(
    ground: Preset, assembly: AssemblyDrift, photodiodes: PhotodiodeDrift
) -> dict[str, Condition]:
    """Return the conditions of a ground dataset's quadrants in orbit."""

    def flying(condition: str) -> DriftingQuadrantSensor:
        same = ground_conditions(ground, condition, QuadrantSensor)
        return DriftingQuadrantSensor(**same, assembly=assembly, photodiodes=photodiodes)

    still = replace(flying("nominal"), assembly=AssemblyDrift(), photodiodes=PhotodiodeDrift())
    texts = {
        "nominal": f"The nominal sensor of {ground.name}, with an assembly and gains that drift "
        "with temperature and age, and the sunlit Earth in view.",
        "stable": "The nominal sensor with an assembly and gains that do not drift.",
    }
    return conditions_aloft(ground, flying, still, texts, black_earth=True)
