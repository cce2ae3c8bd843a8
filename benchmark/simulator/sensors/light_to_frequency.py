"""Frequencies of light-to-frequency converters that face different ways: `FrequencySensor`."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from algorithms.contract import Floats
from benchmark.seeds import generator
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.readout.detectors import DarkCurrent, Response
from benchmark.simulator.readout.noise import NoiseStreams, counted
from benchmark.simulator.readout.references import References, posterior
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern
from benchmark.simulator.sensors.faces import Faces


@dataclass(frozen=True)
class FrequencyCounter:
    """Converters whose pulses are counted while a gate is open.

    Pulses are taken as independent (Poisson): the pessimistic end, since a converter that
    charges a capacitor spaces them more evenly.

    Attributes
    ----------
    sunlit_hz
        Pulse rate at normal incidence in mean sunlight.
    gate_s
        Time over which pulses are counted; the frequency comes in steps of ``1 / gate_s``.
    gain_mismatch
        Standard deviation over converters of the relative gain.
    full_scale_hz
        A converter pulses no faster.
    dark
        Pulse rate without light, hertz.
    """

    sunlit_hz: float
    gate_s: float
    gain_mismatch: float
    full_scale_hz: float
    dark: DarkCurrent = field(default_factory=lambda: DarkCurrent(0.0))

    def __post_init__(self) -> None:
        if not (self.sunlit_hz > 0 and self.gate_s > 0 and self.full_scale_hz > 0):
            raise ValueError(
                "sunlit_hz, gate_s and full_scale_hz must be positive; got "
                f"{self.sunlit_hz}, {self.gate_s}, {self.full_scale_hz}"
            )


@dataclass(frozen=True)
class FrequencySensor(Faces):
    """K light-to-frequency converters with outward normals (see `FaceSensor`)."""

    normals: tuple[tuple[float, float, float], ...]
    readout: FrequencyCounter
    response: Response = "cosine"
    normal_error_deg: float = 0.0
    sun: SolarDisc = field(default_factory=SolarDisc)
    assembly: Assembly = field(default_factory=Assembly)

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """``gain`` (K,) and ``normals`` (K, 3): the unit's gains and built normals."""
        spread = generator(*names, "gain").standard_normal(len(self.normals))
        return {
            "gain": 1.0 + self.readout.gain_mismatch * spread,
            "normals": self.built_normals(*names),
        }

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, K) mean hertz."""
        rate = self.readout.sunlit_hz * self.received(scene, pattern) * pattern["gain"]
        rate += self.readout.dark.level()
        return np.asarray(np.clip(rate, 0.0, self.readout.full_scale_hz))

    def variance(self, expected: Floats) -> Floats:
        """Squared hertz: as many counts as expected, and 1/12 for whole counts."""
        gate = self.readout.gate_s
        return np.asarray((np.maximum(expected, 0.0) * gate + 1.0 / 12.0) / gate**2)

    def unit_variance(self, expected: Floats, scene: Scene, references: References) -> Floats:  # noqa: ARG002 - the protocol's
        """Squared hertz that unknown gains of the converters add."""
        dark = self.readout.dark.level()
        light = self._flat_hz(references)
        single = float(self.variance(np.array([light + dark]))[0])
        information = references.flats / single
        spread = posterior((self.readout.gain_mismatch, 0.0), light, (information, 0.0))
        return spread.variance(expected - dark)

    def _flat_hz(self, references: References) -> float:
        return references.level * (self.readout.full_scale_hz - self.readout.dark.level())

    def reference_readings(
        self, pattern: FixedPattern, references: References, streams: NoiseStreams
    ) -> dict[str, Floats]:
        """``dark_hz`` and ``flat_hz`` (K,): mean readings of the converters."""
        dark, light = self.readout.dark.level(), self._flat_hz(references)
        means = {
            "dark_hz": (references.darks, 0.0 * pattern["gain"]),
            "flat_hz": (references.flats, light * pattern["gain"]),
        }
        return {
            name: np.mean(self._read(np.tile(mean + dark, (count, 1)), streams), axis=0)
            for name, (count, mean) in means.items()
            if count
        }

    def observe(self, scene: Scene, pattern: FixedPattern, streams: NoiseStreams) -> Floats:
        """(N, K) hertz: whole counts over the gate time."""
        return self._read(self.expected(scene, pattern), streams)

    def _read(self, mean_hz: Floats, streams: NoiseStreams) -> Floats:
        gate = self.readout.gate_s
        counts = np.rint(counted(mean_hz * gate, 0.0, streams))
        most = np.floor(self.readout.full_scale_hz * gate)
        return np.asarray(np.clip(counts, 0.0, most) / gate)
