"""`ccd-orbit`: an area CCD whose assembly drifts with temperature and age along an orbit."""

from __future__ import annotations

from dataclasses import fields, replace

from benchmark.datasets.conditions.flight import Flight, FlightPreset, Span
from benchmark.datasets.preset import Condition
from benchmark.datasets.standard import ccd_single_aperture
from benchmark.simulator.flight.attitude import Tumble
from benchmark.simulator.flight.drift import AssemblyDrift, ThermalCycle
from benchmark.simulator.flight.orbit import CircularOrbit
from benchmark.simulator.flight.time_series import DriftingFrameSensor
from benchmark.simulator.optics.plates import CoverGlass, Plate
from benchmark.simulator.sensors.frames import FrameSensor

_GROUND = ccd_single_aperture.PRESET


def _flying(condition: str) -> DriftingFrameSensor:
    still = _GROUND.setups[condition].sensor
    same = {f.name: getattr(still, f.name) for f in fields(FrameSensor)}
    same["camera"] = replace(same["camera"], glass=CoverGlass((Plate(0.5, 1.52),)))
    return DriftingFrameSensor(
        **same,
        drift=AssemblyDrift(
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
        ),
        thermal=ThermalCycle(),
    )


_SENSOR = _flying("nominal")
_LIGHT = _GROUND.setups["nominal"].irradiance

PRESET = FlightPreset(
    name="ccd-orbit",
    version=2,
    detector="CCD",
    mask="Single-Ap.",
    observation=_GROUND.observation,
    units=_GROUND.units,
    geometry=_GROUND.geometry,
    setups={
        "nominal": Condition(
            "The nominal sensor of ccd-single-aperture under a filter of 0.5 mm of glass (index "
            "1.52), its head moving with temperature and age.",
            _SENSOR,
            _LIGHT,
        ),
        "low-noise": Condition(
            "The nominal sensor with the noise of ccd-single-aperture's low-noise condition.",
            _flying("low-noise"),
            _LIGHT,
        ),
        "high-noise": Condition(
            "The nominal sensor with the noise of ccd-single-aperture's high-noise condition.",
            _flying("high-noise"),
            _LIGHT,
        ),
        "misaligned": Condition(
            "The nominal sensor, misaligned at first as ccd-single-aperture's of that name.",
            _flying("misaligned"),
            _LIGHT,
        ),
        "hot": Condition(
            "The nominal sensor on a satellite 40 K warmer throughout.",
            replace(_SENSOR, thermal=ThermalCycle(sunlit_k=348.15, eclipse_k=288.15)),
            _LIGHT,
        ),
        "stable": Condition(
            "The nominal sensor with an assembly that does not drift.",
            replace(_SENSOR, drift=AssemblyDrift()),
            _LIGHT,
        ),
    },
    directions=Flight(
        orbit=CircularOrbit(altitude_km=600.0, inclination_deg=97.79, node_deg=337.5),
        attitude=Tumble(
            momentum_sun_deg=24.0,
            nutation_deg=24.0,
            precession_deg_s=0.2531,
            inertia_ratio=0.75,
        ),
        epoch_day=0.0,
        calibration=Span(start_day=0.0, samples=870, step_s=20.0),
        test=Span(start_day=90.0, samples=870, step_s=20.0),
    ),
    follows=("Radan2019",),
    description=(
        "The sensor of ccd-single-aperture flown on a sun-synchronous orbit of 600 km, on a "
        "satellite whose nutation takes the Sun from the boresight to 48 deg and back in 24 min. "
        "Error sources are Radan2019's (model:assem): installation, shift of the CCD's centre, "
        "misalignment, and a filter in front; its mask is not known for certain (several slits, "
        "by inference) and is not followed. It gives no amounts: an aluminium spacer of 2 mm "
        "(23 ppm/K) lengthens by 46 nm/K, unequal expansion (15 ppm/K over 2 mm) shifts the mask "
        "by 30 and -20 nm/K, the bracket bends by 0.5 and -0.3 mdeg/K; creep of one to two um "
        "and hundredths of a degree a year. Calibration: sunlight of the first three orbits; "
        "test: three whole orbits a quarter of a year on. The sensor relaxes towards 35 deg C in "
        "sunlight and -25 deg C in eclipse with a time constant of 2000 s. In eclipse the window "
        "stays where the Sun was last seen. Light from the Earth is left out: see "
        "benchmark.sweeps.albedo_influence."
    ),
    regime=_GROUND.regime,
)
