"""Errors of pixels: charge is moved and not lost, hot pixels stay hot, what is read inverts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import ndimage, stats

from benchmark.simulator.readout.pixel_errors import PixelErrors

FULL_E = 30_000.0


def frames(seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).uniform(0.0, 1.0, (3, 7, 9))


def test_a_pixel_gives_a_quarter_of_its_share_to_each_neighbour() -> None:
    light = np.zeros((1, 5, 5))
    light[0, 2, 2] = 1.0
    seen = PixelErrors(crosstalk=0.08).gather(light)[0]
    kernel = np.array([[0, 0.02, 0], [0.02, 0.92, 0.02], [0, 0.02, 0]])
    assert seen[1:4, 1:4] == pytest.approx(kernel)
    assert seen.sum() == pytest.approx(1.0)
    whole = frames()
    spilled = PixelErrors(crosstalk=0.08).gather(whole)
    assert spilled == pytest.approx(
        np.stack([ndimage.convolve(one, kernel, mode="nearest") for one in whole])
    )


def test_crosstalk_leaves_the_centroid_and_widens_the_spot_by_its_variance() -> None:
    """A step of one pixel with the chance c / 2 an axis: a variance of c / 2 px^2 more."""
    y, x = np.mgrid[:41, :41]
    spot = np.exp(-((x - 20.3) ** 2 + (y - 19.8) ** 2) / 18.0)[None]
    seen = PixelErrors(crosstalk=0.12).gather(spot)

    def moments(image: np.ndarray) -> tuple[float, float]:
        mean = (image * x).sum() / image.sum()
        return mean, (image * (x - mean) ** 2).sum() / image.sum()

    before, after = moments(spot[0]), moments(seen[0])
    assert after[0] == pytest.approx(before[0], abs=1e-6)
    assert after[1] - before[1] == pytest.approx(0.06, abs=1e-4)


def test_smear_adds_the_column_s_light_to_every_pixel_of_it() -> None:
    light = frames()
    seen = PixelErrors(smear=1e-3).gather(light)
    assert seen - light == pytest.approx(
        np.broadcast_to(1e-3 * light.sum(axis=1, keepdims=True), light.shape)
    )
    line = light[:, 0]
    assert PixelErrors(smear=1e-3).gather(line) is line


def test_hot_pixels_are_as_many_as_said_and_stay_hot_under_a_larger_dose() -> None:
    shape = (400, 500)
    little = PixelErrors(hot=0.01).dark_factor(shape, "unit")
    much = PixelErrors(hot=0.05).dark_factor(shape, "unit")
    for found, share in ((little, 0.01), (much, 0.05)):
        count = np.count_nonzero(found > 1.0)
        assert count == pytest.approx(share * found.size, abs=4 * math.sqrt(share * found.size))
    hot = little > 1.0
    assert np.array_equal(much[hot], little[hot])
    excess = (much[much > 1.0] - 1.0) / 50.0
    assert stats.kstest(excess, "expon").pvalue > 1e-3


@given(st.floats(0.0, 0.49), st.floats(0.0, 1.0))
def test_what_is_read_inverts_and_rises(nonlinearity: float, share: float) -> None:
    errors = PixelErrors(nonlinearity=nonlinearity)
    held = np.array([share * FULL_E])
    read = errors.read(held, FULL_E)
    assert errors.held(read, FULL_E) == pytest.approx(held, rel=1e-6, abs=1e-9)
    assert errors.slope(held, FULL_E)[0] > 0
    step = 1e-3
    rise = (errors.read(held + step, FULL_E) - errors.read(held - step, FULL_E)) / (2 * step)
    assert errors.slope(held, FULL_E) == pytest.approx(rise, abs=1e-6)
    assert errors.read(np.array([FULL_E]), FULL_E)[0] == pytest.approx(FULL_E * (1 - nonlinearity))
