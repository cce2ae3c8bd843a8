"""Solar cells in orbit, each at its own temperature: `DriftingSolarCellSensor`."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.flight.drift import (
    REFERENCE_K,
    PhotodiodeDrift,
    ThermalCycle,
    dark_levels,
)
from benchmark.simulator.flight.time_series import with_times
from benchmark.simulator.readout.currents import flat_information, gain_information
from benchmark.simulator.readout.references import References
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern
from benchmark.simulator.sensors.solar_cells import SolarCellSensor


@dataclass(frozen=True)
class DriftingSolarCellSensor(SolarCellSensor):
    """Solar cells on faces whose currents follow temperature and age.

    A cell is as warm as the body, and by `cells.heating_k` warmer in mean sunlight. The cells' own
    temperature and its coefficient, and the dark current's temperature, are not used: those of
    `thermal` and `drift` take their place.
    """

    drift: PhotodiodeDrift = field(default_factory=PhotodiodeDrift)
    thermal: ThermalCycle = field(default_factory=ThermalCycle)

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """As `SolarCellSensor`; with ``gain_per_k`` and ``loss_per_year`` (K,), the cells' own."""
        drifts = self.drift.drawn(len(self.normals), *names)
        return {**super().fixed_pattern(*names), **drifts}

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, K) mean microamperes; TypeError for a scene that is not a `TimedScene`."""
        at = with_times(scene, self)
        light = self.receive(scene, pattern)
        warmer = at.temperature_k[:, None] + self.cells.heating_k * light - REFERENCE_K
        factor = (1.0 + warmer * pattern["gain_per_k"]) * (
            1.0 - at.age_years[:, None] * pattern["loss_per_year"]
        )
        string = pattern["gain"] * np.min(pattern["cells"], axis=1)
        dark = dark_levels(self.readout.dark, at.temperature_k)
        return np.asarray(self.readout.sunlit_ua * light * string * factor + dark[:, None])

    def gain_slopes(self, expected: Floats, scene: Scene) -> Floats:
        """(N, K, 3) microamperes by the strings' currents and by their drifts."""
        at = with_times(scene, self)
        light = expected - dark_levels(self.readout.dark, at.temperature_k)[:, None]
        received = light / self.readout.sunlit_ua
        warmer = at.temperature_k[:, None] + self.cells.heating_k * received - REFERENCE_K
        return self.drift.slopes(self.gain_spread, light, warmer, at.age_years[:, None])

    def gain_information(self, references: References) -> Floats:
        """(3, 3) of the spreads and the flats, which are taken before the flight."""
        drift = self.drift
        spreads = [self.gain_spread, drift.gain_per_k_spread, drift.loss_per_year_spread]
        return gain_information(spreads, flat_information(self.readout, references))
