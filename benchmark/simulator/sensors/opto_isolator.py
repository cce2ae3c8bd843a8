"""Currents of opto-isolators used as light sensors on faces: `OptoIsolatorSensor`."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from algorithms.contract import Floats
from benchmark.seeds import generator
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.readout import currents as readout
from benchmark.simulator.readout.detectors import CurrentReadout, Response
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.readout.references import References
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern
from benchmark.simulator.sensors.faces import Faces


@dataclass(frozen=True)
class OptoIsolatorSensor(Faces):
    """K opto-isolators with outward normals, their phototransistors looking at the Sun.

    The transistor's gain grows with its current, so the output rises as the light to the power
    of `STEEPNESS`; gains differ from unit to unit by tens of percent. `readout.gain_mismatch`
    is the standard deviation of the logarithm of the gain (a gain is never negative), and
    `readout.sunlit_ua` the output of a unit of median gain in mean sunlight at normal incidence.
    Response, normals and assembly as in `FaceSensor`.
    """

    normals: tuple[tuple[float, float, float], ...]
    readout: CurrentReadout
    response: Response = "cosine"
    normal_error_deg: float = 0.0
    sun: SolarDisc = field(default_factory=SolarDisc)
    assembly: Assembly = field(default_factory=Assembly)

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
        return readout.currents(self.readout, steep(self.received(scene, pattern)), pattern)

    def variance(self, expected: Floats) -> Floats:
        """Squared microamperes."""
        return readout.variance(self.readout, expected)

    def unit_variance(self, expected: Floats, scene: Scene, references: References) -> Floats:  # noqa: ARG002 - the protocol's
        """Squared microamperes that unknown gains add; small spreads of their logarithm."""
        return readout.unit_variance(self.readout, expected, _dimmed(references))

    def reference_readings(
        self, pattern: FixedPattern, references: References, streams: NoiseStreams
    ) -> dict[str, Floats]:
        """``dark_ua`` and ``flat_ua`` (K,): mean readings of the isolators, flats half as bright.

        Gains differ so much that one element in a hundred would end at full scale otherwise.
        """
        return readout.mean_readings(self.readout, pattern["gain"], _dimmed(references), streams)

    def observe(self, scene: Scene, pattern: FixedPattern, streams: NoiseStreams) -> Floats:
        """(N, K) microamperes."""
        return readout.converted(self.readout, self.expected(scene, pattern), streams)


def _dimmed(references: References) -> References:
    return replace(references, level=references.level / 2.0)


#: Exponent of the output in the light: a round number between a photodiode's 1 and a square law,
#: and one that needs a square root only, which is the same on every processor.
STEEPNESS = 1.5


def steep(light: Floats) -> Floats:
    """Light to the power of `STEEPNESS`; negative light counts as none."""
    lit = np.maximum(light, 0.0)
    return np.asarray(lit * np.sqrt(lit))
