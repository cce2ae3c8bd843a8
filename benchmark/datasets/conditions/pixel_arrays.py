"""The named conditions that pixel arrays behind masks share."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

from benchmark.datasets.preset import Condition
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.sensors.frames import FrameSensor
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor

PixelSensor = TypeVar("PixelSensor", FrameSensor, MultiSpotSensor)

#: Small errors that remain after careful assembly; 0.2 % of focal length is set by the dataset.
CAREFUL = Assembly(
    tilt_x_deg=0.05, tilt_y_deg=-0.03, rotation_deg=0.05, offset_x_mm=0.004, offset_y_mm=-0.003
)
LIGHT = Irradiance(stray=0.002, stray_spread=0.0004)


def pixel_conditions(sensor: PixelSensor, light: Irradiance = LIGHT) -> dict[str, Condition]:
    """Return nominal, low-noise, high-noise, misaligned and hot for a nominal sensor.

    Low noise is ten times the electrons at 12 bits; high noise a fifth of them with five times
    the read noise and the offset raised, so that noise is not clipped; misaligned is far above
    the noise; hot is 80 deg C.
    """
    detector, camera = sensor.detector, sensor.camera
    errors = Assembly(
        tilt_x_deg=1.0,
        tilt_y_deg=-0.7,
        rotation_deg=0.5,
        focal_length_error_mm=round(0.025 * camera.focal_length_mm, 6),
        offset_x_mm=0.05,
        offset_y_mm=-0.04,
    )
    return {
        "nominal": Condition(
            "Carefully assembled sensor: tilts of hundredths of a degree, focal length 0.2 % "
            "long, 1 % pixel gain spread.",
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
            "The nominal sensor tilted by 1.0 and -0.7 deg, turned by 0.5 deg, focal length "
            "2.5 % long, mask 50 and -40 um off centre: far above the noise.",
            replace(sensor, camera=replace(camera, assembly=errors)),
            light,
        ),
        "hot": Condition(
            "The nominal sensor at 80 deg C: dark current doubles every 7 K.",
            replace(
                sensor,
                detector=replace(detector, dark=replace(detector.dark, temperature_c=80.0)),
            ),
            light,
        ),
    }


def missing_apertures(sensor: MultiSpotSensor, light: Irradiance = LIGHT) -> Condition:
    """Return the condition in which 20 % of the apertures are closed and 10 % dirty."""
    return Condition(
        "The nominal sensor with 20 % of the apertures closed and another 10 % dirty, passing "
        "20 to 80 % of the light.",
        replace(sensor, errors=replace(sensor.errors, missing=0.2, dirty=0.1)),
        light,
    )
