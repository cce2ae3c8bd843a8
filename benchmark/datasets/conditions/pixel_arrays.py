"""Pixel arrays behind masks: pixels, assembly, conditions, design; frames or windows of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any, TypeVar

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.conditions.alignment import MISALIGNED, careful_alignment, misalign
from benchmark.datasets.conditions.other_light import with_albedo
from benchmark.datasets.conditions.propagation import GLASS, LIGHT
from benchmark.datasets.conditions.since_calibration import since_calibration
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.diffraction import propagation
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import DarkCurrent, PixelArray
from benchmark.simulator.readout.pixel_errors import PixelErrors
from benchmark.simulator.sensors.diffractive_frames import DiffractiveFrameSensor
from benchmark.simulator.sensors.frames import FrameSensor
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor
from benchmark.simulator.sensors.uneven_frames import UnevenFrameSensor, UnevenIrradiance

#: Wires and oxide over a photodiode, mm: the tunnel that oblique light has to pass.
_STACK_MM = 0.003
#: A CMOS array's. Half a percent of the charge to each neighbour and a gain that falls by 1 to 2
#: percent up to the full well, quadratically, are those of a sensor for ultraviolet astronomy (SRI
#: 4K x 2K); 1 % is what GSENSE4040 guarantees. Columns differ twice as much as pixels do
#: (Pereira, J. Aerosp. Technol. Manag. 5, 2013); half a digital number, and a tenth of the read
#: noise from frame to frame, are round numbers.
_CMOS_ERRORS = PixelErrors(
    crosstalk=0.02, nonlinearity=0.01, column_offset_e=15.0, column_noise_e=3.0
)
#: A frame-transfer CCD's: one amplifier, so no columns; images shift under their mask within half
#: a millisecond to some, here 1 us a row of an exposure of 10 ms.
_CCD_ERRORS = PixelErrors(crosstalk=0.02, smear=1e-4, nonlinearity=0.005)
#: End of life: after 5.3e10 protons/cm2 of 50 MeV two CMOS sensors had hundreds of times the dark
#: current, gain and read noise as before (Liu et al., arXiv:2312.01851). A tenth of that here,
#: tens of times; how many pixels are hot, and how much, are round numbers.
_AGED_DARK, _AGED_HOT = 20.0, {"hot": 0.01, "hot_factor": 20.0}

PixelSensor = TypeVar("PixelSensor", FrameSensor, MultiSpotSensor)


def windows(
    *,
    name: str,
    version: int,
    drawn_as: int | None = None,
    detector: str,
    mask: str,
    sensor: DiffractiveFrameSensor,
    setups: Mapping[str, Condition],
    geometry: SensorGeometry,
    directions: AngleField,
    follows: tuple[str, ...],
    description: str,
    more: Mapping[str, Condition] = MappingProxyType({}),
    kind: type[Preset] = Preset,
) -> Preset:
    """Return a dataset of windows around the light of one opening; `kind` is its class.

    It sees the Earth in one condition beside `setups`; `more` come after it.
    """
    columns, rows = sensor.window_px
    nominal = setups["nominal"]
    return kind(
        name=name,
        version=version,
        drawn_as=drawn_as,
        detector=detector,
        mask=mask,
        observation=Observation.FRAMES,
        units=units(columns, rows),
        geometry=geometry,
        setups={**setups, "albedo": with_albedo(nominal.sensor, nominal.irradiance), **more},
        directions=directions,
        follows=follows,
        description=description,
        regime=propagation(sensor.camera.mask, sensor.camera.focal_length_mm, sensor.spectrum),
    )


def window(
    mask: Mask,
    focal_length_mm: float,
    detector: PixelArray,
    *,
    window_px: tuple[int, int] = (64, 64),
    sun: SolarDisc | None = None,
    assembly: Assembly | None = None,
) -> DiffractiveFrameSensor:
    """Return a sensor read out in windows; carefully assembled where nothing else is said."""
    return DiffractiveFrameSensor(
        camera=Camera(
            focal_length_mm=focal_length_mm,
            mask=mask,
            sun=sun or SolarDisc(),
            assembly=assembly or assemble(focal_length_mm),
        ),
        detector=detector,
        window_px=window_px,
        window_jitter_px=8,
    )


def assemble(focal_length_mm: float) -> Assembly:
    """Return the small errors that remain after careful assembly, 0.2 % of focal length."""
    return careful_alignment(round(0.002 * focal_length_mm, 6))


def hole(diameter_mm: float, thickness_mm: float = 0.0) -> Mask:
    """Return one round hole in a foil."""
    return Mask((Aperture("round", diameter_mm, diameter_mm),), thickness_mm)


def cmos(columns: int, pitch_mm: float, sunlit_e: float = 20_000.0) -> PixelArray:
    """Return a square array of active pixels: 10 bits, read noise of one digital number.

    As bought: crosstalk, bent gain, columns that differ, oblique light dimmed.
    """
    return PixelArray(
        columns=columns,
        rows=columns,
        pitch_mm=pitch_mm,
        sunlit_e=sunlit_e,
        full_well_e=30_000.0,
        prnu=0.01,
        dsnu=0.1,
        dark=DarkCurrent(2_000.0),
        exposure_s=0.01,
        read_noise_e=30.0,
        gain_e_per_dn=30.0,
        offset_dn=8.0,
        bits=10,
        errors=_CMOS_ERRORS,
        tunnel=round(_STACK_MM / pitch_mm, 3),
    )


def ccd(columns: int, pitch_mm: float, prnu: float = 0.01) -> PixelArray:
    """Return a square area CCD: deep wells, little noise, 12 bits; frames shift in the light."""
    return PixelArray(
        columns=columns,
        rows=columns,
        pitch_mm=pitch_mm,
        sunlit_e=60_000.0,
        full_well_e=100_000.0,
        prnu=prnu,
        dsnu=0.1,
        dark=DarkCurrent(5_000.0),
        exposure_s=0.01,
        read_noise_e=20.0,
        gain_e_per_dn=30.0,
        offset_dn=16.0,
        bits=12,
        errors=_CCD_ERRORS,
    )


def units(columns: int, rows: int) -> str:
    """Return what the observations are, for the card."""
    return f"digital numbers, uint16 (N, {rows}, {columns}), [sample, row, column]"


def design(sensor: PixelSensor, half_fov_deg: float, **known: Any) -> SensorGeometry:
    """Return what the builder of a sensor knows of it: of its mask, what is `known`."""
    return SensorGeometry(
        focal_length_mm=sensor.camera.focal_length_mm,
        pixel_pitch_mm=sensor.detector.pitch_mm,
        centre_px=sensor.detector.centre_px,
        half_fov_deg=half_fov_deg,
        **known,
    )


def pixel_conditions(
    sensor: PixelSensor,
    light: Irradiance = LIGHT,
    *,
    careful_also: str = "",
    off_centre: str = "mask 50 and -40 um off centre",
) -> dict[str, Condition]:
    """Return nominal, low-noise, high-noise, misaligned, hot and aged for a nominal sensor.

    Low noise is ten times the electrons at 12 bits; high noise a fifth of them with five times
    the read noise and the offset raised, so that noise is not clipped; misaligned is far above
    the noise; hot is 80 deg C; aged is the end of life; of the last two there are the conditions
    of `since_calibration`. Two of them say in a dataset's own words
    what else is so of the careful assembly, and how far its mask is off centre where it is
    misaligned.
    """
    detector, camera = sensor.detector, sensor.camera
    errors = misalign(round(0.025 * camera.focal_length_mm, 6))
    return {
        "nominal": Condition(
            "Carefully assembled sensor: tilts of hundredths of a degree, focal length 0.2 % "
            f"long, {100.0 * detector.prnu:g} % pixel gain spread{careful_also}; "
            f"{as_bought(detector)}.",
            sensor,
            light,
        ),
        "low-noise": Condition(
            "The same sensor with ten times the electrons and a 12-bit converter.",
            replace(
                sensor,
                detector=replace(
                    detector,
                    sunlit_e=10.0 * detector.sunlit_e,
                    full_well_e=10.0 * detector.full_well_e,
                    gain_e_per_dn=10.0 * detector.gain_e_per_dn * 2.0 ** (detector.bits - 12),
                    bits=12,
                ),
            ),
            light,
        ),
        "high-noise": Condition(
            "The same sensor with a fifth of the electrons and five times the read noise; the "
            "converter's offset is raised so that noise is not clipped.",
            replace(
                sensor,
                detector=replace(
                    detector,
                    sunlit_e=detector.sunlit_e / 5.0,
                    read_noise_e=5.0 * detector.read_noise_e,
                    offset_dn=4.0 * detector.offset_dn,
                ),
            ),
            light,
        ),
        "misaligned": Condition(
            f"The nominal sensor {MISALIGNED}, focal length 2.5 % long, {off_centre}.",
            replace(sensor, camera=replace(camera, assembly=errors)),
            light,
        ),
        **since_calibration(
            "hot",
            "The nominal sensor at 80 deg C: dark current doubles every 7 K",
            replace(
                sensor,
                detector=replace(detector, dark=replace(detector.dark, temperature_c=80.0)),
            ),
            sensor,
            light,
        ),
        **since_calibration(
            "aged",
            "The nominal sensor at the end of its life (some 5e9 protons/cm2): "
            f"{_AGED_DARK:g} times the dark current, and one pixel in a hundred hot, with "
            f"{_AGED_HOT['hot_factor']:g} times as much again on average",
            replace(sensor, detector=aged(detector)),
            sensor,
            light,
        ),
    }


def aged(detector: PixelArray) -> PixelArray:
    """Return the detector after years in orbit."""
    dark = replace(detector.dark, at_25_c=_AGED_DARK * detector.dark.at_25_c)
    return replace(detector, dark=dark, errors=replace(detector.errors, **_AGED_HOT))


def as_bought(detector: PixelArray) -> str:
    """Say what a detector's pixels and amplifiers do beside noise."""
    errors, said = detector.errors, []
    if errors.crosstalk:
        said.append(f"{100.0 * errors.crosstalk:g} % crosstalk")
    if errors.smear:
        said.append(f"{100.0 * errors.smear:g} % smear per row")
    if errors.nonlinearity:
        said.append(f"{100.0 * errors.nonlinearity:g} % nonlinearity at full well")
    if errors.column_offset_e:
        what = "column" if detector.rows > 1 else "pixel"
        said.append(f"{what} offsets of {errors.column_offset_e:g} electrons")
    return ", ".join(said)


def missing_apertures(sensor: MultiSpotSensor, light: Irradiance = LIGHT) -> Condition:
    """Return the condition in which 20 % of the apertures are closed and 10 % dirty."""
    return Condition(
        "The nominal sensor with 20 % of the apertures closed and another 10 % dirty, passing "
        "20 to 80 % of the light.",
        replace(sensor, errors=replace(sensor.errors, missing=0.2, dirty=0.1)),
        light,
    )


def glass(sensor: FrameSensor, effect: str, light: Irradiance = LIGHT) -> Condition:
    """Return the condition of a cover glass on the detector, with its `effect` in words."""
    camera = replace(sensor.camera, glass=GLASS)
    return Condition(
        f"The nominal sensor with 0.5 mm of glass (index 1.52) on the detector: {effect}.",
        replace(sensor, camera=camera),
        light,
    )


def stray_gradient(sensor: UnevenFrameSensor, stray: float) -> Condition:
    """Return the condition of stray light ten times as strong, which slopes."""
    return Condition(
        "The nominal sensor under ten times the stray light, which slopes across the detector "
        "by a quarter from the middle to the edge (standard deviation), anew for each sample.",
        sensor,
        UnevenIrradiance(stray=stray, stray_spread=stray / 5.0, slope_spread=stray / 4.0),
    )


def incline(sensor: FrameSensor, mask: Mask) -> Condition:
    """Return the condition of a slit that stands askew: of the `mask` handed in."""
    return Condition(
        "The nominal sensor with its slit turned by 5 deg against the pixel columns.",
        replace(sensor, camera=replace(sensor.camera, mask=mask)),
        LIGHT,
    )
