"""Short-circuit currents of solar cells, in strings, on faces: `SolarCellSensor`."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from algorithms.contract import Floats
from benchmark.seeds import generator
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.readout.currents import CurrentSensor, currents, element_gains
from benchmark.simulator.readout.detectors import CurrentReadout, Response
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.readout.references import References
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern
from benchmark.simulator.sensors.faces import Faces


@dataclass(frozen=True)
class SolarCells:
    """What turns light into current on one face.

    Attributes
    ----------
    in_series
        Cells a string; one string a face. The same current flows through all of them: that of
        the weakest.
    mismatch
        Standard deviation over cells of the relative current.
    temperature_per_k
        Relative change of the short-circuit current a kelvin above 25 deg C (eq:tempcomp, with
        a plus: short-circuit currents grow).
    temperature_c
        Of a face without light.
    heating_k
        How much warmer a face is in mean sunlight at normal incidence; in proportion to the
        light it gets.
    loss, loss_spread
        Share of the current lost to ageing: mean and standard deviation over cells.
    """

    in_series: int = 1
    mismatch: float = 0.0
    temperature_per_k: float = 0.0
    temperature_c: float = 25.0
    heating_k: float = 0.0
    loss: float = 0.0
    loss_spread: float = 0.0

    def __post_init__(self) -> None:
        if self.in_series < 1:
            raise ValueError(f"in_series must be at least 1; got {self.in_series}")
        if not 0 <= self.loss < 1:
            raise ValueError(f"loss must be in [0, 1); got {self.loss}")
        if min(self.mismatch, self.loss_spread) < 0:
            raise ValueError(
                "mismatch and loss_spread must not be negative; got "
                f"{self.mismatch}, {self.loss_spread}"
            )

    def temperature_factor(self, light: Floats) -> Floats:
        """Return the current in units of that at 25 deg C, shape of `light`."""
        warmer = self.temperature_c + self.heating_k * light - 25.0
        return np.asarray(1.0 + self.temperature_per_k * warmer)


@dataclass(frozen=True)
class SolarCellSensor(CurrentSensor, Faces):
    """K faces with a string of solar cells each, read as short-circuit currents.

    Response, normals and assembly as in `FaceSensor`; `readout.gain_mismatch` is that of the
    current sensors, beside the cells' own.
    """

    normals: tuple[tuple[float, float, float], ...]
    readout: CurrentReadout
    cells: SolarCells = field(default_factory=SolarCells)
    response: Response = "kelly"
    normal_error_deg: float = 0.0
    sun: SolarDisc = field(default_factory=SolarDisc)
    assembly: Assembly = field(default_factory=Assembly)

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """``gain`` (K,), ``cells`` (K, in_series) and ``normals`` (K, 3) of the unit.

        ``cells`` holds the cells' currents in units of a new, mean cell.
        """
        shape = (len(self.normals), self.cells.in_series)
        current = 1.0 + self.cells.mismatch * generator(*names, "cells").standard_normal(shape)
        lost = generator(*names, "ageing").standard_normal(shape)
        kept = 1.0 - np.clip(self.cells.loss + self.cells.loss_spread * lost, 0.0, 1.0)
        return {
            "gain": element_gains(self.readout, len(self.normals), *names),
            "cells": np.maximum(current, 0.0) * kept,
            "normals": self.built_normals(*names),
        }

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, K) mean microamperes of the strings."""
        light = self.receive(scene, pattern)
        # all cells of a face get the same light, so the weakest is the same one in any of it
        string = light * np.min(pattern["cells"], axis=1)
        return currents(self.readout, string * self.cells.temperature_factor(light), pattern)

    @property
    def gain_spread(self) -> float:
        """That of a single cell; of a string, which has that of its weakest cell, it is less."""
        parts = self.readout.gain_mismatch, self.cells.mismatch, self.cells.loss_spread
        return math.sqrt(math.fsum(part**2 for part in parts))

    def reference_readings(
        self, pattern: FixedPattern, references: References, streams: NoiseStreams
    ) -> dict[str, Floats]:
        """``dark_ua`` and ``flat_ua`` (K,): mean readings of the strings."""
        strings = pattern["gain"] * np.min(pattern["cells"], axis=1)
        return super().reference_readings({"gain": strings}, references, streams)
