"""Masks of many apertures: what the spots are, which aperture cast them, what is undetermined."""

import itertools

import numpy as np
import pytest
from scipy.special import ndtr

from algorithms.contract import FeatureKind, SensorGeometry
from algorithms.extractors.frames.multi_spot.image_correlation import ImageCorrelation
from algorithms.extractors.frames.multi_spot.mean_shift import MeanShift
from algorithms.extractors.frames.multi_spot.multiple_centroids import MultipleCentroids
from algorithms.pipeline import in_detector_coordinates

WIDTH = 9.0


def square_grid(side=4, spacing=23.7):  # no whole number: spots fall differently on the pixels
    steps = (np.arange(side) - (side - 1) / 2) * spacing
    return tuple((float(x), float(y), WIDTH) for y in steps for x in steps)


def coded(fields=5, pitch=63.7, first=20.3, step=2.1):
    """Groups of three whose spacings name their column and row, wider than any frame here."""
    rows = []
    for j, i in itertools.product(range(fields), repeat=2):
        x, y = (i - (fields - 1) / 2) * pitch, (j - (fields - 1) / 2) * pitch
        rows += [(x, y), (x + first + i * step, y), (x, y + first + j * step)]
    return tuple((x, y, WIDTH) for x, y in rows)


GRID, CODE = square_grid(), coded()


def methods(apertures):
    return (
        MultipleCentroids(apertures, faulty_lines=1),
        MeanShift(apertures, bandwidth_px=10.0, faulty_lines=1),
        ImageCorrelation(apertures, faulty_lines=1),
    )


every_method = pytest.mark.parametrize("which", range(3), ids=["mcam", "fmms", "feic"])


def frame_of(apertures, place, shape=(128, 132), light=None):
    """Discs with a soft rim at their exact places; `light` (A,) is what each aperture passes."""
    y, x = np.arange(shape[0])[:, None], np.arange(shape[1])
    frame = np.full(shape, 20.0)
    for k, (dx, dy, width) in enumerate(apertures):
        cx, cy = place[0] + dx, place[1] + dy
        reach = width / 2 + 7.0  # beyond ten widths of the rim a double does not notice the light
        near = np.s_[_around(cy, reach), _around(cx, reach)]
        away = width / 2 - np.hypot(x[near[1]] - cx, y[near[0]] - cy)
        frame[near] += 600.0 * (1.0 if light is None else light[k]) * ndtr(away / 0.7)
    return frame


def _around(place, reach):
    return slice(max(int(place - reach), 0), max(int(place + reach) + 2, 0))


def noisy(frames, seed, noise=8.0):
    rng = np.random.default_rng(seed)
    return np.clip(np.rint(frames + rng.normal(0, noise, np.shape(frames))), 0, 4095).astype(
        np.uint16
    )


# Any of them


@pytest.mark.slow
@every_method
def test_noiseless_spots_are_inverted_anywhere(which):
    places = np.random.default_rng(1).uniform((52, 50), (80, 78), (30, 2))
    frames = np.stack([frame_of(GRID, place) for place in places])
    extractor = methods(GRID)[which]
    assert np.abs(extractor.extract(frames) - places).max() < (0.02, 0.05, 0.02)[which]
    spots = extractor.spots(frames)
    true = places[:, None] + np.array(GRID)[:, :2]
    assert np.sqrt(np.mean((spots - true) ** 2)) < (0.02, 0.08, 0.01)[which]
    assert np.abs(spots - true).max() < (0.03, 0.25, 0.03)[which]


@every_method
def test_missing_and_cut_spots_are_left_out(which):
    light = np.ones(len(GRID))
    light[[1, 7, 12]] = 0.0
    place = np.array([94.4, 61.7])  # the last column is cut by the right edge
    frame = frame_of(GRID, place, light=light)[None]
    extractor = methods(GRID)[which]
    np.testing.assert_allclose(extractor.extract(frame), place[None], atol=0.06)
    gone = np.isnan(extractor.spots(frame)[0, :, 0])
    assert sorted(np.flatnonzero(gone)) == sorted({1, 7, 12} | {3, 11, 15} | {7})


@every_method
def test_a_grid_is_not_taken_for_itself_moved_by_a_hole(which):
    """With a column or a row out of the frame, what is not seen decides."""
    rng = np.random.default_rng(2)
    for place in ((104.0, 60.0), (26.0, 62.0), (64.0, 101.0), (104.5, 101.2)):
        for _ in range(4):
            light = np.where(rng.random(len(GRID)) < 0.15, 0.0, 1.0)
            found = methods(GRID)[which].extract(frame_of(GRID, place, light=light)[None])[0]
            assert np.isnan(found).all() or np.abs(found - place).max() < 0.1


@every_method
def test_a_code_names_the_part_of_the_mask_seen(which):
    places = np.random.default_rng(3).uniform((-50, -45), (178, 170), (40, 2))
    frames = noisy(np.stack([frame_of(CODE, place) for place in places]), 3)
    found = methods(CODE)[which].extract(frames)
    seen = ~np.isnan(found[:, 0])
    assert seen.mean() > 0.9
    assert np.abs(found[seen] - places[seen]).max() < 0.15


@every_method
def test_half_a_code_is_refused_or_right(which):
    """A third of the apertures closed leaves pairs that several sub-fields share."""
    rng = np.random.default_rng(4)
    places = rng.uniform((-50, -45), (178, 170), (60, 2))
    frames = [frame_of(CODE, p, light=rng.random(len(CODE)) > 0.35) for p in places]
    found = methods(CODE)[which].extract(noisy(np.stack(frames), 4))
    seen = ~np.isnan(found[:, 0])
    assert seen.any()
    assert not seen.all()
    assert np.abs(found[seen] - places[seen]).max() < 0.15


@every_method
def test_a_window_of_a_coded_frame_gives_the_same_place(which):
    """The code holds wherever the window stands; its origin is added to the spot's place."""
    frame = noisy(frame_of(CODE, (150.3, 142.8), (300, 300)), 5)
    whole = methods(CODE)[which].extract(frame[None])
    for left, top in ((0, 0), (40, 77), (131, 20), (160, 170)):
        window = frame[None, top : top + 130, left : left + 140]
        found = in_detector_coordinates(
            methods(CODE)[which].extract(window), FeatureKind.SPOT, [[left, top]]
        )
        np.testing.assert_allclose(found, whole, atol=0.1)


@every_method
def test_a_window_of_an_endless_grid_is_refused(which):
    frame = frame_of(square_grid(10), (150.0, 150.0), (300, 300))
    window = frame[None, 90:200, 80:200]
    assert np.isnan(methods(square_grid(10))[which].extract(window)).all()


@every_method
def test_what_is_no_pattern_is_not_found(which):
    rng = np.random.default_rng(6)
    two_suns = frame_of(GRID, (60.0, 60.0)) + frame_of(GRID, (72.0, 69.0)) - 20.0
    alone = frame_of(GRID, (64.0, 60.0), light=[1.0] + [0.0] * 15)
    bad = frame_of(GRID, (64.0, 60.0))
    bad[3, 4] = np.nan
    frames = np.stack(
        [
            two_suns,
            alone,
            bad,
            np.full_like(bad, 4095.0),
            np.zeros_like(bad),
            rng.normal(100, 10, bad.shape),
            rng.exponential(10, bad.shape),
        ]
    )
    assert np.isnan(methods(GRID)[which].extract(frames)).all()
    assert np.isnan(methods(GRID)[which].spots(frames)).all()


@every_method
@pytest.mark.parametrize("noise", [0.6, 5.0])
def test_noise_alone_is_not_taken_for_a_spot(which, noise):
    """Also where a digital number is more than the noise, and lit pixels come in clusters."""
    rng = np.random.default_rng(12)
    frames = np.rint(rng.normal(100, noise, (60, 48, 48))).astype(np.uint16)
    for width in (6.0, 18.0):
        assert np.isnan(methods(((0.0, 0.0, width),))[which].extract(frames)).all()


@every_method
def test_hot_pixels_and_dead_ones_cost_little(which):
    rng = np.random.default_rng(7)
    place = np.array([65.2, 61.4])
    frame = noisy(frame_of(GRID, place), 7)
    for value, number in ((4095, 3), (0, 40)):
        frame[rng.integers(0, 128, number), rng.integers(0, 132, number)] = value
    assert np.abs(methods(GRID)[which].extract(frame[None]) - place).max() < 0.3


# mean-shift's kernel has to be compiled for a single aperture
@pytest.mark.parametrize(
    "which", [0, pytest.param(1, marks=pytest.mark.slow), 2], ids=["mcam", "fmms", "feic"]
)
def test_one_aperture_is_a_mask_too(which):
    alone = ((0.0, 0.0, WIDTH),)
    places = np.random.default_rng(8).uniform(15, 45, (12, 2))
    frames = np.stack([frame_of(alone, place, (60, 62)) for place in places])
    assert np.abs(methods(alone)[which].extract(frames) - places).max() < 0.15
    two = frames[:1] + frame_of(alone, 60 - places[0], (60, 62))
    assert np.isnan(methods(alone)[which].extract(two)).all()


def test_fmms_weights_a_dirty_spot_less_and_a_missing_one_not_at_all():
    light = np.ones(len(GRID))
    light[3], light[6] = 0.0, 0.85
    frame = frame_of(GRID, (64.2, 60.7), light=light)[None]
    weights = MeanShift(GRID, bandwidth_px=10.0).weights(frame)[0]
    assert weights[3] == 0.0
    assert 0.0 < weights[6] < 0.95 < np.delete(weights, [3, 6]).min()


# Tracking


@pytest.mark.parametrize("which", [1, 2], ids=["fmms", "feic"])
def test_tracking_follows_the_sun_across_the_code(which):
    steps = np.linspace(0, 1, 60)[:, None]
    places = np.array([20.0, 10.0]) * (1 - steps) + np.array([120.0, 105.0]) * steps
    frames = noisy(np.stack([frame_of(CODE, place) for place in places]), 9)
    extractor = methods(CODE)[which]
    tracked = extractor.track(frames)
    assert np.abs(tracked - places).max() < 0.15
    np.testing.assert_array_equal(tracked[:1], extractor.extract(frames[:1]))


@pytest.mark.parametrize("which", [1, 2], ids=["fmms", "feic"])
def test_tracking_finds_the_spots_again(which):
    """After a jump, and after frames without light, the pattern is searched for anew."""
    places = np.array([[60.0, 60.0]] * 3 + [[71.0, 66.0]] * 2 + [[70.0, 66.0]] * 3)
    frames = noisy(np.stack([frame_of(GRID, place) for place in places]), 10)
    frames[5] = 0
    found = methods(GRID)[which].track(frames)
    assert np.isnan(found[5]).all()
    assert np.abs(np.delete(found - places, 5, axis=0)).max() < 0.1
    assert np.isnan(methods(GRID)[which].track(frames[5:6])).all()


@pytest.mark.parametrize("which", [1, 2], ids=["fmms", "feic"])
def test_tracking_keeps_a_code_that_one_frame_no_longer_tells(which):
    """The identity of the apertures is carried from frame to frame."""
    light = np.ones(len(CODE))
    first = frame_of(CODE, (64.0, 60.0))
    light[2::3] = 0.0  # corners and their right neighbours tell the column alone
    later = frame_of(CODE, (65.0, 60.5), light=light)
    frames = noisy(np.stack([first, later]), 11)
    extractor = methods(CODE)[which]
    assert np.isnan(extractor.extract(frames[1:])).all()
    np.testing.assert_allclose(extractor.track(frames)[1], [65.0, 60.5], atol=0.1)


# Making them


@pytest.mark.parametrize("method", [MultipleCentroids, MeanShift, ImageCorrelation])
@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        ({"slits": ((0.0, 0.0, 0.1),)}, "slits"),
        ({"code_bits": 6}, "code_bits"),
        ({"lens_distortion": (0.0, 0.0)}, "lens_distortion"),
        ({"aperture_shape": None}, "aperture_shape"),
        ({"aperture_width_mm": 0.02, "focal_length_mm": 7.0}, "diffraction"),
        ({"apertures": ((0.0, 0.0, 0.1), (0.01, 0.0, 0.1))}, "tolerance_px"),
    ],
)
def test_designs_without_images_of_apertures_are_refused(method, wrong, reason):
    design = {
        "focal_length_mm": 1.0,
        "pixel_pitch_mm": 0.01,
        "aperture_width_mm": 0.16,
        "aperture_shape": "round",
    }
    with pytest.raises(ValueError, match=reason):
        method.for_sensor(SensorGeometry(**(design | wrong)))
