"""Currents of opto-isolators used as light sensors on faces: `OptoIsolatorSensor`."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from algorithms.contract import Floats
from benchmark.seeds import generator
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.readout.currents import CurrentSensor, currents
from benchmark.simulator.readout.detectors import CurrentReadout, Response
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.readout.references import References
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern
from benchmark.simulator.sensors.faces import Faces


@dataclass(frozen=True)
class OptoIsolatorSensor(CurrentSensor, Faces):
    """K opto-isolators with outward normals, their phototransistors looking at the Sun.

    The light's current is the transistor's base current. Recombination in the junction takes its
    share of it, which counts the more the smaller the current (`collect`); gains differ from
    unit to unit by tens of percent. `readout.gain_mismatch` is the standard deviation of the
    logarithm of the gain (a gain is never negative), and `readout.sunlit_ua` the output of a unit
    of median gain in mean sunlight at normal incidence. Response, normals and assembly as in
    `FaceSensor`.

    Attributes
    ----------
    knee
        Light at which the gain has fallen to half of what it tends to, in units of mean sunlight.
    """

    normals: tuple[tuple[float, float, float], ...]
    readout: CurrentReadout
    response: Response = "cosine"
    normal_error_deg: float = 0.0
    sun: SolarDisc = field(default_factory=SolarDisc)
    assembly: Assembly = field(default_factory=Assembly)
    knee: float = 0.1

    def __post_init__(self) -> None:
        if not self.knee >= 0:
            raise ValueError(f"knee must not be negative; got {self.knee}")

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """``gain`` (K,) and ``normals`` (K, 3): the unit's gains and built normals."""
        spread = generator(*names, "gain").standard_normal(len(self.normals))
        mismatch = self.readout.gain_mismatch
        return {
            "gain": np.array([math.exp(mismatch * float(value)) for value in spread]),
            "normals": self.built_normals(*names),
        }

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, K) mean microamperes."""
        light = collect(self.receive(scene, pattern), self.knee)
        return currents(self.readout, light / collect(np.ones(1), self.knee), pattern)

    def gain_information(self, references: References) -> Floats:
        """(1, 1) of the spread and the dim flats; of small spreads of the gains' logarithm."""
        return super().gain_information(_dim(references))

    def reference_readings(
        self, pattern: FixedPattern, references: References, streams: NoiseStreams
    ) -> dict[str, Floats]:
        """``dark_ua`` and ``flat_ua`` (K,): mean readings of the isolators, flats half as bright.

        Gains differ so much that one element in a hundred would end at full scale otherwise.
        """
        return super().reference_readings(pattern, _dim(references), streams)


def _dim(references: References) -> References:
    return replace(references, level=references.level / 2.0)


def collect(light: Floats, knee: float) -> Floats:
    """Collector current of a phototransistor in light x, in the unit of its greatest gain.

    Gummel and Poon's law with an ideal base current and one of recombination, whose ideality
    factor is 2: ``x = I + sqrt(k I / 2)``, so that the gain ``I / x`` is 1/2 at ``x = k``, the
    knee. I rises as the square of little light, in proportion to much of it. Negative light
    counts as none.
    """
    lit = np.maximum(light, 0.0)
    lost = math.sqrt(knee / 2.0)
    # the positive root of s^2 + lost s - x = 0, s^2 the current, without a difference of equals
    below = lost + np.sqrt(knee / 2.0 + 4.0 * lit)
    root = 2.0 * lit / np.where(below > 0, below, 1.0)
    return np.asarray(root * root)
