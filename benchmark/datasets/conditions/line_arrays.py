"""Linear arrays behind slits: pixels, assembly, conditions, design."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.conditions.alignment import careful_alignment, misalign
from benchmark.datasets.conditions.other_light import with_albedo
from benchmark.datasets.conditions.pixel_arrays import as_bought
from benchmark.datasets.conditions.propagation import GLASS, LIGHT
from benchmark.datasets.conditions.since_calibration import since_calibration
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.apertures import Mask
from benchmark.simulator.masks.slits import SlitErrors, slit_rows
from benchmark.simulator.optics.plates import CoverGlass, fresnel_number
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import DarkCurrent, PixelArray
from benchmark.simulator.readout.pixel_errors import PixelErrors
from benchmark.simulator.sensors.blooming_lines import BloomingLineSensor
from benchmark.simulator.sensors.line_sensor import LineAxis, LineSensor

#: For pixels of some 10 um, over a dozen of which the Sun blurs an edge at 60 deg: the steps that
#: single points make must not show (0.2 % of the peak).
SUN = SolarDisc(rings=(28, 28, 28, 28, 28, 28))

#: Linear arrays have no image to shift. Crosstalk and bent gain of CCDs and active pixels are those
#: of area arrays (`pixel_arrays`); photodiode arrays fall short of proportion by 0.4 % (TSL1401),
#: and their pixels are larger than charge wanders: half of the crosstalk. Where each pixel has an
#: amplifier of its own, offsets are a round digital number.
_CCD_ERRORS = PixelErrors(crosstalk=0.02, nonlinearity=0.005)
_CMOS_ERRORS = PixelErrors(crosstalk=0.02, nonlinearity=0.01, column_offset_e=60.0)
_DIODE_ERRORS = PixelErrors(crosstalk=0.01, nonlinearity=0.004, column_offset_e=300.0)

ASSEMBLED = careful_alignment(0.003)
SLITS_ASSEMBLED = SlitErrors(deflection_deg=0.03, inclination_deg=0.05)
MISASSEMBLED = misalign(0.03)
SLITS_MISASSEMBLED = SlitErrors(deflection_deg=0.5, inclination_deg=1.0)


def line_arrays(
    *,
    name: str,
    version: int,
    drawn_as: int | None = None,
    detector: str,
    mask: str,
    sensor: LineSensor,
    half_fov_deg: float,
    follows: tuple[str, ...],
    description: str,
    more: Mapping[str, Condition] = MappingProxyType({}),
    kind: type[Preset] = Preset,
) -> Preset:
    """Return a dataset of linear arrays behind slits, with conditions of its own at the end.

    `kind` is its class.
    """
    return kind(
        name=name,
        version=version,
        drawn_as=drawn_as,
        detector=detector,
        mask=mask,
        observation=Observation.PROFILES,
        units=units(sensor),
        geometry=design(sensor, half_fov_deg),
        setups={**conditions(sensor, half_fov_deg), **more},
        directions=AngleField(half_fov_deg),
        follows=follows,
        description=description,
        regime=regime(sensor),
    )


def behind(
    mask: Mask,
    focal_length_mm: float,
    detector: PixelArray,
    *,
    axes: tuple[LineAxis, ...] = ("x", "y"),
    sun: SolarDisc | None = None,
    glass: CoverGlass | None = None,
    pixel_height_mm: float = 0.2,
    fill_factor: float = 1.0,
) -> LineSensor:
    """Return a carefully assembled sensor: a mask over one array an axis."""
    return LineSensor(
        camera=Camera(
            focal_length_mm=focal_length_mm,
            mask=mask,
            sun=sun or SolarDisc(),
            glass=glass or CoverGlass(),
            assembly=ASSEMBLED,
        ),
        detector=detector,
        pixel_height_mm=pixel_height_mm,
        axes=axes,
        fill_factor=fill_factor,
        errors=SLITS_ASSEMBLED,
    )


def ccd(columns: int, pitch_mm: float) -> PixelArray:
    """Return a linear CCD: deep wells, little noise, 12 bits."""
    return PixelArray(
        columns=columns,
        rows=1,
        pitch_mm=pitch_mm,
        sunlit_e=60_000.0,
        full_well_e=100_000.0,
        prnu=0.01,
        dsnu=0.1,
        dark=DarkCurrent(5_000.0),
        exposure_s=0.01,
        read_noise_e=20.0,
        gain_e_per_dn=25.0,
        offset_dn=16.0,
        bits=12,
        errors=_CCD_ERRORS,
    )


def active_pixels(columns: int, pitch_mm: float) -> PixelArray:
    """Return a linear CMOS array as of 2013: noisier than a CCD, 10 bits."""
    return PixelArray(
        columns=columns,
        rows=1,
        pitch_mm=pitch_mm,
        sunlit_e=40_000.0,
        full_well_e=60_000.0,
        prnu=0.02,
        dsnu=0.2,
        dark=DarkCurrent(5_000.0),
        exposure_s=0.01,
        read_noise_e=60.0,
        gain_e_per_dn=60.0,
        offset_dn=8.0,
        bits=10,
        errors=_CMOS_ERRORS,
    )


def photodiode_array(columns: int, pitch_mm: float, bits: int = 10) -> PixelArray:
    """Return a linear photodiode array: larger wells, noise and gain spread than a CCD's."""
    return PixelArray(
        columns=columns,
        rows=1,
        pitch_mm=pitch_mm,
        sunlit_e=200_000.0,
        full_well_e=300_000.0,
        prnu=0.03,
        dsnu=0.2,
        dark=DarkCurrent(20_000.0),
        exposure_s=0.01,
        read_noise_e=300.0,
        gain_e_per_dn=300_000.0 / 2.0**bits,
        offset_dn=8.0,
        bits=bits,
        errors=_DIODE_ERRORS,
    )


def conditions(sensor: LineSensor, half_fov_deg: float) -> dict[str, Condition]:
    """Return the named conditions of a carefully assembled sensor."""
    detector = sensor.detector
    low = replace(
        detector,
        sunlit_e=10.0 * detector.sunlit_e,
        full_well_e=10.0 * detector.full_well_e,
        gain_e_per_dn=detector.gain_e_per_dn * 10.0 / 16.0,
        bits=detector.bits + 4,
    )
    noise = 5.0 * detector.read_noise_e
    high = replace(
        detector,
        sunlit_e=detector.sunlit_e / 5.0,
        read_noise_e=noise,
        offset_dn=detector.offset_dn + 5.0 * noise / detector.gain_e_per_dn,
    )
    hot = replace(detector, dark=replace(detector.dark, temperature_c=80.0))
    misaligned = replace(
        sensor,
        camera=replace(sensor.camera, assembly=MISASSEMBLED),
        errors=SLITS_MISASSEMBLED,
    )
    setups = {
        "nominal": (
            (
                "Carefully assembled sensor: tilts, slit deflection and inclination of hundredths "
                f"of a degree, {detector.prnu:.0%} pixel gain spread; {as_bought(detector)}."
            ),
            sensor,
        ),
        "low-noise": (
            "The same sensor with ten times the electrons and a converter of four more bits.",
            replace(sensor, detector=low),
        ),
        "high-noise": (
            (
                "The same sensor with a fifth of the electrons and five times the read noise; the "
                "converter's offset is raised so that noise is not clipped."
            ),
            replace(sensor, detector=high),
        ),
        "misaligned": (
            (
                "The nominal sensor tilted by 1.0 and -0.7 deg, turned by 0.5 deg, mask 30 um too "
                "high, 50 and -40 um off centre, slits deflected by 0.5 and inclined by 1.0 deg."
            ),
            misaligned,
        ),
    }
    if not sensor.camera.glass.plates:
        setups["glass"] = (
            (
                "The nominal sensor with 0.5 mm of glass (index 1.52) on the detector: refraction "
                "pulls the light inwards, reflection dims it."
            ),
            replace(sensor, camera=replace(sensor.camera, glass=GLASS)),
        )
    named = {
        name: Condition(
            text, setup, LIGHT, geometry=design(setup, half_fov_deg) if name == "glass" else None
        )
        for name, (text, setup) in setups.items()
    }
    return {
        **named,
        **since_calibration(
            "hot",
            "The nominal sensor at 80 deg C: dark current doubles every 7 K",
            replace(sensor, detector=hot),
            sensor,
            LIGHT,
        ),
        "albedo": with_albedo(sensor),
    }


def design(sensor: LineSensor, half_fov_deg: float) -> SensorGeometry:
    """Return what the builder of a sensor knows of it."""
    middle = sensor.detector.centre_px[0]
    mask, plates = sensor.camera.mask, sensor.camera.glass.plates
    return SensorGeometry(
        focal_length_mm=sensor.camera.focal_length_mm,
        pixel_pitch_mm=sensor.detector.pitch_mm,
        centre_px=(middle, middle),  # both coordinates are counted in pixels of the array
        aperture_width_mm=mask.apertures[0].width_mm,
        half_fov_deg=half_fov_deg,
        line_axes=sensor.axes,
        line_pixels=sensor.detector.columns,
        slits=slit_rows(mask),
        mask_thickness_mm=mask.thickness_mm,
        cover_glass=tuple((plate.thickness_mm, plate.index) for plate in plates) or None,
    )


def units(sensor: LineSensor) -> str:
    """Return what the observations are, for the card."""
    parts = [
        f"columns {k * sensor.detector.columns} to {(k + 1) * sensor.detector.columns - 1} the "
        f"array along {axis}"
        for k, axis in enumerate(sensor.axes)
    ]
    return f"digital numbers, uint16 (N, {sensor.width_px}): {', '.join(parts)}"


def regime(sensor: LineSensor) -> dict[str, Any]:
    """Return how light is propagated, and what is left out."""
    narrowest = min(a.smallest_half_width_mm for a in sensor.camera.mask.apertures)
    found = {
        "fresnel_number": float(f"{fresnel_number(narrowest, sensor.camera.focal_length_mm):.3g}"),
        "wavelength_nm": 550,
    }
    if sensor.spectrum is None:
        return {"propagation": "geometric", **found, "reason": "light that does not diffract"}
    return {
        "propagation": "diffraction",
        **found,
        "wavelengths_nm": list(sensor.spectrum.wavelengths_nm),
        "weights": list(sensor.spectrum.weights),
        "mapping": "chief ray",
        "reason": "an edge spreads over sqrt(lambda h), more than a pixel or a part of it that "
        "counts: scalar Fresnel diffraction about the chief ray with the cubic term of the phase, "
        "at every chord of the Sun's disc",
        "left_out": "diffraction at a slit's ends, which lie beyond the arrays all over the field; "
        "interference of light of different slits, farther apart than sunlight is coherent (60 "
        "um); polarisation. Six wavelengths differ from 48 by at most 0.2 % of peak",
    }


def saturate(sensor: LineSensor) -> Condition:
    """Return the condition in which full pixels of a CCD spill their charge along the line."""
    return Condition(
        "The nominal sensor exposed eight times as long, without anti-blooming drains: full pixels "
        "spill their charge along the line, so that the spot is flat and wider on either side.",
        BloomingLineSensor(
            camera=sensor.camera,
            detector=replace(sensor.detector, sunlit_e=8.0 * sensor.detector.sunlit_e),
            pixel_height_mm=sensor.pixel_height_mm,
            axes=sensor.axes,
            fill_factor=sensor.fill_factor,
            errors=sensor.errors,
            spectrum=sensor.spectrum,
        ),
        LIGHT,
    )
