"""`pva-maskless-sphere`: sixteen solar cells spread over a spherical satellite."""

from __future__ import annotations

from dataclasses import replace

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.fields import SphereField
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.light.environment import Earth, Irradiance
from benchmark.simulator.readout.detectors import CurrentReadout
from benchmark.simulator.sensors.face_layouts import sphere
from benchmark.simulator.sensors.solar_cells import SolarCells, SolarCellSensor

_NORMALS = sphere(16)

_SENSOR = SolarCellSensor(
    normals=_NORMALS,
    readout=CurrentReadout(
        sunlit_ua=50_000.0,
        gain_mismatch=0.01,
        noise_ua=50.0,
        full_scale_ua=100_000.0,
        bits=12,
    ),
    cells=SolarCells(mismatch=0.02, temperature_per_k=0.0006, temperature_c=25.0, heating_k=40.0),
    normal_error_deg=0.2,
)
_LIGHT = Irradiance(stray=0.002, stray_spread=0.0004)

PRESET = Preset(
    name="pva-maskless-sphere",
    version=1,
    detector="PVA",
    mask="Maskless",
    observation=Observation.CURRENTS,
    units="microamperes, float64 (N, 16): cells on a Fibonacci lattice from +z to -z "
    "(geometry.face_normals)",
    geometry=SensorGeometry(face_normals=_NORMALS),
    setups={
        "nominal": Condition(
            "New cells, matched to 2 %, 40 K warmer in full sunlight than in the dark; Kelly "
            "response, noise of 1e-3 of full sunlight, no Earth.",
            _SENSOR,
            _LIGHT,
        ),
        "cosine": Condition(
            "The nominal cells with Lambert's cosine.",
            replace(_SENSOR, response="cosine"),
            _LIGHT,
        ),
        "low-noise": Condition(
            "The same cells with a tenth of the noise and a 16-bit converter.",
            replace(_SENSOR, readout=replace(_SENSOR.readout, noise_ua=5.0, bits=16)),
            _LIGHT,
        ),
        "high-noise": Condition(
            "The same cells with ten times the noise.",
            replace(_SENSOR, readout=replace(_SENSOR.readout, noise_ua=500.0)),
            _LIGHT,
        ),
        "misaligned": Condition(
            "The nominal cells mounted 2 deg off the sphere's normals.",
            replace(_SENSOR, normal_error_deg=2.0),
            _LIGHT,
        ),
        "hot": Condition(
            "The nominal cells 55 K warmer: currents 3.3 % higher.",
            replace(_SENSOR, cells=replace(_SENSOR.cells, temperature_c=80.0)),
            _LIGHT,
        ),
        "cold": Condition(
            "The nominal cells 85 K colder: currents 5.1 % lower.",
            replace(_SENSOR, cells=replace(_SENSOR.cells, temperature_c=-60.0)),
            _LIGHT,
        ),
        "aged": Condition(
            "The nominal cells after years in orbit: 20 % of the current lost, 5 % more or less "
            "from cell to cell.",
            replace(_SENSOR, cells=replace(_SENSOR.cells, loss=0.2, loss_spread=0.05)),
            _LIGHT,
        ),
        "albedo": Condition(
            "The nominal cells in a 600 km orbit with the sunlit Earth in view on the test "
            "split, position random where the Sun is visible; calibrated on the ground without "
            "Earth.",
            _SENSOR,
            _LIGHT,
            earth=Earth(),
        ),
    },
    directions=SphereField(test_samples=1000),
    follows=("Zhang2022b",),
    description=(
        "Single cells all over a sphere, several of them lit whatever the attitude (eq:msfpano). "
        "Zhang2022b reads 16 of the 991 cells of a spherical satellite and compensates their "
        "temperature; which 16 is not in what was mapped: here a Fibonacci lattice, the evenest "
        "simple spread. Round numbers for the rest: 50 mA a cell, otherwise as in "
        "pva-maskless-panels. Barnes2014 covers a hemisphere in the same way, with photodiodes."
    ),
    regime={"propagation": "geometric", "reason": "nothing casts a shadow"},
)
