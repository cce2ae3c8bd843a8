"""Pixel arrays that see many spots at once: frames read out whole, of a mask of many apertures."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from algorithms.contract import Observation
from benchmark.datasets.conditions.full_frames import FullFramePreset, drawn
from benchmark.datasets.conditions.pixel_arrays import (
    assembled,
    design,
    missing_apertures,
    pixel_conditions,
    units,
)
from benchmark.datasets.conditions.propagation import geometric
from benchmark.datasets.fields import Field
from benchmark.datasets.repeats import FEW
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.apertures import Mask
from benchmark.simulator.masks.errors import MaskErrors
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import PixelArray
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor

#: What else the builder of a sensor knows of it, and what else its regime says; nothing.
NOTHING: Mapping[str, Any] = MappingProxyType({})


def many_spots(
    *,
    name: str,
    version: int,
    detector: str,
    mask: str,
    sensor: MultiSpotSensor,
    diameter_mm: float,
    half_fov_deg: float,
    directions: Field,
    without: tuple[str, ...] = (),
    follows: tuple[str, ...],
    description: str,
    known: Mapping[str, Any] = NOTHING,
    regime: Mapping[str, Any] = NOTHING,
) -> FullFramePreset:
    """Return a dataset of full frames behind round holes.

    Parameters
    ----------
    without
        Conditions of pixel arrays that it does without.
    known, regime
        What else the builder knows of the sensor, and what else the regime says.
    """
    pixels = sensor.detector
    setups = pixel_conditions(sensor)
    return FullFramePreset(
        name=name,
        version=version,
        detector=detector,
        mask=mask,
        observation=Observation.FRAMES,
        units=units(pixels.columns, pixels.rows),
        geometry=design(
            sensor,
            half_fov_deg,
            aperture_width_mm=diameter_mm,
            aperture_shape="round",
            apertures=drawn(sensor.camera.mask),
            **known,
        ),
        setups={
            **{condition: setup for condition, setup in setups.items() if condition not in without},
            "missing-apertures": missing_apertures(sensor),
        },
        directions=directions,
        repeats=FEW,
        follows=follows,
        description=description,
        regime={**geometric(diameter_mm, sensor.camera.focal_length_mm), **regime},
    )


def behind(
    mask: Mask, focal_length_mm: float, detector: PixelArray, directions_of_sun: int
) -> MultiSpotSensor:
    """Return a carefully assembled sensor whose holes are off by about 1 um.

    Parameters
    ----------
    directions_of_sun
        That sample the Sun's disc: so many that pixels are within 0.5 % of peak of more.
    """
    return MultiSpotSensor(
        camera=Camera(
            focal_length_mm=focal_length_mm,
            mask=mask,
            sun=SolarDisc(spiral=directions_of_sun),
            assembly=assembled(focal_length_mm),
        ),
        detector=detector,
        errors=MaskErrors(position_mm=0.001, size_mm=0.001, edge_mm=0.0005),
    )
