"""Pixel arrays that see many spots at once: frames read out whole, of a mask of many apertures."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from algorithms.contract import Observation
from benchmark.datasets.conditions.full_frames import FullFramePreset, draw_frames
from benchmark.datasets.conditions.other_light import with_albedo
from benchmark.datasets.conditions.pixel_arrays import (
    assemble,
    design,
    missing_apertures,
    pixel_conditions,
    units,
)
from benchmark.datasets.conditions.since_calibration import without as leave_out
from benchmark.datasets.fields import Field
from benchmark.datasets.preset import Condition
from benchmark.datasets.repeats import FEW
from benchmark.simulator.masks.apertures import Mask
from benchmark.simulator.masks.errors import MaskErrors
from benchmark.simulator.optics.diffraction import SUNLIT_SILICON, Spectrum
from benchmark.simulator.optics.plates import fresnel_number
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import PixelArray
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor

#: What else the builder of a sensor knows of it, and what else its regime says; nothing.
NOTHING: Mapping[str, Any] = MappingProxyType({})


def many_spots(
    *,
    name: str,
    version: int,
    drawn_as: int | None = None,
    detector: str,
    mask: str,
    sensor: MultiSpotSensor,
    diameter_mm: float,
    half_fov_deg: float,
    directions: Field,
    without: tuple[str, ...] = (),
    more: Mapping[str, Condition] = NOTHING,
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
    more
        Conditions of its own, at the end.
    known, regime
        What else the builder knows of the sensor, and what else the regime says.
    """
    pixels = sensor.detector
    setups = pixel_conditions(sensor)
    return FullFramePreset(
        name=name,
        version=version,
        drawn_as=drawn_as,
        detector=detector,
        mask=mask,
        observation=Observation.FRAMES,
        units=units(pixels.columns, pixels.rows),
        geometry=design(
            sensor,
            half_fov_deg,
            aperture_width_mm=diameter_mm,
            aperture_shape="round",
            apertures=draw_frames(sensor.camera.mask),
            **known,
        ),
        setups={
            **leave_out(setups, *without),
            "missing-apertures": missing_apertures(sensor),
            "albedo": with_albedo(setups["nominal"].sensor),
            **more,
        },
        directions=directions,
        repeats=FEW,
        batch=8,
        follows=follows,
        description=description,
        regime={
            **diffract(diameter_mm, sensor.camera.focal_length_mm, sensor.spectrum),
            **regime,
        },
    )


def diffract(diameter_mm: float, height_mm: float, spectrum: Spectrum | None) -> dict[str, Any]:
    """Return the regime of round holes, of which the narrowest has this diameter.

    Raises
    ------
    ValueError
        When there is no spectrum: such a sensor casts geometric shadows.
    """
    if spectrum is None:
        raise ValueError("the regime of diffracted spots needs a spectrum; got None")
    return {
        "propagation": "diffraction",
        "fresnel_number": float(f"{fresnel_number(diameter_mm / 2.0, height_mm):.3g}"),
        "wavelength_nm": 550,
        "wavelengths_nm": list(spectrum.wavelengths_nm),
        "weights": list(spectrum.weights),
        "reason": "scalar Fresnel diffraction about the chief ray, over the Sun's disc; without "
        "a spot's skirt below 1e-4 of the peak at normal incidence",
    }


def behind(
    mask: Mask, focal_length_mm: float, detector: PixelArray, widest_deg: float
) -> MultiSpotSensor:
    """Return a carefully assembled sensor whose holes are off by about 1 um.

    Parameters
    ----------
    widest_deg
        Largest incidence of its field, tilts of assembly included.
    """
    return MultiSpotSensor(
        camera=Camera(
            focal_length_mm=focal_length_mm,
            mask=mask,
            assembly=assemble(focal_length_mm),
        ),
        detector=detector,
        errors=MaskErrors(position_mm=0.001, size_mm=0.001, edge_mm=0.0005),
        spectrum=SUNLIT_SILICON,
        widest_deg=widest_deg,
    )
