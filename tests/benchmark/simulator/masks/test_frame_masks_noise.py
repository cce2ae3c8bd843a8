"""Noise of full frames: the normal distribution it is drawn from, and what it adds up to."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats
from scipy.special import ndtr

from benchmark.simulator.kernels.digitising import normals, quantiles
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.masks.apertures import Aperture
from benchmark.simulator.masks.layouts import grid
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import DarkCurrent, PixelArray
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor

SENSOR = MultiSpotSensor(
    Camera(1.0, grid(2, 2, 0.3, Aperture("round", 0.15, 0.15))),
    PixelArray(
        columns=65,
        rows=63,
        pitch_mm=0.01,
        sunlit_e=20_000.0,
        full_well_e=30_000.0,
        prnu=0.01,
        dsnu=0.1,
        dark=DarkCurrent(2_000.0),
        exposure_s=0.01,
        read_noise_e=30.0,
        gain_e_per_dn=10.0,
        offset_dn=30.0,
        bits=12,
    ),
    spectrum=None,
)


def still(count: int) -> Scene:
    sun = np.repeat(from_angles(np.array([2.0]), np.array([-1.0])), count, axis=0)
    return Scene(sun, np.ones(count), np.full(count, 0.002), np.zeros((count, 2), dtype=np.int64))


def drawn(words: np.ndarray) -> np.ndarray:
    """Normal values of 32-bit words."""
    pairs = words.astype(np.uint64).reshape(-1, 2)
    out = np.empty(len(words))
    normals(out, (pairs[:, 0] | pairs[:, 1] << np.uint64(32)).view(np.uint32), quantiles())
    return out


@pytest.mark.slow
def test_every_word_is_the_quantile_of_its_probability() -> None:
    ends = np.arange(0, 1 << 23, 257)
    words = np.concatenate([ends, np.arange(0, 1 << 32, 65_521), (1 << 32) - 1 - ends])
    words = words[: len(words) // 2 * 2]
    values = drawn(words)
    probability = (words + 0.5) / 2**32
    assert np.abs(ndtr(values) - probability).max() < 1e-6
    order = np.argsort(words, kind="stable")
    assert (np.diff(values[order]) >= 0).all()
    assert values.min() < -6
    assert values.max() > 6
    mirrored = drawn((1 << 32) - 1 - words)
    assert mirrored == pytest.approx(-values, abs=1e-12)


@pytest.mark.slow
def test_values_are_normal_as_a_test_of_four_million_shows() -> None:
    raw = np.random.default_rng(5).bit_generator.random_raw(1 << 21)
    values = np.empty(1 << 22)
    normals(values, raw.view(np.uint32), quantiles())
    assert stats.kstest(values, "norm").pvalue > 1e-3
    assert values.mean() == pytest.approx(0, abs=4 / 2**11)
    assert values.var() == pytest.approx(1, abs=4 * np.sqrt(2) / 2**11)
    assert stats.kurtosis(values) == pytest.approx(0, abs=4 * np.sqrt(24) / 2**11)
    for limit in (3.0, 4.0):  # tails hold what they must
        expected = len(values) * 2 * stats.norm.sf(limit)
        assert (np.abs(values) > limit).sum() == pytest.approx(expected, abs=4 * expected**0.5)
    # neighbours share a word, but nothing else
    assert abs(np.corrcoef(values[::2], values[1::2])[0, 1]) < 4 / 2**10.5


@pytest.mark.slow
def test_frames_have_the_mean_and_variance_they_promise() -> None:
    count = 1000
    pattern = SENSOR.fixed_pattern("unit")
    scene = still(count)
    seen = SENSOR.observe(scene, pattern, NoiseStreams.named("test")).astype(float)
    expected = SENSOR.expected(scene.part(0, 1), pattern)[0]
    variance = SENSOR.variance(expected)
    off = (seen.mean(axis=0) - expected) / np.sqrt(variance / count)
    assert off.std() == pytest.approx(1, abs=0.05)
    assert abs(off.mean()) < 0.1
    ratio = seen.var(axis=0, ddof=1) / variance
    assert ratio.mean() == pytest.approx(1, abs=5 * np.sqrt(2 / count / ratio.size))
    assert ratio.std() == pytest.approx(np.sqrt(2 / (count - 1)), rel=0.1)
    # lit and dark pixels alike
    lit = SENSOR.lit(scene.part(0, 1), pattern)[0] > 0.5
    assert ratio[lit].mean() == pytest.approx(1, abs=0.01)
    assert ratio[~lit].mean() == pytest.approx(1, abs=0.01)


def test_gaussian_shot_noise_is_nowhere_farther_from_poisson_than_stated() -> None:
    """Skewness of Poisson plus Gaussian, m / (m + r^2)^(3/2), is at most 0.385 / r."""
    mean = np.geomspace(1e-3, 1e6, 500)
    for read in (10.0, 30.0, 150.0):
        assert (mean / (mean + read**2) ** 1.5).max() <= 0.3850 / read
    with pytest.raises(ValueError, match=r"read.*10.0.*5.0"):
        replace(SENSOR, detector=replace(SENSOR.detector, read_noise_e=5.0))


def test_noise_depends_on_neither_batch_nor_what_is_seen() -> None:
    pattern = SENSOR.fixed_pattern("unit")
    scene = still(5)
    whole = SENSOR.observe(scene, pattern, NoiseStreams.named("a"))
    streams = NoiseStreams.named("a")
    parts = [SENSOR.observe(scene.part(n, n + 1), pattern, streams) for n in range(5)]
    assert np.array_equal(whole, np.concatenate(parts))
    assert not np.array_equal(whole[0], whole[1])
    dark = replace(scene, irradiance=np.zeros(5))
    unlit = SENSOR.observe(dark, pattern, NoiseStreams.named("a"))
    shade = SENSOR.lit(scene, pattern) == 0
    assert np.array_equal(whole[shade], unlit[shade])


def test_pixels_stop_at_the_full_well_and_at_the_converter() -> None:
    pattern = SENSOR.fixed_pattern("unit")
    well = replace(SENSOR, detector=replace(SENSOR.detector, full_well_e=9_000.0))
    top = well.observe(still(1), pattern, NoiseStreams.named("a")).max()
    assert top == 9_000 / 10 + 30
    coarse = replace(SENSOR, detector=replace(SENSOR.detector, bits=8))
    assert coarse.observe(still(1), pattern, NoiseStreams.named("a")).max() == 255
