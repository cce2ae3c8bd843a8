"""Sensors of the ground flown on one sun-synchronous orbit: drift, conditions, spans."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from benchmark.datasets.conditions.aloft import (
    FIRM,
    UNDER_GLASS,
    conditions_aloft,
    ground_conditions,
)
from benchmark.datasets.conditions.flight import Flight, FlightPreset, Span
from benchmark.datasets.conditions.instruments import ABOARD
from benchmark.datasets.conditions.propagation import GLASS
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.flight.attitude import Attitude
from benchmark.simulator.flight.drift import AssemblyDrift, PhotodiodeDrift, ThermalCycle
from benchmark.simulator.flight.drifting_cells import DriftingSolarCellSensor
from benchmark.simulator.flight.orbit import CircularOrbit
from benchmark.simulator.flight.time_series import DriftingFaceSensor, DriftingFrameSensor
from benchmark.simulator.sensors.diffractive_frames import DiffractiveFrameSensor
from benchmark.simulator.sensors.faces import FaceSensor
from benchmark.simulator.sensors.solar_cells import SolarCellSensor

#: An aluminium spacer of 2 mm lengthens, unequal expansion shifts the mask, the bracket bends; and
#: all of it creeps.
SPACER = AssemblyDrift(
    tilt_x_deg_k=5e-4,
    tilt_y_deg_k=-3e-4,
    focal_length_mm_k=4.6e-5,
    offset_x_mm_k=3e-5,
    offset_y_mm_k=-2e-5,
    tilt_x_deg_year=0.01,
    tilt_y_deg_year=0.02,
    focal_length_mm_year=1e-3,
    offset_x_mm_year=-2e-3,
    offset_y_mm_year=1e-3,
)
PHOTODIODES = PhotodiodeDrift(
    gain_per_k=1e-3, gain_per_k_spread=2e-4, loss_per_year=0.02, loss_per_year_spread=0.01
)


def in_orbit(
    *,
    name: str,
    version: int,
    drawn_as: int | None = None,
    ground: Preset,
    setups: Mapping[str, Condition],
    attitude: Attitude,
    step_s: float,
    follows: tuple[str, ...],
    description: str,
) -> FlightPreset:
    """Return a dataset of three orbits to calibrate on, and three a quarter of a year later."""
    samples = round(17_400.0 / step_s)
    return FlightPreset(
        name=name,
        version=version,
        detector=ground.detector,
        mask=ground.mask,
        observation=ground.observation,
        units=ground.units,
        geometry=ground.geometry,
        setups={condition: replace(setup, bench=ABOARD) for condition, setup in setups.items()},
        directions=Flight(
            orbit=CircularOrbit(altitude_km=600.0, inclination_deg=97.79, node_deg=337.5),
            attitude=attitude,
            epoch_day=0.0,
            calibration=Span(start_day=0.0, samples=samples, step_s=step_s),
            test=Span(start_day=90.0, samples=samples, step_s=step_s),
        ),
        follows=follows,
        description=description,
        regime=ground.regime,
        drawn_as=drawn_as,
    )


def frames_aloft(ground: Preset, drift: AssemblyDrift) -> dict[str, Condition]:
    """Return the conditions of a ground dataset's frames in orbit, under glass."""

    def flying(condition: str) -> DriftingFrameSensor:
        same = ground_conditions(ground, condition, DiffractiveFrameSensor)
        same["camera"] = replace(same["camera"], glass=GLASS)
        return DriftingFrameSensor(**same, drift=drift, thermal=ThermalCycle())

    still = replace(flying("nominal"), drift=AssemblyDrift())
    texts = {"nominal": f"The nominal sensor of {ground.name} {UNDER_GLASS}", "stable": FIRM}
    return conditions_aloft(ground, flying, still, texts)


def photodiodes_aloft(
    ground: Preset, drift: PhotodiodeDrift, what: str = "photodiodes"
) -> dict[str, Condition]:
    """Return the conditions of a ground dataset's photodiodes or cells in orbit, Earth in view."""

    def flying(condition: str) -> DriftingFaceSensor | DriftingSolarCellSensor:
        cells = isinstance(ground.condition(condition).sensor, SolarCellSensor)
        same = ground_conditions(ground, condition, SolarCellSensor if cells else FaceSensor)
        made = DriftingSolarCellSensor if cells else DriftingFaceSensor
        return made(**same, drift=drift, thermal=ThermalCycle())

    still = replace(flying("nominal"), drift=PhotodiodeDrift())
    texts = {
        "nominal": f"The nominal unit design of {ground.name} in orbit: sunlit Earth in view, gain "
        f"{100 * drift.gain_per_k:+g} %/K with {100 * drift.gain_per_k_spread:g} %/K from face "
        f"to face, {100 * drift.loss_per_year:g} % a year of ageing with "
        f"{100 * drift.loss_per_year_spread:g} % from face to face.",
        "low-noise": "The nominal sensor with a tenth of the noise and a 16-bit converter.",
        "high-noise": "The nominal sensor with ten times the noise.",
        "misaligned": f"The nominal sensor with {what} mounted 2 deg off their faces' normals.",
        "stable": "The nominal sensor without thermal drift and ageing of its gains.",
    }
    return conditions_aloft(ground, flying, still, texts, black_earth=True)
