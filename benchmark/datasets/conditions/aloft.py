"""Conditions that ground data sets have in orbit: head or gains drift, sunlit Earth in view."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from functools import partial
from typing import Any

from benchmark.datasets.conditions.since_calibration import RECALIBRATED
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.flight.drift import ThermalCycle
from benchmark.simulator.light.clouds import CloudyEarth
from benchmark.simulator.light.environment import Earth

#: 40 K warmer than usual throughout.
_WARM = ThermalCycle(sunlit_k=348.15, eclipse_k=288.15)
UNDER_GLASS = (
    "under a filter of 0.5 mm of glass (index 1.52), with an assembly that drifts with "
    "temperature and age, and the sunlit Earth in view."
)
FIRM = "The nominal sensor with an assembly that does not drift."


def ground_conditions(ground: Preset, condition: str, sensor: type[Any]) -> dict[str, Any]:
    """Return the fields of a ground sensor, for one of a derived class that drifts."""
    still = ground.condition(condition).sensor
    return {field.name: getattr(still, field.name) for field in fields(sensor)}


def conditions_aloft(
    ground: Preset,
    flying: Callable[[str], Any],
    still: Any,
    texts: Mapping[str, str],
    *,
    black_earth: bool = False,
) -> dict[str, Condition]:
    """Return the conditions of a ground data set in orbit.

    Parameters
    ----------
    ground : Preset
        The data set on the ground.
    flying : callable
        The drifting sensor of a condition's name.
    still : Sensor
        The nominal sensor without drift.
    texts : mapping of str to str
        Descriptions by condition: of ``nominal``, ``stable`` and any other that is its own.
    black_earth : bool
        Whether there are conditions without light from the Earth, and with clouds.
    """
    noise = f"The nominal sensor with the noise of {ground.name}'s"
    said = {
        "low-noise": f"{noise} low-noise condition.",
        "high-noise": f"{noise} high-noise condition.",
        "misaligned": "The nominal sensor with the initial misalignment of the misaligned "
        f"{ground.name}.",
        **texts,
    }
    nominal, light = flying("nominal"), ground.condition("nominal").irradiance
    seen = partial(Condition, irradiance=light, earth=Earth())
    found = {"nominal": seen(said["nominal"], nominal)}
    if black_earth:
        found["no-albedo"] = seen("The nominal sensor over a black Earth.", nominal, earth=None)
        clouded = CloudyEarth()
        found["albedo-clouds"] = seen(
            f"The nominal sensor over an Earth with clouds of {clouded.cloudy:.2f} over "
            f"{clouded.clouds.cover:.0%} of ground of albedo {clouded.clouds.clear:.2f}, in "
            "patches that stand still in the sensor's frame.",
            nominal,
            earth=clouded,
        )
    for name in ("low-noise", "high-noise", "misaligned"):
        found[name] = seen(said[name], flying(name))
    hot = replace(nominal, thermal=_WARM)
    # dark and flat readings are those of the ground: there are none to be renewed
    found["hot"] = replace(
        seen("The nominal sensor, its satellite 40 K warmer since it was calibrated.", hot),
        calibrated=nominal,
    )
    found[f"hot{RECALIBRATED}"] = seen(
        "The nominal sensor on a satellite 40 K warmer throughout.", hot
    )
    found["stable"] = seen(said["stable"], still)
    return found
