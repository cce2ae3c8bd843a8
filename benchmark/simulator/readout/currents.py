"""Currents of a few photodiodes: gains, noise, conversion and what references tell of them."""

from __future__ import annotations

import math
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


def element_gains(readout: CurrentReadout, count: int, *names: str | int) -> Floats:
    """(K,) relative gains of one unit's elements."""
    return 1.0 + readout.gain_mismatch * generator(*names, "gain").standard_normal(count)


def currents(readout: CurrentReadout, response: Floats, pattern: Mapping[str, Floats]) -> Floats:
    """(N, K) mean microamperes for `response` in units of mean sunlight at normal incidence."""
    return np.asarray(readout.sunlit_ua * response * pattern["gain"] + readout.dark.level())


def variance(readout: CurrentReadout, expected: Floats) -> Floats:
    """Squared microamperes: shot noise of the current, amplifier noise, rounding and clipping."""
    shot = readout.electron_ua * np.maximum(expected, 0.0)
    deviation = np.sqrt(shot + readout.noise_ua**2) / readout.step_ua
    top = 2.0 ** (readout.bits - 1)
    codes = reading_variance(expected / readout.step_ua, deviation, -top, top - 1.0)
    return np.asarray(codes * readout.step_ua**2)


def convert(readout: CurrentReadout, expected: Floats, streams: NoiseStreams) -> Floats:
    """(N, K) microamperes read out: whole codes within the converter's range."""
    shot = readout.electron_ua * np.maximum(expected, 0.0)
    noise = np.sqrt(shot + readout.noise_ua**2) * streams.gaussian.standard_normal(expected.shape)
    top = 2.0 ** (readout.bits - 1)
    codes = np.clip(np.rint((expected + noise) / readout.step_ua), -top, top - 1.0)
    return np.asarray(codes * readout.step_ua + 0.0)  # + 0.0: no negative zero in the data


def spread(readout: CurrentReadout, gain_spread: float, references: References) -> ElementSpread:
    """Return what is unknown of a channel, in microamperes; dark currents are the design's."""
    dark = readout.dark.level()
    light = references.level * (readout.full_scale_ua - dark)
    noise = math.sqrt(readout.electron_ua * (light + dark) + readout.noise_ua**2)
    codes = readings_information(noise / readout.step_ua, references.flats)
    return posterior((gain_spread, 0.0), light, (codes / readout.step_ua**2, 0.0))


def unit_variance(readout: CurrentReadout, expected: Floats, references: References) -> Floats:
    """Squared microamperes that gains drawn with `gain_mismatch` add to those of `expected`."""
    light = expected - readout.dark.level()
    return spread(readout, readout.gain_mismatch, references).variance(light)


def mean_readings(
    readout: CurrentReadout, gains: Floats, references: References, streams: NoiseStreams
) -> dict[str, Floats]:
    """Mean of a unit's dark and flat readings (K,), ``dark_ua`` and ``flat_ua``.

    Every element gets the light that gives one of gain 1 a current of `References.level` of full
    scale. What there are no readings of is left out.
    """
    dark = readout.dark.level()
    light = references.level * (readout.full_scale_ua - dark)
    means = {
        "dark_ua": (references.darks, np.full(len(gains), dark)),
        "flat_ua": (references.flats, dark + light * gains),
    }
    return {
        name: np.mean(convert(readout, np.tile(mean, (count, 1)), streams), axis=0)
        for name, (count, mean) in means.items()
        if count
    }
