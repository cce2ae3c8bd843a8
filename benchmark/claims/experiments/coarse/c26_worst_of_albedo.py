"""C26: what albedo can cost an analog sensor at worst (Soken2023).

Photodiodes on a cube and on a pyramid, calibrated on the ground with true directions
(`assembled-faces`), then shown Sun and Earth without noise. What the Earth costs is the angle by
which its light moves the answer. Its worst case is searched: Suns of the sensor's field and places
on the orbit's sphere are drawn at random, and the worst of them are moved about by ever smaller
angles as long as they grow worse. The Earth is of its mean reflectance, 0.3, or as bright as where
thick cloud or snow fills the visible disc, 0.7; lines show others.
"""

from __future__ import annotations

import numpy as np

from algorithms.contract import Floats
from algorithms.extractors.currents.photodiode import DirectSignals
from algorithms.models.physics_informed.assembled_faces import AssembledFaces
from benchmark.claims.benches import ConditionView, separation
from benchmark.claims.experiment import Sketch, Trial
from benchmark.claims.truth import with_true_directions
from benchmark.datasets.preset import Preset
from benchmark.datasets.standard import pd_maskless_cube, pd_maskless_pyramid
from benchmark.seeds import generator
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.faces import FaceSensor

SKETCH = Sketch(log_up=False)
MEAN, BRIGHT = 0.3, 0.7
REFLECTANCES = (0.1, 0.2, MEAN, 0.4, 0.5, 0.6, BRIGHT)
#: Half angle of the field from which the Sun may come: of the sphere, and of the pyramid's cone.
SENSORS: tuple[tuple[Preset, float], ...] = (
    (pd_maskless_cube.PRESET, 180.0),
    (pd_maskless_pyramid.PRESET, 55.0),
)
DRAWN, KEPT, ROUNDS, TRIED = 2000, 8, 10, 12
_FIRST_STEP_RAD = 0.3


def trial(number: int) -> Trial:
    """Measure one unit of both sensors."""
    costs = {
        preset.name: _Sensor(preset, half_field_deg, number).costs_deg()
        for preset, half_field_deg in SENSORS
    }
    worst = dict(zip(REFLECTANCES, map(max, zip(*costs.values(), strict=True)), strict=True))
    return Trial(
        {"mean": worst[MEAN], "bright": worst[BRIGHT]},
        {name: (REFLECTANCES, cost) for name, cost in costs.items()},
    )


class _Sensor:
    """One calibrated unit, and what the Earth does to it."""

    def __init__(self, preset: Preset, half_field_deg: float, number: int) -> None:
        seen = ConditionView(with_true_directions(preset), unit=number)
        self.pipeline = seen.calibrate(DirectSignals, AssembledFaces)
        self.extractor = DirectSignals.for_sensor(preset.geometry)
        unit = preset.for_unit(number)
        self.pattern = unit.fixed_pattern("nominal")
        sensor = unit.condition("nominal").sensor
        if not isinstance(sensor, FaceSensor):
            raise TypeError(f"faces without a mask are searched; got {type(sensor).__name__}")
        self.sensor = sensor
        self.least_z = np.cos(np.radians(half_field_deg))
        self.rng = generator("claims", "C26", preset.name, number)

    def costs_deg(self) -> list[float]:
        """Worst case found at each reflectance."""
        sun = _unit(self.rng.standard_normal((8 * DRAWN, 3)))
        sun = sun[sun[:, 2] >= self.least_z][:DRAWN]
        nadir = Earth().draw_nadir(sun, self.rng)
        light = self._earthlight(sun, nadir)
        return [self._worst(sun, nadir, light, one) for one in REFLECTANCES]

    def _worst(self, sun: Floats, nadir: Floats, light: Floats, reflectance: float) -> float:
        cost = self._cost_deg(sun, light, reflectance)
        chosen = np.argsort(cost)[-KEPT:]
        sun, nadir, cost = sun[chosen], nadir[chosen], cost[chosen]
        for turn in range(ROUNDS):
            step = _FIRST_STEP_RAD / 2.0**turn
            near = np.repeat(sun, TRIED, axis=0), np.repeat(nadir, TRIED, axis=0)
            suns, nadirs = (_unit(one + step * self.rng.standard_normal(one.shape)) for one in near)
            tried = self._cost_deg(suns, self._earthlight(suns, nadirs), reflectance)
            tried[~self._possible(suns, nadirs)] = -1.0
            best = tried.reshape(KEPT, TRIED).argmax(axis=1) + TRIED * np.arange(KEPT)
            better = tried[best] > cost
            sun[better], nadir[better] = suns[best][better], nadirs[best][better]
            cost[better] = tried[best][better]
        return float(cost.max())

    def _possible(self, sun: Floats, nadir: Floats) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        """Whether the Sun is in the field, and not behind the Earth."""
        edge = np.cos(np.radians(Earth().half_angle_deg))
        return np.asarray((sun[:, 2] >= self.least_z) & ((sun * nadir).sum(axis=1) < edge))

    def _earthlight(self, sun: Floats, nadir: Floats) -> Floats:
        """Response (N, K) to an Earth that sends all light back."""
        return self.sensor.earthlight(Earth(reflectance=1.0), sun, nadir, self.pattern)

    def _cost_deg(self, sun: Floats, light: Floats, reflectance: float) -> Floats:
        """Angles (N,) that the Earth moves answers by; -1 where one of both is none."""
        bare, seen = (self._said(sun, share * light) for share in (0.0, reflectance))
        return np.nan_to_num(separation(seen, bare), nan=-1.0)

    def _said(self, sun: Floats, albedo: Floats) -> Floats:
        even = np.ones(len(sun))
        expected = self.sensor.expected(Scene(sun, even, 0.0 * even, None, albedo), self.pattern)
        return self.pipeline.predict_features(self.extractor.extract(expected))


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.sqrt((vectors**2).sum(axis=1, keepdims=True)))
