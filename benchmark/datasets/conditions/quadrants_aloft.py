"""Conditions of a quadrant photodiode of the ground in orbit: head and gains drift, Earth seen."""

from __future__ import annotations

from dataclasses import fields, replace
from functools import partial

from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.flight.drift import AssemblyDrift, PhotodiodeDrift, ThermalCycle
from benchmark.simulator.flight.drifting_quadrants import DriftingQuadrantSensor
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.sensors.quadrants import QuadrantSensor

#: 40 K warmer than usual throughout, as of the other flights.
_WARM = ThermalCycle(sunlit_k=348.15, eclipse_k=288.15)


def quadrants_aloft(
    ground: Preset, assembly: AssemblyDrift, photodiodes: PhotodiodeDrift
) -> dict[str, Condition]:
    """Return the conditions of a ground dataset's quadrants in orbit, Earth in view."""

    def flying(condition: str) -> DriftingQuadrantSensor:
        still = ground.condition(condition).sensor
        same = {f.name: getattr(still, f.name) for f in fields(QuadrantSensor)}
        return DriftingQuadrantSensor(**same, assembly=assembly, photodiodes=photodiodes)

    nominal, light = flying("nominal"), ground.condition("nominal").irradiance
    seen, its = partial(Condition, irradiance=light, earth=Earth()), f"{ground.name}'s"
    return {
        "nominal": seen(
            f"The nominal sensor of {ground.name}, its head and gains moving with temperature and "
            "age, sunlit Earth in view.",
            nominal,
        ),
        "no-albedo": seen("The nominal sensor over a black Earth.", nominal, earth=None),
        "low-noise": seen(
            f"The nominal sensor with the noise of {its} low-noise condition.", flying("low-noise")
        ),
        "high-noise": seen(
            f"The nominal sensor with the noise of {its} high-noise condition.",
            flying("high-noise"),
        ),
        "misaligned": seen(
            f"The nominal sensor, misaligned at first as {its} of that name.", flying("misaligned")
        ),
        "hot": seen(
            "The nominal sensor on a satellite 40 K warmer throughout.",
            replace(nominal, thermal=_WARM),
        ),
        "stable": seen(
            "The nominal sensor with an assembly and gains that do not drift.",
            replace(nominal, assembly=AssemblyDrift(), photodiodes=PhotodiodeDrift()),
        ),
    }
