"""`with_flight`: the condition of a sensor that is calibrated on the ground once, and flown."""

from __future__ import annotations

import dataclasses
from typing import TypeVar

from benchmark.contract import FLIGHT
from benchmark.datasets.conditions.flight import FlightPreset
from benchmark.datasets.preset import Preset
from benchmark.simulator.flight.mission import LEVELS
from benchmark.simulator.light.clouds import CloudyEarth
from benchmark.simulator.sensor import SeesEarth
from benchmark.simulator.sensors.faces import Faces

Flown = TypeVar("Flown", bound=Preset)


def with_flight(preset: Flown, level: str = "typical", name: str = FLIGHT) -> Flown:
    """Return a data set on the ground with a mission as one condition more; one in orbit as it is.

    Parameters
    ----------
    preset
        The data set; its first condition is flown.
    level, name
        One of `benchmark.simulator.flight.mission.LEVELS`, and the condition's name.

    Raises
    ------
    ValueError
        For a level that there is not.
    """
    if level not in LEVELS:
        raise ValueError(f"no level {level!r}; there are {', '.join(LEVELS)}")
    if isinstance(preset, FlightPreset):
        return preset
    mission, nominal = LEVELS[level], next(iter(preset.setups.values()))
    sees = isinstance(nominal.sensor, Faces | SeesEarth) and mission.earthlight
    flown = dataclasses.replace(
        nominal,
        description=f"The nominal sensor, calibrated on the ground once and flown for "
        f"{mission.years:g} years under {level} strain: launch, heat, dose and dust change it, the "
        "clouded Earth shines in where it is seen, dark readings are taken again in one eclipse.",
        earth=CloudyEarth() if sees else None,
        mission=mission,
    )
    return dataclasses.replace(preset, setups={**preset.setups, name: flown})
