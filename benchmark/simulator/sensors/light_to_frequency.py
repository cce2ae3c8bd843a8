"""Frequencies of light-to-frequency converters that face different ways: `FrequencySensor`."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from algorithms.contract import Floats
from benchmark.seeds import generator
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.readout.currents import gain_information
from benchmark.simulator.readout.detectors import DarkCurrent, Response
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.readout.references import References
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern
from benchmark.simulator.sensors.faces import Faces


@dataclass(frozen=True)
class FrequencyCounter:
    """Converters whose pulses are counted while a gate is open.

    A converter charges a capacitor and empties it with every pulse, so that pulses follow each
    other evenly. The gate opens at any moment between two of them: of a mean of n pulses, the
    whole ones below n are counted always, one more with the chance of what is left. Beside that
    the counts vary by the light's own noise, of which a pulse averages millions of electrons, and
    by the gate's jitter.

    Attributes
    ----------
    sunlit_hz
        Pulse rate at normal incidence in mean sunlight, before `nonlinearity`.
    gate_s
        Time over which pulses are counted; the frequency comes in steps of ``1 / gate_s``.
    gain_mismatch
        Standard deviation over converters of the relative gain.
    full_scale_hz
        A converter pulses no faster.
    dark
        Pulse rate without light, hertz.
    nonlinearity
        Share by which a rate of 100 kHz falls short of proportion; the shortfall of others grows
        with the square of the rate.
    gain_per_k, temperature_c
        Relative change of the rate a kelvin from 25 degrees on, and the converters' temperature.
    pulse_e
        Electrons of light in a pulse.
    jitter_counts
        Standard deviation of a count by the gate's own jitter.
    """

    sunlit_hz: float
    gate_s: float
    gain_mismatch: float
    full_scale_hz: float
    dark: DarkCurrent = field(default_factory=lambda: DarkCurrent(0.0))
    nonlinearity: float = 0.0
    gain_per_k: float = 0.0
    temperature_c: float = 25.0
    pulse_e: float = 3e7
    jitter_counts: float = 0.01

    def __post_init__(self) -> None:
        if not (self.sunlit_hz > 0 and self.gate_s > 0 and self.full_scale_hz > 0):
            raise ValueError(
                "sunlit_hz, gate_s and full_scale_hz must be positive; got "
                f"{self.sunlit_hz}, {self.gate_s}, {self.full_scale_hz}"
            )
        if not (self.pulse_e > 0 and self.jitter_counts > 0):
            raise ValueError(
                "pulse_e and jitter_counts must be positive; got "
                f"{self.pulse_e} and {self.jitter_counts}"
            )
        if not 0 <= self.nonlinearity * self.full_scale_hz < 5e4:
            raise ValueError(
                "nonlinearity must leave rates rising up to full_scale_hz, that is be in [0, "
                f"{5e4 / self.full_scale_hz:g}); got {self.nonlinearity}"
            )

    def rate(self, light: Floats, gain: Floats) -> Floats:
        """Mean hertz of converters of these gains in `light` (N, K), units of mean sunlight."""
        warm = 1.0 + self.gain_per_k * (self.temperature_c - 25.0)
        rate = np.maximum(self.sunlit_hz * warm * gain * light, 0.0) + self.dark.level()
        np.minimum(rate, self.full_scale_hz, out=rate)
        return np.asarray(rate * (1.0 - self.nonlinearity * rate / 1e5))

    def spread_counts(self, counts: Floats) -> Floats:
        """Return the standard deviation of counts (...) apart from where the gate opens."""
        return np.asarray(np.sqrt(counts / self.pulse_e + self.jitter_counts**2))


def counts_variance(mean: Floats, deviation: Floats) -> Floats:
    """Inverse of what whole counts tell of their mean: the variance that bounds must use.

    A count is the whole part of ``mean + deviation z + u``, z normal and u uniform in [0, 1): k
    has the chance ``P_k``, the mean of the triangle ``max(0, 1 - |x - k|)`` over the normal x.
    The information is the sum of ``P_k'^2 / P_k``; without deviation it is ``1 / (p (1 - p))``, p
    being what the mean has beyond a whole number.

    Parameters
    ----------
    mean, deviation
        (...) counts; the deviation is positive.
    """
    part = mean - np.floor(mean)
    reach = 2 + math.ceil(8.0 * float(np.max(deviation, initial=0.0)))
    information = np.zeros(mean.shape)
    for k in range(-reach, reach + 2):
        # the triangle is a second difference of the ramp, whose mean is z Phi(z) + phi(z)
        above, here, below = ((part - k + d) / deviation for d in (1.0, 0.0, -1.0))
        chance = deviation * (_ramp(above) - 2.0 * _ramp(here) + _ramp(below))
        slope = _normal(above) - 2.0 * _normal(here) + _normal(below)
        seen = chance > 1e-12  # less is rounding of the difference, and tells nothing
        information += np.where(seen, slope * slope / np.where(seen, chance, 1.0), 0.0)
    return np.asarray(1.0 / information)


def _normal(z: Floats) -> Floats:
    """Return the normal distribution up to z."""
    from scipy.special import ndtr  # noqa: PLC0415 - SciPy on demand

    return np.asarray(ndtr(z))


def _ramp(z: Floats) -> Floats:
    """Mean of ``max(0, z + normal)``."""
    density = np.exp(-0.5 * z * z) / math.sqrt(2.0 * math.pi)
    return np.asarray(z * _normal(z) + density)


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
        return self.readout.rate(self.receive(scene, pattern), pattern["gain"])

    def variance(self, expected: Floats) -> Floats:
        """Squared hertz: of whole counts (`counts_variance`)."""
        gate = self.readout.gate_s
        counts = expected * gate
        return counts_variance(counts, self.readout.spread_counts(counts)) / gate**2

    def gain_slopes(self, expected: Floats, scene: Scene) -> Floats:  # noqa: ARG002 - the protocol's
        """(N, K, 1) hertz by one standard deviation of the converters' gains."""
        light = expected - self.readout.dark.level()
        return self.readout.gain_mismatch * light[..., None]

    def gain_information(self, references: References) -> Floats:
        """(1, 1) of the spread and the flats."""
        # a count of a flat varies by 1/6 on average: where the gate opens, and what it leaves over
        single = self.readout.spread_counts(np.ones(1))[0] ** 2 + 1.0 / 6.0
        counts = references.level * self.readout.sunlit_hz * self.readout.gate_s
        flats = references.flats * counts**2 / float(single)
        return gain_information([self.readout.gain_mismatch], flats)

    def reference_readings(
        self, pattern: FixedPattern, references: References, streams: NoiseStreams
    ) -> dict[str, Floats]:
        """``dark_hz`` and ``flat_hz`` (K,): mean readings of the converters.

        Flats are a share of sunlight, not of full scale, at which proportion is lost.
        """
        gain = pattern["gain"]
        lit = {
            "dark_hz": (references.darks, np.zeros(len(gain))),
            "flat_hz": (references.flats, np.full(len(gain), references.level)),
        }
        return {
            name: np.mean(
                self._read(np.tile(self.readout.rate(light, gain), (count, 1)), streams), axis=0
            )
            for name, (count, light) in lit.items()
            if count
        }

    def observe(self, scene: Scene, pattern: FixedPattern, streams: NoiseStreams) -> Floats:
        """(N, K) hertz: whole counts over the gate time."""
        return self._read(self.expected(scene, pattern), streams)

    def _read(self, mean_hz: Floats, streams: NoiseStreams) -> Floats:
        gate = self.readout.gate_s
        mean = mean_hz * gate
        counts = mean + self.readout.spread_counts(mean) * streams.gaussian.standard_normal(
            mean.shape
        )
        # the second stream tells where between two pulses the gate opens
        counts = np.floor(np.maximum(counts, 0.0) + streams.poisson.random(mean.shape))
        most = np.floor(self.readout.full_scale_hz * gate)
        return np.asarray(np.minimum(counts, most) / gate)
