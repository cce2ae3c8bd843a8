"""C21: what a temperature coefficient of every face is worth from -40 to 80 deg C (Lu2017a).

Six photodiodes on a cube, as the study's. Each calibration sample and the whole test split are
taken at temperatures of the sensor that are given with them. `temperature` learns a coefficient a
face there; `basic` behind it, which takes a signal for a cosine, reads the same signals with and
without. Photodiodes on the ground do not change with temperature in their data set; here they do as
those that fly (pd-orbit): each with a coefficient of its own. The survey's equation is of
short-circuit currents, which have no dark current; the plot, and no statistic, has the same faces
with one that doubles every 7 K. Measured is the angle by which a temperature moves the answers from
those at 20 deg C, same Suns and same noise: faces' angular response, which no coefficient is about,
does not count.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace
from functools import partial
from typing import Any

import numpy as np

from algorithms.chain import Chain
from algorithms.compensations.environment.temperature import TemperatureDrift
from algorithms.contract import FeatureKind, Floats
from algorithms.extractors.currents.photodiode import DirectSignals
from algorithms.models.geometric.multisensor_fusion import SixFaces
from benchmark.claims.benches import ratio, rms, separation
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.geometry.alterations import alter
from benchmark.datasets.conditions.orbits import PHOTODIODES
from benchmark.datasets.preset import Preset
from benchmark.datasets.standard import pd_maskless_cube
from benchmark.seeds import generator
from benchmark.simulator.flight.time_series import DriftingFaceSensor, TimedScene
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.sensors.faces import FaceSensor

ROOM_K = 293.15
TEMPERATURES_K = (233.15, 263.15, 323.15, 353.15)
_TESTED = 400


def trial(number: int) -> Trial:
    """Measure one unit without dark current, and with."""
    lines, values = {}, {}
    for what, aloft in (("with dark current", _aloft), ("no dark current", _without_dark)):
        without, with_it = _moved(alter(pd_maskless_cube.PRESET, aloft), number)
        lines[f"basic, {what}"] = (TEMPERATURES_K, without)
        lines[f"temperature + basic, {what}"] = (TEMPERATURES_K, with_it)
        values = {"mitigates": ratio(without[-1], with_it[-1])}
    return Trial(values, lines)


def _moved(preset: Preset, unit: int) -> tuple[Sequence[float], Sequence[float]]:
    """RMS angles by temperature between answers there and at room: without coefficients, with."""
    ground = pd_maskless_cube.PRESET
    sun = ground.for_unit(unit).generate("nominal", "calibration").sun
    rng = generator("claims", "C21", preset.name, unit)
    mixed = rng.choice((*TEMPERATURES_K, ROOM_K), size=len(sun))
    take = partial(_signals, preset.for_unit(unit))
    known = take("calibration", mixed)
    kinds = SixFaces, Chain((TemperatureDrift,), SixFaces)
    moved: list[list[float]] = []
    for kind in kinds:
        model = kind.for_sensor(preset.geometry, FeatureKind.SIGNALS)
        model.fit(known, sun, {"temperature_K": mixed})
        said = {}
        for kelvin in (ROOM_K, *TEMPERATURES_K):
            same = np.full(_TESTED, kelvin)
            said[kelvin] = model.predict(take("test", same), {"temperature_K": same})
        moved.append([rms(separation(said[kelvin], said[ROOM_K])) for kelvin in TEMPERATURES_K])
    return moved[0], moved[1]


def _signals(preset: Preset, split: str, kelvin: Floats) -> Floats:
    """Signals (N, K) of a split, each sample at its temperature (N,)."""
    count = len(kelvin)
    scene = preset.scene("nominal", split, count)
    sensor: Any = preset.condition("nominal").sensor
    seen = TimedScene(
        scene.sun, scene.irradiance, scene.stray, temperature_k=kelvin, age_years=np.zeros(count)
    )
    streams = NoiseStreams.named("claims", "C21", preset.name, preset.unit, split)
    readings = sensor.observe(seen, preset.fixed_pattern("nominal"), streams)
    return DirectSignals.for_sensor(preset.geometry).extract(np.asarray(readings))


def _without_dark(sensor: FaceSensor) -> DriftingFaceSensor:
    """Return the same with nothing read in the dark."""
    warming = _aloft(sensor)
    dark = replace(warming.readout.dark, at_25_c=0.0)
    return replace(warming, readout=replace(warming.readout, dark=dark))


def _aloft(sensor: FaceSensor) -> DriftingFaceSensor:
    """Return the same photodiodes, which change with temperature."""
    parts = {field.name: getattr(sensor, field.name) for field in fields(FaceSensor)}
    return DriftingFaceSensor(**parts, drift=PHOTODIODES)
