"""Currents of a few photodiodes: gains, noise, conversion and what references tell of them."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Mapping, Sequence

import numpy as np

from algorithms.contract import Floats
from benchmark.seeds import generator
from benchmark.simulator.readout.detectors import CurrentReadout
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.readout.quantisation import reading_variance
from benchmark.simulator.readout.references import References, readings_information
from benchmark.simulator.scene import Scene


def element_gains(readout: CurrentReadout, count: int, *names: str | int) -> Floats:
    """(K,) relative gains of one unit's elements."""
    return 1.0 + readout.gain_mismatch * generator(*names, "gain").standard_normal(count)


def currents(readout: CurrentReadout, response: Floats, pattern: Mapping[str, Floats]) -> Floats:
    """(N, K) mean microamperes for `response` in units of mean sunlight at normal incidence."""
    return np.asarray(readout.sunlit_ua * response * pattern["gain"] + readout.dark.level())


def flat_information(readout: CurrentReadout, references: References) -> float:
    """Return the information of the flats on a channel's relative gain; dark currents are known."""
    dark = readout.dark.level()
    light = references.level * (readout.full_scale_ua - dark)
    noise = math.sqrt(readout.electron_ua * (light + dark) + readout.noise_ua**2)
    codes = readings_information(noise / readout.step_ua, references.flats)
    return codes * (light / readout.step_ua) ** 2


def gain_information(spreads: Sequence[float], flats: float) -> Floats:
    """(P, P) information on an element's gain and its drifts, in units of their spreads.

    Parameters
    ----------
    spreads
        Standard deviations over units, of the relative gain first.
    flats
        Information of the flats on the relative gain: they are taken before anything drifts.
    """
    known = np.eye(len(spreads))
    known[0, 0] += flats * spreads[0] ** 2
    return known


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

    @property
    def gain_spread(self) -> float:
        """Standard deviation over units of an element's relative gain."""
        return self.readout.gain_mismatch

    def gain_slopes(self, expected: Floats, scene: Scene) -> Floats:  # noqa: ARG002 - the protocol's
        """(N, K, 1) microamperes by one standard deviation of the gains."""
        return self.gain_spread * (expected - self.readout.dark.level())[..., None]

    def gain_information(self, references: References) -> Floats:
        """(1, 1) of the spread and the flats."""
        return gain_information([self.gain_spread], flat_information(self.readout, references))

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
