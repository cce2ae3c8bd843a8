"""Adaptive energy filtering: averages while the Sun stays, follows it, and ends in eclipse."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ndtr

from algorithms.contract import SensorGeometry
from algorithms.extractors.frames.energy_filtering import AdaptiveEnergyFilter

FILTER = AdaptiveEnergyFilter()


def frames_of(centres, seed, peak=600.0, size=40):
    y, x = np.mgrid[:size, :size]
    light = np.stack(
        [30 + peak * ndtr((5.0 - np.hypot(x - a, y - b)) / 0.7) for a, b in np.atleast_2d(centres)]
    )
    rng = np.random.default_rng(seed)
    return np.rint(rng.poisson(light) + rng.normal(0, 10, light.shape)).clip(0).astype(np.uint16)


def rms(found, centres):
    return float(np.sqrt(np.mean((found - centres) ** 2)))


def test_a_single_frame_is_the_centroid_of_its_significant_pixels():
    frame = frames_of([[19.3, 20.6]], 1)[0].astype(float)
    border = np.concatenate([frame[0], frame[-1], frame[1:-1, 0], frame[1:-1, -1]])
    base, sigma = border.mean(), border.std()
    cut = base + max(5 * sigma, 0.1 * (frame.max() - base))
    u = np.maximum(frame - cut, 0.0)
    y, x = np.indices(frame.shape)
    expected = (x * u).sum() / u.sum(), (y * u).sum() / u.sum()
    np.testing.assert_allclose(FILTER.extract(frame[None])[0], expected, rtol=0, atol=1e-10)


def test_a_sequence_of_a_still_sun_is_the_centroid_of_the_mean_frame():
    frames = frames_of(np.tile([19.3, 20.6], (20, 1)), 2)
    found, lengths = FILTER.extract_sequence(frames)
    assert lengths.tolist() == list(range(1, 21))
    mean = frames.mean(axis=0)
    border = np.array(
        [np.concatenate([f[0], f[-1], f[1:-1, 0], f[1:-1, -1]]) for f in frames.astype(float)]
    )
    base, sigma = border.mean(), np.sqrt(border.var(axis=1).mean() / 20)
    cut = base + max(5 * sigma, 0.1 * (mean.max() - base))
    u = np.maximum(mean - cut, 0.0)
    y, x = np.indices(mean.shape)
    expected = (x * u).sum() / u.sum(), (y * u).sum() / u.sum()
    np.testing.assert_allclose(found[-1], expected, rtol=0, atol=1e-9)


def test_a_mean_of_many_frames_is_far_finer_than_one_while_the_sun_stays():
    """A fifth were it for noise alone; what the pixels' grid adds does not average out."""
    rng = np.random.default_rng(3)
    alone, last = [], []
    for seed in range(40):
        centre = rng.uniform(18, 22, 2)
        frames = frames_of(np.tile(centre, (25, 1)), 100 + seed)
        found, lengths = FILTER.extract_sequence(frames)
        if lengths[-1] == 25:
            alone.append(FILTER.extract(frames[-1:])[0] - centre)
            last.append(found[-1] - centre)
    assert len(last) > 20
    assert np.std(last) < 0.45 * np.std(alone)


def test_a_sun_that_jumps_or_drifts_is_followed():
    jump = np.repeat([[18.0, 20.0], [19.0, 20.5]], 15, axis=0)
    found, lengths = FILTER.extract_sequence(frames_of(jump, 4))
    assert lengths[15] == 1
    assert np.abs(found[15:] - jump[15:]).max() < 0.15
    for speed in (0.002, 0.01, 0.05, 0.2):
        track = np.array([16.0, 20.0]) + np.outer(np.arange(40), [speed, 0.0])
        frames = frames_of(track, 5)
        together, _ = FILTER.extract_sequence(frames)
        assert rms(together, track) < 1.8 * rms(FILTER.extract(frames), track)


def test_a_drift_hidden_in_the_noise_lags_by_about_a_frames_own_error():
    """Some ten late frames count, so the mean shift shows at a third of what one must show.

    One frame's would be seen at sqrt(2 ln 100) = 3.03 of its own error. The noise is a
    chequerboard that changes sign: it has that variance, and no part along the slopes.
    """
    y, x = np.mgrid[:40, :40]
    slope = 1000 * np.exp(-((x - 19.3) ** 2 + (y - 20.2) ** 2) / 18) * (x - 19.3) / 9
    own_error = 20.0 / np.sqrt((slope**2).sum())
    speed = own_error / 20
    track = 19.3 + speed * np.arange(100)
    light = [1000 * np.exp(-((x - at) ** 2 + (y - 20.2) ** 2) / 18) for at in track]
    noise = [20.0 * (-1.0) ** (x + y + k) for k in range(100)]
    averaged = FILTER.extract_sequence(np.add(light, noise))[1].max()
    lag = speed * (averaged + 1) / 2  # of their mean against the frame that ended it
    assert 1.0 < lag / own_error < 1.2


def test_a_row_depends_on_no_frame_after_it():
    track = np.array([18.0, 20.0]) + np.cumsum(
        np.random.default_rng(6).normal(0, 0.05, (30, 2)), axis=0
    )
    frames = frames_of(track, 6)
    whole, lengths = FILTER.extract_sequence(frames)
    for stop in (1, 7, 18):
        part, part_lengths = FILTER.extract_sequence(frames[:stop])
        np.testing.assert_array_equal(part, whole[:stop])
        np.testing.assert_array_equal(part_lengths, lengths[:stop])


def test_broken_frames_are_passed_over_and_eclipse_ends_the_mean():
    frames = frames_of(np.tile([19.3, 20.6], (9, 1)), 7).astype(float)
    frames[3, 0, 0] = np.nan
    frames[6] = np.random.default_rng(8).normal(30, 10, frames[6].shape)
    found, lengths = FILTER.extract_sequence(frames)
    assert np.isnan(found[[3, 6]]).all()
    assert lengths.tolist() == [1, 2, 3, 0, 4, 5, 0, 1, 2]


@pytest.mark.parametrize("turn", [0.0, 0.6, 1.5])
def test_a_spot_drawn_out_to_a_line_is_found(turn):
    """As behind a slit, eight times longer than wide, which is no spot where none is known of."""
    y, x = np.mgrid[:64, :64]
    away = x - 31.3, y - 30.6
    along = away[0] * np.cos(turn) + away[1] * np.sin(turn)
    across = away[1] * np.cos(turn) - away[0] * np.sin(turn)
    light = 30 + 600 * ndtr((20 - abs(along)) / 0.7) * ndtr((2.5 - abs(across)) / 0.7)
    frame = np.random.default_rng(5).normal(light, 8.0)
    slit = AdaptiveEnergyFilter.for_sensor(SensorGeometry())
    np.testing.assert_allclose(slit.extract(frame[None]), [[31.3, 30.6]], atol=0.15)
    assert np.isnan(FILTER.extract(frame[None])).all()


def test_noise_two_spots_a_hot_pixel_and_a_cut_spot_are_not_found():
    rng = np.random.default_rng(9)
    noise = rng.normal(30, 10, (50, 40, 40))
    assert np.isnan(FILTER.extract(noise)).mean() > 0.98
    hot = noise[:1].copy()
    hot[0, 20, 20] = 4000
    two = frames_of([[9.0, 20.0]], 1) + frames_of([[31.0, 20.0]], 2)
    cut = frames_of([[0.0, 20.0]], 3)
    for frame in (hot, two, cut):
        assert np.isnan(FILTER.extract(frame)).all()


def test_many_spots_are_refused():
    with pytest.raises(ValueError, match="apertures"):
        AdaptiveEnergyFilter.for_sensor(
            SensorGeometry(apertures=((0.0, 0.0, 0.1), (1.0, 0.0, 0.1)))
        )
