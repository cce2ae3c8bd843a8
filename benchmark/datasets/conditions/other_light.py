"""Light that is not the Sun's first image: the sunlit Earth through an opening, and ghosts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, Final, TypeVar

from algorithms.contract import SensorGeometry
from benchmark.datasets.conditions.propagation import LIGHT
from benchmark.datasets.preset import Condition
from benchmark.simulator.light.clouds import CloudyEarth
from benchmark.simulator.light.environment import Earth, Irradiance
from benchmark.simulator.light.stray_slope import UnevenIrradiance
from benchmark.simulator.optics.ghosts import Ghost
from benchmark.simulator.sensor import Sensor
from benchmark.simulator.sensors.code_dial import CodeDialSensor
from benchmark.simulator.sensors.frames import FrameSensor
from benchmark.simulator.sensors.line_sensor import LineSensor
from benchmark.simulator.sensors.position_sensitive import PositionSensor
from benchmark.simulator.sensors.quadrants import QuadrantSensor
from benchmark.simulator.sensors.slit_pairs import SlitPairSensor

Haunted = TypeVar(
    "Haunted",
    QuadrantSensor,
    SlitPairSensor,
    PositionSensor,
    CodeDialSensor,
    FrameSensor,
    LineSensor,
)

_ORBIT: Final = (
    "in a 600 km orbit with the sunlit Earth in view on the test split, position and attitude "
    "random where the Sun is visible; calibrated on the ground without Earth"
)


def with_albedo(
    sensor: Sensor, irradiance: Irradiance = LIGHT, geometry: SensorGeometry | None = None
) -> Condition:
    """Return the condition of an orbit over an Earth that sends 0.3 of all light back.

    Parameters
    ----------
    sensor
        Under its nominal condition, behind openings.
    irradiance, geometry
        Of the nominal condition.

    Raises
    ------
    ValueError
        When the sensor does not see the Earth.
    """
    return Condition(
        f"The nominal sensor {_ORBIT}. The Earth is uniform: a Lambertian surface of albedo 0.3.",
        sensor,
        irradiance,
        earth=Earth(),
        geometry=geometry,
    )


def with_clouds(
    sensor: Sensor, irradiance: Irradiance = LIGHT, geometry: SensorGeometry | None = None
) -> Condition:
    """Return the condition of an orbit over patches of clouds; parameters as of `with_albedo`."""
    earth = CloudyEarth()
    return Condition(
        f"The nominal sensor {_ORBIT}. Clouds of {earth.cloudy:.2f} cover "
        f"{earth.clouds.cover:.0%} of ground of albedo {earth.clouds.clear:.2f} in patches; the "
        "mean albedo is 0.3.",
        sensor,
        irradiance,
        earth=earth,
        geometry=geometry,
    )


def with_ghosts(
    sensor: Haunted,
    ghost: Ghost | None = None,
    irradiance: Irradiance = LIGHT,
    geometry: SensorGeometry | None = None,
) -> Condition:
    """Return the condition of light reflected once more between detector and mask.

    Parameters
    ----------
    sensor
        Under its nominal condition.
    ghost
        None takes bare silicon below chromium blackened with its oxide.
    irradiance, geometry
        Of the nominal condition.
    """
    seen = Ghost() if ghost is None else ghost
    where = "the mask's underside" if seen.surface == "mask" else "the cover glass"
    return Condition(
        f"The nominal sensor whose detector reflects {seen.detector_reflectance:g} and {where} "
        f"{seen.surface_reflectance:g} of that: this gives a second image with {seen.share:.1%} "
        "of the light, farther out.",
        replace(sensor, ghost=seen),
        irradiance,
        geometry=geometry,
    )


def with_stray_gradient(
    sensor: Sensor, irradiance: Irradiance = LIGHT, geometry: SensorGeometry | None = None
) -> Condition:
    """Return the condition of ten times the stray light, brighter on one side than on the other.

    For an `UnevenPreset`; parameters as of `with_albedo`.
    """
    stray = 10.0 * irradiance.stray
    return Condition(
        f"The nominal sensor with stray light of {stray:g} of sunlight with a gradient that "
        "differs between samples: between middle and edge of the detector it changes by 25 % "
        "(one standard deviation per axis).",
        sensor,
        UnevenIrradiance(irradiance.spread, stray, stray / 5.0, stray / 4.0),
        geometry=geometry,
    )


#: Conditions by the names that data sets give them.
_NAMED: Final[Mapping[str, Callable[[Any], Condition]]] = {
    "albedo": with_albedo,
    "albedo-clouds": with_clouds,
    "ghosts": with_ghosts,
    "stray-gradient": with_stray_gradient,
}


def seen_with(sensor: Sensor, *names: str) -> dict[str, Condition]:
    """Return conditions of a sensor under `LIGHT` by their names.

    Parameters
    ----------
    sensor
        Under its nominal condition.
    names
        Of ``albedo``, ``albedo-clouds``, ``ghosts`` and ``stray-gradient``.
    """
    return {name: _NAMED[name](sensor) for name in names}
