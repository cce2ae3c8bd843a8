"""Currents of a few photodiodes: gains, noise, conversion and what references tell of them."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Mapping

import numpy as np

from algorithms.contract import Floats
from benchmark.seeds import generator
from benchmark.simulator.readout.detectors import CurrentReadout
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.readout.quantisation import reading_variance
from benchmark.simulator.readout.references import (
    ElementSpread,
    References,
    posterior,
    readings_information,
)
from benchmark.simulator.scene import Scene


def element_gains(readout: CurrentReadout, count: int, *names: str | int) -> Floats:
    """(K,) relative gains of one unit's elements."""
    return 1.0 + readout.gain_mismatch * generator(*names, "gain").standard_normal(count)


def currents(readout: CurrentReadout, response: Floats, pattern: Mapping[str, Floats]) -> Floats:
    """(N, K) mean microamperes for `response` in units of mean sunlight at normal incidence."""
    return np.asarray(readout.sunlit_ua * response * pattern["gain"] + readout.dark.level())


def spread(readout: CurrentReadout, gain_spread: float, references: References) -> ElementSpread:
    """Return what is unknown of a channel, in microamperes; dark currents are the design's."""
    dark = readout.dark.level()
    light = references.level * (readout.full_scale_ua - dark)
    noise = math.sqrt(readout.electron_ua * (light + dark) + readout.noise_ua**2)
    codes = readings_information(noise / readout.step_ua, references.flats)
    return posterior((gain_spread, 0.0), light, (codes / readout.step_ua**2, 0.0))


class CurrentSensor:
    """K elements whose currents are read out, whatever light falls on them.

    The base of frozen dataclasses with a field `readout`.
    """

    readout: CurrentReadout

    @abstractmethod
    def expected(self, scene: Scene, pattern: Mapping[str, Floats]) -> Floats:
        """(N, K) mean microamperes."""
        ...

    def origins(self, sun: Floats, generator: np.random.Generator) -> None:
        """Nothing is windowed (the arguments are the protocol's)."""

    def variance(self, expected: Floats) -> Floats:
        """Squared microamperes: shot noise of the current, amplifier noise, rounding, clipping."""
        step, top = self.readout.step_ua, 2.0 ** (self.readout.bits - 1)
        deviation = self._deviation(expected) / step
        codes = reading_variance(expected / step, deviation, -top, top - 1.0)
        return np.asarray(codes * step**2)

    def unit_variance(self, expected: Floats, scene: Scene, references: References) -> Floats:  # noqa: ARG002 - the protocol's
        """Squared microamperes that unknown gains, drawn with `gain_mismatch`, add."""
        light = expected - self.readout.dark.level()
        return spread(self.readout, self.readout.gain_mismatch, references).variance(light)

    def reference_readings(
        self, pattern: Mapping[str, Floats], references: References, streams: NoiseStreams
    ) -> dict[str, Floats]:
        """``dark_ua`` and ``flat_ua`` (K,): mean readings of the unit's elements.

        Every element gets the light that gives one of gain 1 a current of `References.level` of
        full scale. What there are no readings of is left out.
        """
        gains, dark = pattern["gain"], self.readout.dark.level()
        light = references.level * (self.readout.full_scale_ua - dark)
        means = {
            "dark_ua": (references.darks, np.full(len(gains), dark)),
            "flat_ua": (references.flats, dark + light * gains),
        }
        return {
            name: np.mean(self.read(np.tile(mean, (count, 1)), streams), axis=0)
            for name, (count, mean) in means.items()
            if count
        }

    def observe(self, scene: Scene, pattern: Mapping[str, Floats], streams: NoiseStreams) -> Floats:
        """(N, K) microamperes read out."""
        return self.read(self.expected(scene, pattern), streams)

    def _deviation(self, expected: Floats) -> Floats:
        shot = self.readout.electron_ua * np.maximum(expected, 0.0)
        return np.asarray(np.sqrt(shot + self.readout.noise_ua**2))

    def read(self, expected: Floats, streams: NoiseStreams) -> Floats:
        """(N, K) microamperes of currents `expected`: whole codes within the converter's range."""
        step, top = self.readout.step_ua, 2.0 ** (self.readout.bits - 1)
        noise = self._deviation(expected) * streams.gaussian.standard_normal(expected.shape)
        codes = np.clip(np.rint((expected + noise) / step), -top, top - 1.0)
        return np.asarray(codes * step + 0.0)  # + 0.0: no negative zero in the data
