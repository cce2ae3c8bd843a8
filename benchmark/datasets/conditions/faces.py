"""Bare elements on the faces of a body: photodiodes and what serves as one; conditions, design."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import TypeVar

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.conditions.propagation import LIGHT, NOTHING_SHADES
from benchmark.datasets.conditions.since_calibration import since_calibration
from benchmark.datasets.conditions.since_calibration import without as leave_out
from benchmark.datasets.fields import Field
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.light.environment import Earth, Irradiance
from benchmark.simulator.readout.detectors import CurrentReadout, DarkCurrent
from benchmark.simulator.sensor import Sensor
from benchmark.simulator.sensors.face_layouts import Normals, pyramid
from benchmark.simulator.sensors.faces import FaceSensor
from benchmark.simulator.sensors.light_to_frequency import FrequencySensor
from benchmark.simulator.sensors.opto_isolator import OptoIsolatorSensor
from benchmark.simulator.sensors.solar_cells import SolarCellSensor

Amplified = TypeVar("Amplified", FaceSensor, OptoIsolatorSensor, SolarCellSensor)


_Q2, _Q1, _Q4, _Q3 = pyramid(4, 30.0, first_azimuth_deg=45.0)
#: Four faces that lean outwards into the four quadrants, and their order in words.
QUADRANTS: Normals = (_Q1, _Q2, _Q3, _Q4)
TOWARDS_QUADRANTS = "faces towards Q1 (-x, +y), Q2 (+x, +y), Q3 (+x, -y), Q4 (-x, -y)"
#: The order of `benchmark.simulator.sensors.faces.CUBE`.
OF_THE_CUBE = "faces +x, -x, +y, -y, +z, -z"


def faces(
    *,
    name: str,
    version: int,
    drawn_as: int | None = None,
    detector: str,
    normals: Normals,
    order: str,
    setups: Mapping[str, Condition],
    directions: Field,
    follows: tuple[str, ...],
    description: str,
    half_fov_deg: float | None = None,
    unit: str = "microamperes",
) -> Preset:
    """Return a dataset of one reading a face, in the `order` said in words."""
    return Preset(
        name=name,
        version=version,
        drawn_as=drawn_as,
        detector=detector,
        mask="Maskless",
        observation=Observation.CURRENTS,
        units=f"{unit}, float64 (N, {len(normals)}): {order}",
        geometry=SensorGeometry(face_normals=normals, half_fov_deg=half_fov_deg),
        setups=setups,
        directions=directions,
        follows=follows,
        description=description,
        regime=NOTHING_SHADES,
    )


def photodiodes(normals: Normals, sunlit_ua: float = 100.0) -> FaceSensor:
    """Return photodiodes of Kelly's response, with room for Sun and Earth together."""
    return FaceSensor(
        normals=normals,
        readout=CurrentReadout(
            sunlit_ua=sunlit_ua,
            gain_mismatch=0.01,
            noise_ua=0.1,
            full_scale_ua=2.0 * sunlit_ua,
            bits=12,
            dark=DarkCurrent(0.05),
        ),
        normal_error_deg=0.1,
    )


def photodiode_conditions(
    sensor: FaceSensor, *, without: Collection[str] = (), cosine_also: str = ""
) -> dict[str, Condition]:
    """Return the conditions of photodiodes on faces.

    Parameters
    ----------
    sensor
        Under its nominal condition.
    without
        Conditions that the dataset does without.
    cosine_also
        What else there is to say of the condition ``cosine``.
    """
    setups = {
        "nominal": Condition(
            f"Kelly response, 1 % gain mismatch, normals within 0.1 deg, {_noise_of(sensor)} of "
            "full sunlight, no Earth.",
            sensor,
            LIGHT,
        ),
        "cosine": Condition(
            f"The nominal sensor with photodiodes that follow Lambert's cosine{cosine_also}.",
            replace(sensor, response="cosine"),
            LIGHT,
        ),
        **noises(sensor, "sensor", "a 16-bit"),
        "misaligned": Condition(
            "The nominal sensor with photodiodes mounted 2 deg off their faces' normals.",
            replace(sensor, normal_error_deg=2.0),
            LIGHT,
        ),
        **hot(sensor),
        "stray-light": Condition(
            "The nominal sensor under stray light of 5 % of sunlight (1 % from sample to sample), "
            "equal on all faces: the interference that Wang2019 suppresses.",
            sensor,
            Irradiance(stray=0.05, stray_spread=0.01),
        ),
        "albedo": albedo(sensor, "sensor"),
    }
    return leave_out(setups, *without)


def converter_conditions(sensor: FrequencySensor) -> dict[str, Condition]:
    """Return the conditions of light-to-frequency converters, which count for 20 ms."""
    counter = sensor.readout
    warm = replace(counter, dark=replace(counter.dark, temperature_c=80.0), temperature_c=80.0)
    return {
        "nominal": Condition(
            "Cosine response, gains within 5 %, normals within 0.1 deg, whole pulses counted for "
            "20 ms: 0.02 % of full sunlight, no Earth.",
            sensor,
            LIGHT,
        ),
        "kelly": Condition(
            "The nominal sensor with converters of Kelly's response.",
            replace(sensor, response="kelly"),
            LIGHT,
        ),
        "low-noise": Condition(
            "The same sensor counting ten times as long.",
            replace(sensor, readout=replace(counter, gate_s=0.2)),
            LIGHT,
        ),
        "high-noise": Condition(
            "The same sensor counting a tenth as long.",
            replace(sensor, readout=replace(counter, gate_s=0.002)),
            LIGHT,
        ),
        "misaligned": Condition(
            "The nominal sensor with converters mounted 2 deg off their faces' normals.",
            replace(sensor, normal_error_deg=2.0),
            LIGHT,
        ),
        **since_calibration(
            "hot",
            "The nominal sensor at 80 deg C: the dark frequency doubles every 7 K, frequencies "
            "rise by 100 ppm/K",
            replace(sensor, readout=warm),
            sensor,
            LIGHT,
        ),
        "albedo": albedo(sensor, "sensor"),
    }


def opto_isolator_conditions(sensor: OptoIsolatorSensor) -> dict[str, Condition]:
    """Return the conditions of opto-isolators that serve as light sensors."""
    return {
        "nominal": Condition(
            "A phototransistor's gain, halved in a tenth of sunlight; gains e^0.3 apart, normals "
            "within 1 deg, noise of 1e-3 of full sunlight, no Earth.",
            sensor,
            LIGHT,
        ),
        **noises(sensor, "sensor", "an 18-bit"),
        "misaligned": Condition(
            "The nominal sensor with opto-isolators mounted 5 deg off their faces' normals.",
            replace(sensor, normal_error_deg=5.0),
            LIGHT,
        ),
        **hot(sensor),
        "matched": Condition(
            "The nominal sensor with opto-isolators selected for gains within 2 %.",
            replace(sensor, readout=replace(sensor.readout, gain_mismatch=0.02)),
            LIGHT,
        ),
        "albedo": albedo(sensor, "sensor"),
    }


def noises(sensor: Amplified, what: str, converter: str) -> dict[str, Condition]:
    """Return a tenth and ten times of the noise; `converter` is "a 16-bit" or "an 18-bit"."""
    readout = sensor.readout
    bits = int(converter.split()[1].removesuffix("-bit"))
    quiet = replace(readout, noise_ua=readout.noise_ua / 10.0, bits=bits)
    loud = replace(readout, noise_ua=readout.noise_ua * 10.0)
    return {
        "low-noise": Condition(
            f"The same {what} with a tenth of the noise and {converter} converter.",
            replace(sensor, readout=quiet),
            LIGHT,
        ),
        "high-noise": Condition(
            f"The same {what} with ten times the noise.", replace(sensor, readout=loud), LIGHT
        ),
    }


def hot(sensor: Amplified) -> dict[str, Condition]:
    """Return the conditions of 80 deg C."""
    warm = replace(sensor.readout, dark=replace(sensor.readout.dark, temperature_c=80.0))
    return since_calibration(
        "hot",
        "The nominal sensor at 80 deg C: dark current doubles every 7 K",
        replace(sensor, readout=warm),
        sensor,
        LIGHT,
    )


def albedo(sensor: Sensor, what: str) -> Condition:
    """Return the condition of an orbit with the sunlit Earth in view."""
    return Condition(
        f"The nominal {what} in a 600 km orbit with the sunlit Earth in view on the test split, "
        "at random positions with the Sun visible; calibrated on the ground without Earth.",
        sensor,
        LIGHT,
        earth=Earth(),
    )


def _noise_of(sensor: FaceSensor) -> str:
    share = f"{sensor.readout.noise_ua / sensor.readout.sunlit_ua:.0e}".replace("e-0", "e-")
    return f"noise of {share}"
