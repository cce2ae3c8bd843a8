"""`pd-orbit`: the photodiode cube on a tumbling satellite, Earth in view, in and out of eclipse."""

from __future__ import annotations

from dataclasses import fields, replace

from benchmark.datasets.conditions.flight import Flight, FlightPreset, Span
from benchmark.datasets.preset import Condition
from benchmark.datasets.standard import pd_maskless_cube
from benchmark.simulator.flight.attitude import Tumble
from benchmark.simulator.flight.drift import PhotodiodeDrift, ThermalCycle
from benchmark.simulator.flight.orbit import CircularOrbit
from benchmark.simulator.flight.time_series import DriftingFaceSensor
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.sensors.faces import FaceSensor

_GROUND = pd_maskless_cube.PRESET


def _flying(condition: str) -> DriftingFaceSensor:
    still = _GROUND.setups[condition].sensor
    same = {f.name: getattr(still, f.name) for f in fields(FaceSensor)}
    return DriftingFaceSensor(
        **same,
        drift=PhotodiodeDrift(
            gain_per_k=1e-3,
            gain_per_k_spread=2e-4,
            loss_per_year=0.02,
            loss_per_year_spread=0.01,
        ),
        thermal=ThermalCycle(),
    )


_SENSOR = _flying("nominal")
_LIGHT = _GROUND.setups["nominal"].irradiance
_EARTH = Earth()

PRESET = FlightPreset(
    name="pd-orbit",
    version=1,
    detector="PD",
    mask="Maskless",
    observation=_GROUND.observation,
    units=_GROUND.units,
    geometry=_GROUND.geometry,
    setups={
        "nominal": Condition(
            "The nominal unit design of pd-maskless-cube in orbit: sunlit Earth in view, gain "
            "+0.1 %/K with 0.02 %/K from face to face, 2 % a year of ageing with 1 % from face to "
            "face.",
            _SENSOR,
            _LIGHT,
            earth=_EARTH,
        ),
        "no-albedo": Condition("The nominal sensor over a black Earth.", _SENSOR, _LIGHT),
        "low-noise": Condition(
            "The nominal sensor with a tenth of the noise and a 16-bit converter.",
            _flying("low-noise"),
            _LIGHT,
            earth=_EARTH,
        ),
        "high-noise": Condition(
            "The nominal sensor with ten times the noise.",
            _flying("high-noise"),
            _LIGHT,
            earth=_EARTH,
        ),
        "misaligned": Condition(
            "The nominal sensor with photodiodes mounted 2 deg off their faces' normals.",
            _flying("misaligned"),
            _LIGHT,
            earth=_EARTH,
        ),
        "hot": Condition(
            "The nominal sensor on a satellite 40 K warmer throughout.",
            replace(_SENSOR, thermal=ThermalCycle(sunlit_k=348.15, eclipse_k=288.15)),
            _LIGHT,
            earth=_EARTH,
        ),
        "stable": Condition(
            "The nominal sensor without thermal drift and ageing of its gains.",
            replace(_SENSOR, drift=PhotodiodeDrift()),
            _LIGHT,
            earth=_EARTH,
        ),
    },
    directions=Flight(
        orbit=CircularOrbit(altitude_km=600.0, inclination_deg=97.79, node_deg=337.5),
        attitude=Tumble(
            momentum_sun_deg=90.0,
            nutation_deg=75.0,
            precession_deg_s=0.2531,
            inertia_ratio=0.4,
        ),
        epoch_day=0.0,
        calibration=Span(start_day=0.0, samples=1740, step_s=10.0),
        test=Span(start_day=90.0, samples=1740, step_s=10.0),
    ),
    follows=("Frezza2022", "OKeefe2017"),
    description=(
        "The cube of pd-maskless-cube flown on a sun-synchronous orbit of 600 km (node at 10:30, "
        "a third of every orbit in eclipse) on a satellite that tumbles slowly, as after "
        "detumbling, so that the Sun passes over nearly the whole sphere. Six cosine-type "
        "photodiodes aided by a magnetometer are Frezza2022's arrangement; albedo that ends with "
        "eclipse and calibration in orbit are OKeefe2017's (eq:mnoise). Neither gives orbit or "
        "drift in what was mapped: round numbers instead. Calibration: sunlight of the first three "
        "orbits, Earth in view as later; test: three whole orbits a quarter of a year on, the "
        "same unit aged. The sensor relaxes towards 35 deg C in sunlight and -25 deg C in eclipse "
        "with a time constant of 2000 s."
    ),
    regime=_GROUND.regime,
)
