"""Conditions of a sensor that is warm, cold or old since its calibration: `since_calibration`.

It is calibrated new and at 25 deg C; dark and flat readings are taken there, too. In two further
conditions these readings, or the whole calibration, are taken again.
"""

from __future__ import annotations

from dataclasses import replace

from benchmark.datasets.preset import Condition
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.sensor import Sensor, UnitSpread

#: What names of conditions end in where dark and flat readings were renewed, or everything was.
RENEWED, RECALIBRATED = "-renewed", "-recalibrated"


def since_calibration(
    name: str,
    text: str,
    sensor: Sensor,
    new: Sensor,
    light: Irradiance,
) -> dict[str, Condition]:
    """Return the conditions of a sensor that is no longer as it was calibrated.

    Parameters
    ----------
    name, text
        Of the condition; the text is a sentence whose full stop is left out.
    sensor, new
        As it is, and as it was calibrated.
    light
        As of `Condition`.

    Returns
    -------
    dict of str to Condition
        `name`; ``name-renewed``, with dark and flat readings taken again, where the sensor has
        such readings; ``name-recalibrated``, with all of the calibration taken again.
    """
    later = Condition(
        f"{text}; calibrated new and at 25 deg C, dark and flat readings taken there, too.",
        sensor,
        light,
        calibrated=new,
    )
    found = {name: later}
    if isinstance(sensor, UnitSpread):
        said = f"{text}; calibrated new and at 25 deg C, dark and flat readings taken again since."
        found[name + RENEWED] = replace(later, description=said, renewed=True)
    said = f"{text}; calibrated as it is, dark and flat readings among it."
    found[name + RECALIBRATED] = Condition(said, sensor, light)
    return found


def without(setups: dict[str, Condition], *names: str) -> dict[str, Condition]:
    """Leave out conditions, each with those of its renewed readings and calibration."""
    gone = {name + end for name in names for end in ("", RENEWED, RECALIBRATED)}
    return {name: setup for name, setup in setups.items() if name not in gone}
