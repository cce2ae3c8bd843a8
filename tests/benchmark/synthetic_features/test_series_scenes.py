"""Scenes of the reference series: glints, gaps, phases and gradients are where they are said."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from benchmark.sweeps.plan import SERIES
from benchmark.synthetic_features.frame_sets import FRAME_SETS
from benchmark.synthetic_features.light import BACKGROUND_E, bars, gain_e_per_dn, peak_e
from benchmark.synthetic_features.series import GLINT, Sample, SeriesPoint


def setting_of(series: str, sweep: str, point: str, frames: int = 6) -> SeriesPoint:
    (found,) = [
        one for one in SERIES[series].settings() if (one.sweep, one.point) == (sweep, point)
    ]
    return replace(found, frames=frames)


def drawn(series: str, sweep: str, point: str, frames: int = 6) -> tuple[Sample, np.ndarray]:
    """A sample of a series, and its readings as shares of the feature's height."""
    setting = setting_of(series, sweep, point, frames)
    sample, peak = SERIES[series].draw(setting), peak_e(setting.snr)
    electrons = sample.observations * gain_e_per_dn(peak)
    return sample, (electrons - BACKGROUND_E) / peak


@pytest.mark.parametrize(("series", "at"), [("slit", 112), ("slits", 99)])
def test_lines_have_a_brighter_glint_from_the_second_profile_on(series: str, at: int) -> None:
    sample, light = drawn(series, "tracking", "glint")
    both = light.reshape(6, 2, 128)
    assert both[1:, :, at] == pytest.approx(GLINT, abs=0.3)
    assert both[0, :, at] == pytest.approx(0.0, abs=0.1)
    # the feature itself is where the truth says
    near = np.rint(sample.truth).astype(int)
    own = both[np.arange(6)[:, None], np.arange(2), near]
    assert own == pytest.approx(1.0, abs=0.15)
    assert np.abs(sample.truth - at).min() > 15.0


@pytest.mark.parametrize(("point", "share"), [("0.2", 0.2), ("0", 0.0)])
def test_a_share_of_a_single_bars_pixels_reads_nothing(point: str, share: float) -> None:
    sample, _ = drawn("slit", "missing", point, frames=60)
    away = np.arange(128) - sample.truth[:, :, None]
    lit = sample.observations.reshape(60, 2, 128)[np.abs(away) < 6.0]
    assert (lit == 0).mean() == pytest.approx(share, abs=0.04)


@pytest.mark.parametrize("sigma", [1.0, 4.0])
def test_a_gaussian_bar_holds_the_light_of_its_closed_form(sigma: float) -> None:
    light = bars(128, np.array([[63.2, 20.9], [60.0, 90.0]]), sigma, "gaussian")
    assert light.sum(axis=1) == pytest.approx(2.0 * math.sqrt(2.0 * math.pi) * sigma)
    x = np.arange(128)
    assert (light[1, :75] * x[:75]).sum() / light[1, :75].sum() == pytest.approx(60.0, abs=0.01)


def test_a_disc_is_tracked_beside_a_brighter_one() -> None:
    sample, light = drawn("disc", "tracking", "glint")
    assert light.shape == (6, 128, 128)
    assert light[1:, 90, 92] == pytest.approx(GLINT, abs=0.2)
    assert light[0, 90, 92] == pytest.approx(0.0, abs=0.1)
    for frame, (x, y) in zip(light, np.rint(sample.truth).astype(int), strict=True):
        assert frame[y, x] == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize(("series", "phase"), [("blooming", 0.5), ("black-sun", 0.25)])
def test_suns_of_a_phase_fall_on_it_and_pictures_show_them_there(series: str, phase: float) -> None:
    sample = SERIES[series].draw(setting_of(series, "phase", f"{phase:g}", 1))
    np.testing.assert_allclose(sample.truth % 1.0, phase, atol=1e-9)
    (x, y), (frame,) = np.rint(sample.truth[0]).astype(int), sample.observations
    near = frame[y - 4 : y + 5, x - 4 : x + 5]
    assert near.max() > 0.9 * frame.max()
    assert near.max() > 3.0 * np.median(frame)
    assert 1e-3 < sample.bound < 0.1


def test_a_gradient_rises_by_a_tenth_of_the_peak_across_the_frame() -> None:
    (chosen,) = [one for one in FRAME_SETS if one.name == "limb, gradient"]
    seen = chosen.draw("test", 8)
    y, x = np.indices((64, 64))
    slopes = []
    for frame, (at_x, at_y) in zip(seen.frames, seen.centres, strict=True):
        away = np.hypot(x - at_x, y - at_y) > 14.0
        design = np.column_stack([np.ones(away.sum()), x[away], y[away]])
        (_, *slope), *_ = np.linalg.lstsq(design, frame[away].astype(float))
        slopes.append(63.0 * np.array(slope))
    assert np.linalg.norm(slopes, axis=1) == pytest.approx(0.1 * 2000.0, rel=0.05)
    assert np.ptp(np.arctan2(*np.array(slopes).T)) > 1.0, "in any direction"


@pytest.mark.parametrize(("series", "point"), [("disc", "4"), ("grid", "3")])
def test_light_is_around_its_truth_and_that_within_the_range_of_the_middle(
    series: str, point: str
) -> None:
    setting = setting_of(series, "size", point)
    sample, light = drawn(series, "size", point)
    middle = (light.shape[1] - 1) / 2.0
    assert np.abs(sample.truth - middle).max() <= setting.range_px
    grid = np.stack(np.meshgrid(*(np.arange(light.shape[1]),) * 2))  # x, y
    bright = np.where(light > 0.1, light, 0.0)
    found = np.einsum("nyx,cyx->nc", bright, grid) / bright.sum(axis=(1, 2))[:, None]
    assert found == pytest.approx(sample.truth, abs=0.2)
