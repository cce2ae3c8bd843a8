"""`pva-maskless-panels`: the currents of solar panels on the six faces of a satellite."""

from __future__ import annotations

from dataclasses import replace

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.fields import SphereField
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.light.environment import Earth, Irradiance
from benchmark.simulator.readout.detectors import CurrentReadout
from benchmark.simulator.sensors.faces import CUBE
from benchmark.simulator.sensors.solar_cells import SolarCells, SolarCellSensor

_SENSOR = SolarCellSensor(
    normals=CUBE,
    readout=CurrentReadout(
        sunlit_ua=500_000.0,
        gain_mismatch=0.01,
        noise_ua=500.0,
        full_scale_ua=1_000_000.0,
        bits=12,
    ),
    cells=SolarCells(
        in_series=2,
        mismatch=0.02,
        temperature_per_k=0.0006,
        temperature_c=25.0,
        heating_k=40.0,
    ),
    normal_error_deg=0.2,
)
_LIGHT = Irradiance(stray=0.002, stray_spread=0.0004)

PRESET = Preset(
    name="pva-maskless-panels",
    version=1,
    detector="PVA",
    mask="Maskless",
    observation=Observation.CURRENTS,
    units="microamperes, float64 (N, 6): panels +x, -x, +y, -y, +z, -z",
    geometry=SensorGeometry(face_normals=CUBE),
    setups={
        "nominal": Condition(
            "New panels of two cells in series, matched to 2 %, 40 K warmer in full sunlight "
            "than in the dark; Kelly response, noise of 1e-3 of full sunlight, no Earth.",
            _SENSOR,
            _LIGHT,
        ),
        "cosine": Condition(
            "The nominal panels with cells that follow Lambert's cosine.",
            replace(_SENSOR, response="cosine"),
            _LIGHT,
        ),
        "low-noise": Condition(
            "The same panels with a tenth of the noise and a 16-bit converter.",
            replace(_SENSOR, readout=replace(_SENSOR.readout, noise_ua=50.0, bits=16)),
            _LIGHT,
        ),
        "high-noise": Condition(
            "The same panels with ten times the noise.",
            replace(_SENSOR, readout=replace(_SENSOR.readout, noise_ua=5_000.0)),
            _LIGHT,
        ),
        "misaligned": Condition(
            "The nominal panels mounted 2 deg off their faces' normals.",
            replace(_SENSOR, normal_error_deg=2.0),
            _LIGHT,
        ),
        "hot": Condition(
            "The nominal panels 55 K warmer: currents 3.3 % higher.",
            replace(_SENSOR, cells=replace(_SENSOR.cells, temperature_c=80.0)),
            _LIGHT,
        ),
        "cold": Condition(
            "The nominal panels 85 K colder: currents 5.1 % lower.",
            replace(_SENSOR, cells=replace(_SENSOR.cells, temperature_c=-60.0)),
            _LIGHT,
        ),
        "aged": Condition(
            "The nominal panels after years in orbit: cells have lost 20 % of their current, "
            "5 % more or less from cell to cell, and the weaker one of a panel counts.",
            replace(_SENSOR, cells=replace(_SENSOR.cells, loss=0.2, loss_spread=0.05)),
            _LIGHT,
        ),
        "albedo": Condition(
            "The nominal panels in a 600 km orbit with the sunlit Earth in view on the test "
            "split, position random where the Sun is visible; calibrated on the ground without "
            "Earth.",
            _SENSOR,
            _LIGHT,
            earth=Earth(),
        ),
    },
    directions=SphereField(),
    follows=("Nurgizat2021", "Lu2017b", "Post2013", "Hermoso2022b"),
    description=(
        "The short-circuit currents of body-mounted panels (eq:msfsc), Sun from anywhere on the "
        "sphere. The studies followed give the arrangement and the errors: angular response, "
        "temperature, Earth, degradation. Round numbers for the rest: a panel is two cells of "
        "0.5 A, the large cells of a small satellite's face; 0.06 % a kelvin is typical of "
        "multi-junction cells; 40 K lie between a panel's sunlit and dark sides."
    ),
    regime={"propagation": "geometric", "reason": "nothing casts a shadow"},
)
