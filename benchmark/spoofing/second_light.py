"""A laser that shines into a sensor beside the Sun: its light enters before noise and read-out."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.optics.diffraction import Spectrum
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern
from benchmark.simulator.sensors.faces import Faces
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor

#: Green, of one wavelength.
GREEN = Spectrum((532.0,), (1.0,))
_POINT = SolarDisc(diameter_deg=0.0)


@lru_cache(maxsize=4)  # sensors keep tables of what they have seen
def lit_by_laser(sensor: Any) -> Any:
    """Return the sensor as a distant point of one wavelength lights it.

    Of sensors whose light is rendered by itself (`lit`) and added to as `Scene.albedo`.
    """
    if isinstance(sensor, Faces):
        return replace(sensor, sun=_POINT)  # type: ignore[type-var]
    camera = replace(sensor.camera, sun=_POINT)
    if hasattr(sensor, "spectrum"):
        return replace(sensor, camera=camera, spectrum=GREEN)
    return replace(sensor, camera=camera)


def with_laser(
    sensor: Any, scene: Scene, pattern: FixedPattern, laser: Floats, suns: float
) -> Scene:
    """Return a scene in which a laser shines from (N, 3), too; ValueError with the Earth in it.

    `suns` is its signal at normal incidence over that of the mean Sun: for irradiance, divide by
    the detector's response at the laser's wavelength over that to sunlight.
    """
    if scene.albedo is not None:
        raise ValueError("a laser takes the place of the Earth's light; the scene has some")
    seen = replace(
        scene, sun=laser, irradiance=np.full(len(scene), float(suns)), stray=np.zeros(len(scene))
    )
    built = isinstance(sensor, Faces | MultiSpotSensor)
    lit = lit_by_laser(sensor)
    light = lit.lit(seen, pattern) if built else lit.lit(seen)
    return replace(scene, albedo=light)
