"""C21: what a temperature coefficient of every face is worth from -40 to 80 deg C (Lu2017a).

Each calibration sample and the whole test split are taken at temperatures of the sensor that are
given with them. `temperature` learns a coefficient a face there; the model behind it, which takes a
signal for a cosine, reads the same signals with and without. It is `basic`, which needs the faces
of a cube: pva-maskless-panels has them, and so has pd-maskless-cube, the arrangement of the study.
On pd-maskless-pyramid its counterpart `pyramidal` stands in. The statistic is the geometric mean of
the three ratios at 80 deg C.

Panels are as their data set has them: all of one coefficient, each as much warmer than stated as it
is lit. Photodiodes on the ground do not change with temperature in their data sets; here they do
as those that fly (pd-orbit): each with a coefficient of its own. Their dark current doubles every
7 K, as everywhere. The plot, and no statistic, has the cube without dark current beside them, read
by `assembled-faces`, whose own errors are small enough for those of temperature to show; the
panels, which the coefficient does not change, are not drawn.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from functools import partial
from typing import Any

import numpy as np

from algorithms.chain import Chain
from algorithms.compensations.environment.temperature import TemperatureDrift
from algorithms.contract import FeatureKind, Floats, Model
from algorithms.extractors.currents.photodiode import DirectSignals
from algorithms.models.geometric.multisensor_fusion import SixFaces
from algorithms.models.geometric.pyramidal import RegularPyramid
from algorithms.models.physics_informed.assembled_faces import AssembledFaces
from benchmark.claims.benches import ratio, rms, separation
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.geometry.alterations import alter
from benchmark.datasets.conditions.orbits import PHOTODIODES
from benchmark.datasets.preset import Preset
from benchmark.datasets.standard import pd_maskless_cube, pd_maskless_pyramid, pva_maskless_panels
from benchmark.seeds import generator
from benchmark.simulator.flight.time_series import DriftingFaceSensor, TimedScene
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.faces import FaceSensor

TEMPERATURES_K = (233.15, 263.15, 293.15, 323.15, 353.15)
_ICE_K = 273.15
_TESTED = 400

#: Readings (n, K) of a sensor of a unit's elements, all at one temperature.
Reading = Callable[[Any, Scene, Any, NoiseStreams, float], Floats]


def trial(number: int) -> Trial:
    """Measure one unit of every sensor."""
    ratios, lines = [], {}
    for judged, ground, aloft, read, model in (
        (True, pd_maskless_cube.PRESET, _aloft, _photodiodes, SixFaces),
        (True, pd_maskless_pyramid.PRESET, _aloft, _photodiodes, RegularPyramid),
        (True, pva_maskless_panels.PRESET, _same, _panels, SixFaces),
        (False, pd_maskless_cube.PRESET, _without_dark, _photodiodes, AssembledFaces),
    ):
        without, with_it = _errors(alter(ground, aloft), ground, number, read, model)
        if judged:
            ratios.append(ratio(without[-1], with_it[-1]))
        if read is _photodiodes:
            body = ground.name.removeprefix("pd-maskless-") if judged else "no dark current"
            what = f"{body}, {model.about.name}"
            lines[what] = (TEMPERATURES_K, without)
            lines[f"{what}, compensated"] = (TEMPERATURES_K, with_it)
    return Trial({"mitigates": math.prod(ratios) ** (1.0 / len(ratios))}, lines)


def _errors(
    preset: Preset, bench: Preset, unit: int, read: Reading, model: type[Model]
) -> tuple[Sequence[float], Sequence[float]]:
    """RMS errors by temperature without the coefficients and with them."""
    sun = bench.for_unit(unit).generate("nominal", "calibration").sun
    rng = generator("claims", "C21", preset.name, unit)
    mixed = rng.choice(TEMPERATURES_K, size=len(sun))
    take = partial(_signals, preset.for_unit(unit), read)
    known = take("calibration", mixed)
    tested = preset.scene("nominal", "test", _TESTED).sun
    kinds = model, Chain((TemperatureDrift,), model)
    fitted = [one.for_sensor(preset.geometry, FeatureKind.SIGNALS) for one in kinds]
    for one in fitted:
        one.fit(known, sun, {"temperature_K": mixed})
    errors: list[list[float]] = [[], []]
    for kelvin in TEMPERATURES_K:
        same = np.full(len(tested), kelvin)
        asked = take("test", same)
        for one, found in zip(fitted, errors, strict=True):
            said = one.predict(asked, {"temperature_K": same})
            found.append(rms(separation(said, tested)))
    return errors[0], errors[1]


def _signals(preset: Preset, read: Reading, split: str, kelvin: Floats) -> Floats:
    """Signals (N, K) of a split, each sample at its temperature (N,)."""
    scene = preset.scene("nominal", split, len(kelvin))
    sensor: Any = preset.condition("nominal").sensor
    pattern = preset.fixed_pattern("nominal")
    streams = NoiseStreams.named("claims", "C21", preset.name, preset.unit, split)
    readings = np.empty((len(kelvin), len(sensor.normals)))
    for level in TEMPERATURES_K:
        there = np.flatnonzero(kelvin == level)
        if len(there):
            readings[there] = read(sensor, scene.rows(there), pattern, streams, level)
    return DirectSignals.for_sensor(preset.geometry).extract(readings)


def _panels(
    sensor: Any, scene: Scene, pattern: Any, streams: NoiseStreams, kelvin: float
) -> Floats:
    cells = replace(sensor.cells, temperature_c=kelvin - _ICE_K)
    return np.asarray(replace(sensor, cells=cells).observe(scene, pattern, streams))


def _photodiodes(
    sensor: Any, scene: Scene, pattern: Any, streams: NoiseStreams, kelvin: float
) -> Floats:
    count = len(scene)
    moment = {"temperature_k": np.full(count, kelvin), "age_years": np.zeros(count)}
    seen = TimedScene(scene.sun, scene.irradiance, scene.stray, **moment)
    return np.asarray(sensor.observe(seen, pattern, streams))


def _without_dark(sensor: FaceSensor) -> DriftingFaceSensor:
    """Return the same with nothing read in the dark."""
    warming = _aloft(sensor)
    dark = replace(warming.readout.dark, at_25_c=0.0)
    return replace(warming, readout=replace(warming.readout, dark=dark))


def _same(sensor: Any) -> Any:
    return sensor


def _aloft(sensor: FaceSensor) -> DriftingFaceSensor:
    """Return the same photodiodes, which change with temperature."""
    parts = {field.name: getattr(sensor, field.name) for field in fields(FaceSensor)}
    return DriftingFaceSensor(**parts, drift=PHOTODIODES)
