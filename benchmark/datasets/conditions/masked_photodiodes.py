"""A few photodiodes, or one device with a few electrodes, under an opening; conditions, design."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Literal, TypeVar

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.conditions.alignment import MISALIGNED
from benchmark.datasets.conditions.pixel_arrays import hole
from benchmark.datasets.conditions.propagation import LIGHT
from benchmark.datasets.conditions.since_calibration import since_calibration
from benchmark.datasets.conditions.uneven_light import UnevenPreset
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.plates import CoverGlass
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import CurrentReadout, DarkCurrent, Quadrants
from benchmark.simulator.sensors.code_dial import CodeDialSensor
from benchmark.simulator.sensors.position_sensitive import LateralEffect, PositionSensor
from benchmark.simulator.sensors.quadrants import QuadrantSensor
from benchmark.simulator.sensors.slit_pairs import SlitPairSensor

Masked = TypeVar("Masked", QuadrantSensor, SlitPairSensor, PositionSensor, CodeDialSensor)

#: Four readings, one a quadrant, in their order.
QUADRANTS = "Q1 (-x, +y), Q2 (+x, +y), Q3 (+x, -y), Q4 (-x, -y)"


def masked_photodiodes(
    *,
    name: str,
    version: int,
    drawn_as: int | None = None,
    detector: str,
    mask: str,
    readings: str,
    geometry: SensorGeometry,
    setups: Mapping[str, Condition],
    follows: tuple[str, ...],
    description: str,
    regime: Mapping[str, Any],
) -> Preset:
    """Return a dataset of four currents, whose `readings` are said in words.

    Raises
    ------
    ValueError
        When the geometry has no field of view, which the directions cover.
    """
    if geometry.half_fov_deg is None:
        raise ValueError(f"{name} needs half_fov_deg in its geometry")
    return UnevenPreset(
        name=name,
        version=version,
        drawn_as=drawn_as,
        detector=detector,
        mask=mask,
        observation=Observation.CURRENTS,
        units=f"microamperes, float64 (N, 4): {readings}",
        geometry=geometry,
        setups=setups,
        directions=AngleField(geometry.half_fov_deg),
        follows=follows,
        description=description,
        regime=regime,
    )


def through(
    mask: Mask, focal_length_mm: float, assembly: Assembly, glass: CoverGlass | None = None
) -> Camera:
    """Return the optics over a few large photodiodes.

    What they read changes smoothly with the edge of the light: few points of the Sun are enough.
    """
    return Camera(
        focal_length_mm=focal_length_mm,
        mask=mask,
        sun=SolarDisc(rings=(4, 8)),
        glass=glass or CoverGlass(),
        assembly=assembly,
    )


def rectangular_opening(
    width_mm: float, height_mm: float, thickness_mm: float = 0.0, rotation_deg: float = 0.0
) -> Mask:
    """Return one rectangular opening."""
    return Mask(
        (Aperture("rectangle", width_mm, height_mm, rotation_deg=rotation_deg),), thickness_mm
    )


def quadrants(camera: Camera, half_width_mm: float, gap_mm: float) -> QuadrantSensor:
    """Return four photodiodes on a square under an opening."""
    return QuadrantSensor(camera, Quadrants(half_width_mm, gap_mm), amplifiers(100.0, 0.02, 120.0))


def amplifiers(
    sunlit_ua: float, noise_ua: float, full_scale_ua: float, gain_mismatch: float = 0.01
) -> CurrentReadout:
    """Return 14-bit amplifiers, with as much dark current as noise."""
    return CurrentReadout(
        sunlit_ua=sunlit_ua,
        gain_mismatch=gain_mismatch,
        noise_ua=noise_ua,
        full_scale_ua=full_scale_ua,
        bits=14,
        dark=DarkCurrent(noise_ua),
    )


def design(
    sensor: Masked, half_fov_deg: float, width_mm: float, shape: Literal["square"] | None = "square"
) -> SensorGeometry:
    """Return what the builder of a sensor knows: balances are shares of `width_mm`."""
    return SensorGeometry(
        focal_length_mm=sensor.camera.focal_length_mm,
        aperture_width_mm=width_mm,
        aperture_shape=shape,
        half_fov_deg=half_fov_deg,
        gap_mm=getattr(getattr(sensor, "detector", None), "gap_mm", None),
    )


def usual(sensor: Masked, nominal: str, off_centre: str, errors: Assembly) -> dict[str, Condition]:
    """Return nominal, low-noise, high-noise and misaligned.

    Parameters
    ----------
    sensor
        Under its nominal condition.
    nominal, off_centre
        In words: the nominal condition, and how the misaligned one is beside its tilts.
    errors
        Of the misaligned one.
    """
    return {
        "nominal": Condition(nominal, sensor, LIGHT),
        **noises(sensor),
        "misaligned": Condition(
            f"The nominal sensor {MISALIGNED}, {off_centre}.",
            replace(sensor, camera=replace(sensor.camera, assembly=errors)),
            LIGHT,
        ),
    }


def noises(sensor: Masked) -> dict[str, Condition]:
    """Return a tenth and ten times of the noise."""
    readout = sensor.readout
    quiet = replace(readout, noise_ua=readout.noise_ua / 10.0, bits=18)
    loud = replace(readout, noise_ua=readout.noise_ua * 10.0)
    return {
        "low-noise": Condition(
            "The same sensor with a tenth of the noise and an 18-bit converter.",
            replace(sensor, readout=quiet),
            LIGHT,
        ),
        "high-noise": Condition(
            "The same sensor with ten times the noise.", replace(sensor, readout=loud), LIGHT
        ),
    }


def temperatures(sensor: Masked) -> dict[str, Condition]:
    """Return hot and cold."""
    said = "The nominal sensor at -40 deg C: no dark current"
    return {
        **hot(sensor),
        **since_calibration("cold", said, at(sensor, -40.0), sensor, LIGHT),
    }


def hot(sensor: Masked, also: str = "") -> dict[str, Condition]:
    """Return the conditions of 80 deg C, with what else there is to say of them."""
    return since_calibration(
        "hot",
        f"The nominal sensor at 80 deg C: dark current doubles every 7 K{also}",
        at(sensor, 80.0),
        sensor,
        LIGHT,
    )


def at(sensor: Masked, temperature_c: float) -> Masked:
    """Return the sensor with the dark current of a temperature."""
    dark = replace(sensor.readout.dark, temperature_c=temperature_c)
    return replace(sensor, readout=replace(sensor.readout, dark=dark))


def wide_gap(sensor: QuadrantSensor) -> Condition:
    """Return the condition of quadrants 0.2 mm apart."""
    return Condition(
        "The nominal sensor with a gap of 0.2 mm, a tenth of the aperture.",
        replace(sensor, detector=replace(sensor.detector, gap_mm=0.2)),
        LIGHT,
    )


def round_aperture(sensor: QuadrantSensor, geometry: SensorGeometry) -> Condition:
    """Return the condition of a round aperture; `geometry` is that of the square one."""
    (square,) = sensor.camera.mask.apertures
    mask = hole(square.width_mm, sensor.camera.mask.thickness_mm)
    return Condition(
        "The nominal sensor behind a round aperture of the same width: the balance is no longer "
        "linear in the tangent.",
        replace(sensor, camera=replace(sensor.camera, mask=mask)),
        LIGHT,
        geometry=replace(geometry, aperture_shape="round"),
    )


def thick_slit(sensor: SlitPairSensor) -> Condition:
    """Return the condition of slits whose walls shade the light."""
    mask = replace(sensor.camera.mask, thickness_mm=0.1)
    return Condition(
        "The nominal sensor with slits 0.1 mm thick, whose walls shade the strip of light.",
        replace(sensor, camera=replace(sensor.camera, mask=mask)),
        LIGHT,
    )


def linear(sensor: PositionSensor) -> Condition:
    """Return the condition of a device without non-linearity."""
    return Condition(
        "The nominal sensor with a device that is linear in position.",
        replace(sensor, detector=LateralEffect(sensor.detector.length_mm)),
        LIGHT,
    )
