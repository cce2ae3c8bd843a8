"""Reference series: their light, noise and bounds against closed forms and brute force."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from benchmark.sweeps.plan import SERIES
from benchmark.synthetic_features import light as reference_light
from benchmark.synthetic_features.events import EVENTS
from benchmark.synthetic_features.frames import REFERENCE_SETS
from benchmark.synthetic_features.lines import SLIT, SLITS
from benchmark.synthetic_features.series import SWEEPS
from benchmark.synthetic_features.spots import DiscSeries, GridSeries

DISC, GRID = DiscSeries(), GridSeries()


def setting(series, sweep, point=None):
    return next(
        s for s in series.settings() if s.sweep == sweep and (point is None or s.point == point)
    )


def test_spots_are_those_of_the_reference_sets_and_add_up():
    centres = np.array([[30.3, 31.8], [20.1, 40.7]])
    for name, radius, profile in (("disc", 8.0, "flat"), ("gaussian", 3.0, "gaussian")):
        chosen = REFERENCE_SETS[name]
        expected = (chosen.expected(centres) - chosen.background_e) / chosen.peak_e
        single = reference_light.spots(64, centres[:, None], radius, profile)
        np.testing.assert_allclose(single, expected, atol=1e-12)
    both = reference_light.spots(64, centres[None], 3.0, "gaussian", np.array([[1.0, 0.5]]))
    np.testing.assert_allclose(both[0], single[0] + 0.5 * single[1], atol=1e-12)


def test_a_spot_beyond_the_frame_gives_no_light_and_one_at_the_rim_is_cut():
    beyond, rim = np.array([[[-4.0, 10.0]]]), np.array([[[0.0, 10.0]]])
    assert reference_light.spots(32, beyond, 3.0, "flat").max() == 0.0
    inside = reference_light.spots(32, np.array([[[16.0, 10.0]]]), 3.0, "flat")
    np.testing.assert_allclose(
        reference_light.spots(32, rim, 3.0, "flat")[0, :, 0], inside[0, :, 16], atol=1e-12
    )


def test_a_bar_is_a_box_blurred_and_integrated_over_pixels():
    fine, width = 400, 40
    x = (np.arange(width * fine) + 0.5) / fine - 0.5
    box = (np.abs(x - 18.37) < 5.0).astype(float)
    blurred = gaussian_filter1d(box, reference_light.EDGE_PX * fine, truncate=8)
    expected = blurred.reshape(width, fine).mean(axis=1)
    found = reference_light.bars(width, np.array([[18.37]]), 5.0, "flat")[0]
    np.testing.assert_allclose(found, expected, atol=2e-4)
    assert found.sum() == pytest.approx(10.0, rel=1e-12)


def test_the_bound_of_a_line_through_known_derivatives_is_least_squares():
    """A straight line's offset and slope in white noise: the textbook covariance."""
    t = np.linspace(-1.0, 2.0, 50)
    bound = reference_light.position_bound(
        lambda at: at[:, :1] * np.ones_like(t),
        np.array([[0.3]]),
        lambda here: [t[None] * np.ones_like(here)],
        lambda here: np.full_like(here, 0.25),
    )
    design = np.column_stack([np.ones_like(t), t])
    assert bound == pytest.approx(math.sqrt(0.25 * np.linalg.inv(design.T @ design)[0, 0]))


@pytest.mark.slow
@pytest.mark.parametrize("series", SERIES.values(), ids=SERIES)
def test_drawing_is_repeatable_and_shapes_agree(series):
    first = series.settings()[0]
    one, again = series.draw(first), series.draw(first)
    np.testing.assert_array_equal(one.observations, again.observations)
    np.testing.assert_array_equal(one.truth, again.truth)
    assert len(one.observations) == len(one.truth) == first.frames
    assert one.bound > 0
    points = [(s.sweep, s.point) for s in series.settings()]
    assert len(points) == len(set(points))
    assert {sweep for sweep, _ in points} <= set(SWEEPS)


@pytest.mark.slow
def test_independent_spots_and_slits_divide_the_bound_by_the_root_of_their_number():
    for series, many in ((GRID, "25"), (SLITS, "5")):
        one = series.draw(setting(series, "features", "1")).bound
        most = series.draw(setting(series, "features", many)).bound
        assert one / most == pytest.approx(math.sqrt(float(many)), rel=0.01)


def test_the_reference_disc_is_the_reference_set_itself():
    drawn = DISC.draw(setting(DISC, "reference", "disc"))
    frames, centres = REFERENCE_SETS["disc"].frames(300)
    np.testing.assert_array_equal(drawn.observations, frames)
    np.testing.assert_array_equal(drawn.truth, centres)


@pytest.mark.slow
def test_a_missing_fifth_is_a_fifth_and_a_glint_stands_where_the_feature_never_is():
    whole, less = (GRID.draw(setting(GRID, "missing", p)) for p in ("0", "0.2"))
    lit = [
        (drawn.observations.astype(float) - reference_light.BACKGROUND_E).sum()
        for drawn in (whole, less)
    ]
    assert lit[1] / lit[0] == pytest.approx(0.8, abs=0.01)
    tracking = DISC.draw(setting(DISC, "tracking"))
    assert np.linalg.norm(np.diff(tracking.truth, axis=0), axis=1).max() < 1.51
    # the brightest pixel is the feature's in the first frame, the glint's in all others
    for n, frame in enumerate(tracking.observations[:5]):
        y, x = np.unravel_index(frame.argmax(), frame.shape)
        assert (math.hypot(*(np.array([x, y]) - tracking.truth[n])) < 10) == (n == 0)


def test_events_are_ordered_and_end_at_the_reset():
    drawn = EVENTS.draw(setting(EVENTS, "reference"))
    times = drawn.observations[:, :, 2]
    seen = np.isfinite(times)
    assert (np.diff(np.where(seen, times, 400.0), axis=1) >= 0).all()
    assert times[seen].max() <= 400.0
    # fully lit pixels (100 us) lie on the two lines that cross at the truth
    lit = np.abs(times - 100.0) < 5.0
    x, y = drawn.observations[:, :, 0], drawn.observations[:, :, 1]
    off = np.minimum(np.abs(x - drawn.truth[:, :1]), np.abs(y - drawn.truth[:, 1:]))
    assert off[lit].max() < 1.5


def test_a_least_squares_fit_of_the_slit_reaches_its_bound():
    """The bound is one: an efficient estimator of the stated model gets there."""
    base = setting(SLIT, "noise", "100")
    drawn = SLIT.draw(base)
    peak = reference_light.peak_e(100.0)
    at = drawn.truth[:, :1].copy()
    light = drawn.observations[:, :128].astype(float)
    for _ in range(3):

        def mean(places):
            return 20.0 + peak * reference_light.bars(128, places, base.size_px, "flat")

        slope = (mean(at + 1e-3) - mean(at - 1e-3)) / 2e-3
        weight = 1.0 / (mean(at) + 100.0)
        at += ((light - mean(at)) * slope * weight).sum(axis=1, keepdims=True) / (
            slope**2 * weight
        ).sum(axis=1, keepdims=True)
    rms = float(np.sqrt(np.mean((at - drawn.truth[:, :1]) ** 2)))
    assert rms == pytest.approx(drawn.bound, rel=0.12)
