"""Spots weighted and combined: as precise as their number says, however they fall on the pixels."""

import numpy as np
import pytest
from scipy.special import ndtr

from algorithms.contract import SensorGeometry
from algorithms.extractors.frames.multi_spot import spot_pixels_kernel
from algorithms.extractors.frames.multi_spot.combination_kernel import combine
from algorithms.extractors.frames.multi_spot.multiple_centroids import MultipleCentroids
from algorithms.extractors.frames.multi_spot.weighted_spots import WeightedSpots

WIDTH, PEAK, BACKGROUND, READ = 7.0, 2000.0, 20.0, 10.0
_INSIDE = (np.arange(5) + 0.5) / 5 - 0.5


def grid(side, pitch):
    steps = (np.arange(side) - (side - 1) / 2) * pitch
    return tuple((float(x), float(y), WIDTH) for y in steps for x in steps)


def spot(dx, dy, stretch=1.0):
    """A disc's or an oval's light in pixels at these distances from its middle: their mean."""
    u = dx[None, :, None, None] + _INSIDE
    v = (dy[:, None, None, None] + _INSIDE[:, None]) / stretch
    return ndtr((WIDTH / 2 - np.hypot(u, v)) / 0.7).mean(axis=(2, 3))


def light(apertures, place, shape, shares=None, stretch=1.0):
    """Electrons expected: background and spots, each with its share of the light."""
    frame = np.full(shape, BACKGROUND)
    shares = np.ones(len(apertures)) if shares is None else shares
    for (dx, dy, _), share in zip(apertures, shares, strict=True):
        x, y = place[0] + dx, place[1] + dy
        columns, rows = round(x) + np.arange(-7, 8), round(y) + np.arange(-7, 8)
        frame[np.ix_(rows, columns)] += PEAK * share * spot(columns - x, rows - y, stretch)
    return frame


def noisy(frames, rng):
    return np.clip(np.rint(rng.poisson(frames) + rng.normal(0, READ, frames.shape)), 0, 65535)


def draw(rng, side, pitch, count, **how):
    """Clean frames of a grid at places that differ by fractions of a pixel, and the places."""
    apertures = grid(side, pitch)
    size = round((side - 1) * pitch) + 26
    places = (size - 1) / 2 + rng.uniform(-0.5, 0.5, (count, 2))
    frames = [light(apertures, place, (size, size), **how) for place in places]
    return apertures, np.array(frames), places


def error(method, apertures, frames, places):
    found = method(apertures, blur_px=2.0).extract(frames.astype(np.uint16))
    answered = np.isfinite(found).all(axis=1)
    assert answered.mean() > 0.99, "a flag now and then; of one spot alone there are more"
    return float(np.sqrt(np.mean((found[answered] - places[answered]) ** 2)))


@pytest.mark.slow
@pytest.mark.parametrize("pitch", [16.0, 15.5, 16.37])
def test_precision_grows_with_the_root_of_the_number_wherever_spots_fall(pitch):
    """sigma_N sqrt(N) is within 15 % of one spot's for 4, 25 and 100, errors taken to the truth."""
    rng = np.random.default_rng([301, round(100 * pitch)])
    alone = []
    for side, count, draws in ((1, 200, 4), (2, 120, 4), (5, 40, 6), (10, 16, 12)):
        apertures, frames, places = draw(rng, side, pitch, count)
        many = noisy(np.repeat(frames, draws, axis=0), rng)
        alone.append(side * error(WeightedSpots, apertures, many, np.repeat(places, draws, axis=0)))
    assert np.abs(np.array(alone[1:]) / alone[0] - 1.0).max() < 0.15


def test_centroids_that_fall_alike_on_the_pixels_do_not_average():
    """What MCAM does as printed: at a whole-pixel pitch all errors are one."""
    rng = np.random.default_rng(302)
    apertures, frames, places = draw(rng, 5, 16.0, 40)
    frames = noisy(frames, rng)
    theirs, ours = (error(m, apertures, frames, places) for m in (MultipleCentroids, WeightedSpots))
    assert theirs > 4 * ours


def test_ovals_are_found_without_bias():
    rng = np.random.default_rng(303)
    apertures, frames, places = draw(rng, 3, 20.0, 30, stretch=1.6)
    assert error(WeightedSpots, apertures, frames, places) < 0.005


def test_dirty_spots_weigh_as_their_light_and_a_shaded_one_is_left_out():
    rng = np.random.default_rng(304)
    shares = np.ones(25)
    shares[[3, 8, 20]] = 0.5
    apertures, frames, places = draw(rng, 5, 16.37, 40, shares=shares)
    extractor = WeightedSpots(apertures, blur_px=2.0)
    whole = error(WeightedSpots, apertures, noisy(frames, rng), places)
    for frame, place in zip(frames, places, strict=True):  # dust on the right half of one spot
        x, y = place + np.array(apertures)[12, :2]
        inside = np.ix_(np.arange(round(y) - 5, round(y) + 6), np.arange(round(x), round(x) + 6))
        frame[inside] = BACKGROUND + 0.6 * (frame[inside] - BACKGROUND)
    shaded = noisy(frames, rng)
    assert error(WeightedSpots, apertures, shaded, places) < 1.2 * whole
    gone = np.isnan(extractor.spots(shaded)[:, :, 0])
    assert gone[:, 12].all()
    assert np.delete(gone, 12, axis=1).mean() < 0.02


def test_hot_and_dead_pixels_in_spots_are_left_out():
    rng = np.random.default_rng(305)
    apertures, frames, places = draw(rng, 5, 16.37, 40)
    frames = noisy(frames, rng)
    clean = error(WeightedSpots, apertures, frames, places)
    for frame in frames:
        for value in (0.0, 1500.0):
            rows, columns = rng.integers(1, frame.shape[0] - 1, (2, 8))
            frame[rows, columns] = value
    assert error(WeightedSpots, apertures, frames, places) < 1.25 * clean


def test_a_background_that_slopes_does_not_move_the_spots():
    rng = np.random.default_rng(306)
    apertures, frames, places = draw(rng, 4, 16.0, 30)
    slope = 2.0 * np.arange(frames.shape[2])
    flat = error(WeightedSpots, apertures, noisy(frames + slope.mean(), rng), places)
    assert error(WeightedSpots, apertures, noisy(frames + slope, rng), places) < 1.2 * flat


def combined(away, variances, misfits=None):
    apertures = np.zeros((len(away), 3))
    centres = np.column_stack([away, away])[None]
    misfits = np.ones(len(away)) if misfits is None else misfits
    found, sure = np.empty((1, 2)), np.empty((1, 2))
    used = np.empty((1, len(away)), dtype=np.bool_)
    combine(centres, variances[None], misfits[None], apertures, found, sure, used)
    return found[0, 0], sure[0, 0], used[0]


def test_designs_without_images_of_apertures_are_refused():
    design = SensorGeometry(
        focal_length_mm=7.0,
        pixel_pitch_mm=0.01,
        aperture_width_mm=0.02,
        aperture_shape="round",
    )
    with pytest.raises(ValueError, match="diffraction"):
        WeightedSpots.for_sensor(design)


def strangers(rng, apertures, frames, places):
    """Add the light of three spots of no aperture to each frame, near or upon the others."""
    half = max(abs(x) for x, _, _ in apertures) + 3.0
    spoilt = frames.copy()
    for k, place in enumerate(places):
        for _ in range(3):
            at = [(*rng.uniform(-half, half, 2), WIDTH)]
            spoilt[k] += light(at, place, frames.shape[1:]) - BACKGROUND
    return spoilt


@pytest.mark.parametrize("spoil", [None, strangers])
def test_the_covariance_is_that_of_the_errors_also_beside_light_of_no_aperture(spoil):
    """Normalised errors squared average 2 for two coordinates: of 320, within 17 % (3 sigma)."""
    rng = np.random.default_rng(311)
    apertures, frames, places = draw(rng, 5, 16.0, 40)
    if spoil is not None:
        frames = spoil(rng, apertures, frames, places)
    many = noisy(np.repeat(frames, 8, axis=0), rng).astype(np.uint16)
    found = WeightedSpots(apertures, blur_px=2.0).measure(many)
    errors = found.features - np.repeat(places, 8, axis=0)
    answered = np.isfinite(errors[:, 0])
    assert answered.mean() > 0.97
    np.testing.assert_array_equal(np.isfinite(found.covariance).all(axis=(1, 2)), answered)
    inverse = np.linalg.inv(found.covariance[answered])
    squares = np.einsum("ni,nij,nj->n", errors[answered], inverse, errors[answered])
    assert 1.66 < squares.mean() < 2.34


def test_one_aperture_states_no_covariance():
    rng = np.random.default_rng(312)
    apertures, frames, places = draw(rng, 1, 16.0, 10)
    found = WeightedSpots(apertures, blur_px=2.0).measure(noisy(frames, rng).astype(np.uint16))
    assert np.abs(found.features - places).max() < 0.1
    assert np.isnan(found.covariance).all()


@pytest.mark.parametrize("each", [40, 60, 64, 70, 150])
def test_other_light_around_a_spot_is_told_as_the_written_steps_tell_it(each):
    """The compiled loop has the numbers of its own Python where a ring holds another light.

    At some 57 to 72 pixels a spot the ring's mask once took the memory of the sums.
    """
    rng = np.random.default_rng(each)
    ends = np.array([each, 2 * each, 3 * each])
    pixels = np.zeros((6, 3 * each))
    pixels[0], pixels[1] = rng.integers(0, 60, (2, 3 * each))
    pixels[3] = rng.uniform(0.0, 9.0, 3 * each)
    pixels[2] = 40.0 + 0.3 * pixels[0] + rng.normal(0.0, 3.0, 3 * each)
    lit = slice(each, each + each // 4)
    pixels[2, lit] += rng.uniform(200.0, 900.0, each // 4)
    pixels[3, lit] = 8.0
    compiled, written = pixels.copy(), pixels.copy()
    lights = np.zeros((2, 3))
    noises = (
        spot_pixels_kernel._flatten(compiled, ends, 6.0, lights[0]),
        spot_pixels_kernel._flatten.py_func(written, ends, 6.0, lights[1]),
    )
    assert noises[0] == pytest.approx(noises[1], rel=1e-12)
    np.testing.assert_allclose(compiled[2], written[2], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(lights[0], lights[1], rtol=1e-9)
