"""Conditions of linear arrays of the ground in orbit: the head drifts, Earth seen."""

from __future__ import annotations

from dataclasses import fields, replace
from functools import partial
from typing import cast

from benchmark.datasets.conditions.line_arrays import design
from benchmark.datasets.conditions.propagation import GLASS
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.flight.drift import AssemblyDrift, ThermalCycle
from benchmark.simulator.flight.drifting_lines import DriftingLineSensor
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.sensors.lines import LineSensor

#: 40 K warmer than usual throughout, as of the other flights.
_WARM = ThermalCycle(sunlit_k=348.15, eclipse_k=288.15)


def under_a_filter(ground: Preset, half_fov_deg: float) -> Preset:
    """Return a ground dataset of lines with a filter of glass in its drawing."""
    still = cast("LineSensor", ground.condition("nominal").sensor)
    camera = replace(still.camera, glass=GLASS)
    return replace(ground, geometry=design(replace(still, camera=camera), half_fov_deg))


def lines_aloft(ground: Preset, drift: AssemblyDrift) -> dict[str, Condition]:
    """Return the conditions of a ground dataset's lines in orbit, under glass, Earth in view."""

    def flying(condition: str) -> DriftingLineSensor:
        still = ground.condition(condition).sensor
        same = {f.name: getattr(still, f.name) for f in fields(LineSensor)}
        same["camera"] = replace(same["camera"], glass=GLASS)
        return DriftingLineSensor(**same, drift=drift)

    nominal, light = flying("nominal"), ground.condition("nominal").irradiance
    seen, its = partial(Condition, irradiance=light, earth=Earth()), f"{ground.name}'s"
    return {
        "nominal": seen(
            f"The nominal sensor of {ground.name} under a filter of 0.5 mm of glass (index 1.52), "
            "its head moving with temperature and age, sunlit Earth in view.",
            nominal,
        ),
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
            "The nominal sensor with an assembly that does not drift.",
            replace(nominal, drift=AssemblyDrift()),
        ),
    }
