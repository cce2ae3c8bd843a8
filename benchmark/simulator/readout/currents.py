"""Currents of a few photodiodes: gains, noise and conversion shared by all such sensors."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from algorithms.contract import Floats
from benchmark.seeds import generator
from benchmark.simulator.readout.detectors import CurrentReadout
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.readout.quantisation import reading_variance


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


def converted(readout: CurrentReadout, expected: Floats, streams: NoiseStreams) -> Floats:
    """(N, K) microamperes read out: whole codes within the converter's range."""
    shot = readout.electron_ua * np.maximum(expected, 0.0)
    noise = np.sqrt(shot + readout.noise_ua**2) * streams.gaussian.standard_normal(expected.shape)
    top = 2.0 ** (readout.bits - 1)
    codes = np.clip(np.rint((expected + noise) / readout.step_ua), -top, top - 1.0)
    return np.asarray(codes * readout.step_ua + 0.0)  # + 0.0: no negative zero in the data
