"""Light-to-frequency converters: whole pulses, what they tell, and their data sheet's errors."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scenes import lit_by
from scipy.stats import norm

from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.sensors.light_to_frequency import (
    FrequencyCounter,
    FrequencySensor,
    counts_variance,
)

POINT = SolarDisc(diameter_deg=0.0)


def counter(rate: float, gate_s: float = 1.0, full_scale: float = 1e9) -> FrequencySensor:
    """A single face whose rate in the Sun is `rate`."""
    readout = FrequencyCounter(rate, gate_s, 0.0, full_scale)
    return FrequencySensor(((0.0, 0.0, 1.0),), readout, sun=POINT)


@pytest.mark.parametrize("mean", [0.3, 3.2, 12.5, 400.25, 50_000.9])
def test_counts_are_the_whole_pulses_and_sometimes_one_more(mean: float) -> None:
    sensor = counter(mean)
    up = np.tile([0.0, 0.0, 1.0], (100_000, 1))
    pattern = sensor.fixed_pattern("test")
    counts = sensor.observe(lit_by(up), pattern, NoiseStreams.named("test", "counts"))
    assert set(np.unique(counts)) <= {math.floor(mean) + step for step in (-1, 0, 1, 2)}
    part = mean - math.floor(mean)
    spread = math.sqrt(part * (1 - part) + 0.01**2 + mean / 3e7)
    assert counts.mean() == pytest.approx(mean, abs=4 * spread / math.sqrt(1e5))
    assert counts.var() == pytest.approx(spread**2, rel=0.03)


@pytest.mark.parametrize(("part", "deviation"), [(0.5, 0.01), (0.2, 0.02), (0.0, 0.3), (0.3, 2.0)])
def test_whole_counts_tell_what_their_chances_do(part: float, deviation: float) -> None:
    """Chances by quadrature over the gate's opening, the information by their differences."""
    opening = (np.arange(200_000) + 0.5) / 200_000

    def chances(mean: float) -> np.ndarray:
        edges = np.arange(-20, 22)[:, None] - opening[None, ::100] - mean
        return np.diff(norm.cdf(edges / deviation).mean(axis=1))

    step = 1e-3 * deviation
    here = chances(7.0 + part)
    slope = (chances(7.0 + part + step) - chances(7.0 + part - step)) / (2.0 * step)
    seen = here > 1e-9
    information = np.sum(slope[seen] ** 2 / here[seen])
    found = counts_variance(np.array([7.0 + part]), np.array([deviation]))
    assert found == pytest.approx([1.0 / information], rel=5e-3)


def test_without_other_noise_a_count_is_a_coin_and_with_much_a_measurement() -> None:
    part = np.array([0.1, 0.5, 0.8])
    assert counts_variance(4.0 + part, np.full(3, 1e-4)) == pytest.approx(part * (1 - part))
    # rounding adds 1/12 for the step and 1/12 for the gate's opening
    assert counts_variance(4.0 + part, np.full(3, 3.0)) == pytest.approx(9.0 + 1 / 6, rel=1e-3)


def test_frequencies_are_whole_counts_and_stop_at_full_scale() -> None:
    up = np.tile([0.0, 0.0, 1.0], (50, 1))
    sensor = counter(rate=1000.0, gate_s=0.02)
    seen = sensor.observe(lit_by(up), sensor.fixed_pattern("t"), NoiseStreams.named("test", "hz"))
    assert seen * 0.02 == pytest.approx(np.rint(seen * 0.02))
    assert len(np.unique(seen)) <= 2
    full = counter(rate=2e6, gate_s=0.02, full_scale=1e6)
    seen = full.observe(lit_by(up), full.fixed_pattern("t"), NoiseStreams.named("test", "hz"))
    assert (seen <= 1e6).all()
    assert full.expected(lit_by(up[:1]), full.fixed_pattern("t"))[0, 0] == 1e6
    with pytest.raises(ValueError, match="gate_s and full_scale_hz must be positive"):
        FrequencyCounter(1.0, 0.0, 0.0, 1.0)
