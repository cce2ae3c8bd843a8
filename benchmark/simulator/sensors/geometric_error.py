"""How far a sensor that renders shadows is from the same sensor with diffracted light."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from algorithms.contract import Floats
from benchmark.seeds import generator
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import Sensor


def geometric_error(geometric: Sensor, diffracted: Sensor, directions: Floats) -> Floats:
    """(N,) largest difference between two renderings of the same sensor, over the brightest.

    A dataset may leave diffraction out where this stays below 1 % over its whole field; the
    numbers then stand in its card's ``regime``.

    Parameters
    ----------
    geometric, diffracted
        Equal but for how light gets from the mask to the detector.
    directions
        (N, 3) unit vectors to the Sun.

    Returns
    -------
    Of each direction, over all elements of the detector: mean sunlight without stray light, dark
    signal and offset taken off, as the mean output of one unit. For outputs in proportion to
    light: frames, profiles, currents; not for the times of events.

    Raises
    ------
    ValueError
        When the two put out arrays of different shapes.
    """
    count = len(directions)
    pattern = diffracted.fixed_pattern("geometric-error")
    origins = diffracted.origins(directions, generator("geometric-error"))
    bright = Scene(directions, np.ones(count), np.zeros(count), origins)
    dark = replace(bright, irradiance=np.zeros(count))
    found, expected = (
        (sensor.expected(bright, pattern) - sensor.expected(dark, pattern)).reshape(count, -1)
        for sensor in (geometric, diffracted)
    )
    if found.shape != expected.shape:
        raise ValueError(
            f"both sensors must put out the same; got {found.shape[1]} and {expected.shape[1]} "
            "elements a sample"
        )
    peak = np.abs(expected).max(axis=1)
    apart = np.abs(found - expected).max(axis=1)
    return np.asarray(apart / np.where(peak > 0, peak, 1.0))
