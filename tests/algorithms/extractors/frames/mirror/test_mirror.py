"""Mirror registration against the bound, known centres, defects, and frames without an answer."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import j1, ndtr

from algorithms.contract import SensorGeometry
from algorithms.extractors.frames.mirror.extractor import MirrorRegistration
from algorithms.extractors.frames.mirror.registration import register
from algorithms.measurement import QualityFlag

PEAK, DARK, READ = 2000.0, 20.0, 10.0
#: Sigma of the rims, px, and points across a pixel over which light is averaged.
RIM, FINE = 0.7, 3
SIZE = 64


def disc(x, y, radius=8.0):
    return ndtr((radius - np.hypot(x, y)) / RIM)


def ellipse(x, y, radius=8.0, incidence=60.0, turn=0.5):
    """A disc stretched as light at this incidence does, turned."""
    k = 1 / np.cos(np.deg2rad(incidence))
    u, v = x * np.cos(turn) + y * np.sin(turn), y * np.cos(turn) - x * np.sin(turn)
    rho = np.maximum(np.hypot(u / k, v), 1e-9)
    return ndtr((radius - rho) * rho / np.hypot(u / k**2, v).clip(1e-9) / RIM)


def square(x, y, half=8.0):
    return ndtr((half - np.abs(x)) / RIM) * ndtr((half - np.abs(y)) / RIM)


def gaussian(x, y):
    return np.exp(-(x**2 + y**2) / (2 * 3.0**2))


def airy(x, y):
    t = np.hypot(x, y) / 2.0 + 1e-9
    return (2 * j1(t) / t) ** 2


def render(shape, centre, size=SIZE):
    fine = (np.arange(size * FINE) + 0.5) / FINE - 0.5
    light = shape(fine[None, :] - centre[0], fine[:, None] - centre[1])
    return light.reshape(size, FINE, size, FINE).mean(axis=(1, 3))


def noisy(mean, rng):
    signal = rng.poisson(mean) + rng.normal(0, READ, mean.shape)
    return np.clip(np.rint(signal), 0, 4095).astype(np.uint16)


def spots(shape, count, seed, margin=26.0, peak=PEAK):
    rng = np.random.default_rng(seed)
    centres = rng.uniform(margin, SIZE - 1 - margin, (count, 2))
    light = np.stack([DARK + peak * render(shape, c) for c in centres])
    return noisy(light, rng), centres, rng


def bound(shape, centres, peak=PEAK, step=1e-3):
    """Cramer-Rao bound of an axis; amplitude and background are unknown too."""
    variances = []
    for c in centres:
        light = render(shape, c)
        moves = [
            (render(shape, c + m) - render(shape, c - m)) * peak / (2 * step)
            for m in step * np.eye(2)
        ]
        jacobian = np.stack([*moves, light, np.ones_like(light)], axis=-1).reshape(-1, 4)
        weight = 1 / (DARK + peak * light + READ**2 + 1 / 12).reshape(-1, 1)
        variances.append(np.diag(np.linalg.inv(jacobian.T @ (jacobian * weight)))[:2])
    return float(np.sqrt(np.mean(variances)))


def rms(found, centres):
    return float(np.sqrt(np.mean((found - centres) ** 2)))


@pytest.mark.slow
@pytest.mark.parametrize("shape", [disc, ellipse, square, gaussian, airy])
def test_every_point_symmetric_spot_is_found_at_its_bound(shape):
    frames, centres, _ = spots(shape, 200, 31, margin=28.0 if shape is ellipse else 24.0)
    # 400 errors scatter by 3.5 % of their root mean square.
    assert rms(MirrorRegistration().extract(frames), centres) < 1.2 * bound(shape, centres[:4])


@pytest.mark.parametrize("shape", [disc, ellipse, square, gaussian])
def test_a_noiseless_spot_is_found_to_a_thousandth_of_a_pixel(shape):
    centres = np.random.default_rng(33).uniform(29, 34, (12, 2))
    frames = np.stack([100 + 1000 * render(shape, c) for c in centres])
    np.testing.assert_allclose(MirrorRegistration().extract(frames), centres, atol=2e-3)


def test_turning_or_transposing_the_frame_does_so_with_the_answer():
    frames, _, _ = spots(ellipse, 8, 34)
    found = MirrorRegistration().extract(frames)
    turned = MirrorRegistration().extract(frames[:, ::-1, ::-1])
    np.testing.assert_allclose(turned, SIZE - 1 - found, atol=1e-6)
    swapped = MirrorRegistration().extract(frames.transpose(0, 2, 1))
    # Noise, and so the weights, are estimated from neighbours along the rows: a tenth of an error's
    # size.
    np.testing.assert_allclose(swapped, found[:, ::-1], atol=1e-3)


@pytest.mark.parametrize("value", [4095, 0])
def test_hot_and_dead_pixels_anywhere_move_the_centre_by_less_than_half_the_noise(value):
    frames, centres, rng = spots(disc, 60, 35, margin=20.0)
    clean = rms(MirrorRegistration().extract(frames), centres)
    for frame in frames:
        frame[rng.integers(0, SIZE, 5), rng.integers(0, SIZE, 5)] = value
    assert rms(MirrorRegistration().extract(frames), centres) < 1.5 * clean


def test_a_sloping_background_and_a_halo_are_taken_off():
    frames, centres, rng = spots(disc, 40, 36)
    limit = 2.5 * bound(disc, centres[:3])
    y, x = np.mgrid[:SIZE, :SIZE]
    sloping = frames + rng.poisson(3.0 * x + 2.0 * y, frames.shape)
    assert rms(MirrorRegistration().extract(sloping), centres) < limit
    halos = [0.05 * PEAK * np.exp(-((x - a - 7) ** 2 + (y - b + 4) ** 2) / 450) for a, b in centres]
    hazy = frames + rng.poisson(halos)
    assert rms(MirrorRegistration().extract(hazy), centres) < limit


def lights(second, apart, seed, count=40):
    """Discs with a second one, so many times as bright, at this distance."""
    rng = np.random.default_rng(seed)
    centres = rng.uniform(26, 37, (count, 2))
    turns = rng.uniform(0, 2 * np.pi, count)
    other = centres + apart * np.column_stack([np.cos(turns), np.sin(turns)])
    light = [
        DARK + PEAK / 1.6 * (render(disc, a) + second * render(disc, b))
        for a, b in zip(centres, other, strict=True)
    ]
    return noisy(np.stack(light), rng)


@pytest.mark.parametrize("second", [1.0, 0.5])
@pytest.mark.parametrize("apart", [6.0, 12.0, 20.0])
def test_two_lights_are_no_answer(second, apart):
    """Overlapping ones too: two equal ones are symmetric about their middle."""
    found = MirrorRegistration().measure(lights(second, apart, 37, 15))
    assert np.isnan(found.features).all()
    two = int(QualityFlag.SEVERAL_SPOTS | QualityFlag.NOT_SYMMETRIC | QualityFlag.CUT)
    assert (found.flags & two != 0).all()


def test_a_weaker_light_upon_a_spot_without_outlines_makes_it_skew():
    """Half as bright, 1.3 to 2 widths off: it moves the best symmetric centre by over a pixel."""
    rng = np.random.default_rng(48)
    centres, turns = rng.uniform(28, 35, (40, 2)), rng.uniform(0, 2 * np.pi, 40)
    off = rng.uniform(4.0, 6.0, (40, 1)) * np.column_stack([np.cos(turns), np.sin(turns)])
    light = [
        DARK + PEAK * (render(gaussian, a) + 0.5 * render(gaussian, a + b))
        for a, b in zip(centres, off, strict=True)
    ]
    found = register(noisy(np.stack(light), rng))
    assert np.isnan(found.features).all()
    assert (found.flags & int(QualityFlag.NOT_SYMMETRIC) != 0).mean() > 0.9


@pytest.mark.slow
@pytest.mark.parametrize("shape", [disc, ellipse, square, gaussian])
def test_the_covariance_is_that_of_the_errors(shape):
    """Normalised errors squared average 2 for two coordinates; of 400, within 15 % (3 sigma)."""
    frames, centres, _ = spots(shape, 400, 43, margin=28.0 if shape is ellipse else 24.0)
    found = MirrorRegistration().measure(frames)
    answered = np.isfinite(found.features).all(axis=1)
    assert answered.mean() > 0.97
    errors = (found.features - centres)[answered]
    squares = np.einsum("ni,nij,nj->n", errors, np.linalg.inv(found.covariance[answered]), errors)
    assert 1.7 < squares.mean() < 2.3


def test_every_missing_answer_says_why():
    rng = np.random.default_rng(44)
    one = PEAK * render(disc, (30.3, 31.6))
    light = DARK + np.stack(
        [one, 0 * one, one + PEAK * render(disc, (12.0, 12.0)), PEAK * render(disc, (2.0, 30.0))]
    )
    found = MirrorRegistration().measure(noisy(light, rng))
    assert [QualityFlag(d) for d in found.flags] == [
        0,
        QualityFlag.NO_SPOT,
        QualityFlag.SEVERAL_SPOTS,
        QualityFlag.CUT,
    ]
    half = np.where(np.arange(SIZE)[:, None] > 30, one, 0.0)
    half[31:40] *= np.linspace(0.4, 1.0, SIZE)
    found = MirrorRegistration().measure(noisy(DARK + half, rng))
    assert found.flags[0] & int(QualityFlag.NOT_SYMMETRIC | QualityFlag.SEVERAL_SPOTS)


@pytest.mark.parametrize("value", [4095, 0])
def test_hot_and_dead_pixels_on_the_spot_cost_little(value):
    frames, centres, rng = spots(disc, 60, 45)
    clean = rms(MirrorRegistration().extract(frames), centres)
    for frame, (x, y) in zip(frames, centres, strict=True):
        radius, turn = 8 * np.sqrt(rng.uniform(size=5)), rng.uniform(0, 2 * np.pi, 5)
        rows, columns = y + radius * np.sin(turn), x + radius * np.cos(turn)
        frame[rows.round().astype(int), columns.round().astype(int)] = value
    found = MirrorRegistration().extract(frames)
    answered = np.isfinite(found).all(axis=1)
    assert answered.mean() > 0.95
    assert rms(found[answered], centres[answered]) < 1.3 * clean


def test_pixels_known_as_bad_are_left_out_whatever_they_hold():
    frames, centres, rng = spots(disc, 40, 46)
    bad = np.zeros((SIZE, SIZE), dtype=np.bool_)
    bad[rng.integers(20, 44, 12), rng.integers(20, 44, 12)] = True
    spoilt = np.where(bad, np.nan, frames.astype(np.float64))
    found = MirrorRegistration().measure(spoilt, bad)
    assert rms(found.features, centres) < 1.4 * bound(disc, centres[:3])
    spoilt[:, bad] = 700.0
    np.testing.assert_array_equal(
        MirrorRegistration().measure(spoilt, bad).features, found.features
    )


@pytest.mark.parametrize("known", [False, True])
def test_a_hot_pixel_has_the_light_expected_of_its_partner_in_its_place(known):
    """Without noise, wherever it is on a spot whose middle is on no pixel: the same centre."""
    clean = DARK + PEAK * render(gaussian, (31.2, 30.7))
    lit = np.argwhere(clean > DARK + 0.1 * PEAK)[::3]
    found = []
    for row, column in lit:
        hot, bad = clean.copy(), np.zeros(clean.shape, dtype=np.bool_)
        hot[row, column] += 800.0
        bad[row, column] = known
        found.append(register(hot[None], bad if known else None).features[0])
    np.testing.assert_allclose(found - register(clean[None]).features, 0.0, rtol=0, atol=1e-3)


def test_the_unit_of_the_light_does_not_matter():
    """Powers of two leave every digit as it is."""
    frames, _, _ = spots(disc, 3, 51)
    here = register(frames.astype(np.float64))
    assert np.isfinite(here.features).all()
    for unit in (2.0**-20, 2.0**20):
        there = register(frames * unit)
        np.testing.assert_allclose(there.features, here.features, rtol=0, atol=1e-6)
        np.testing.assert_array_equal(there.flags, here.flags)


@pytest.mark.parametrize(("more", "symmetric"), [(0.0, True), (0.4, False)])
def test_light_that_is_more_in_three_directions_is_not_symmetric_even_within_the_noise(
    more, symmetric
):
    """On average a tenth of the light, less than a pixel's noise: but neighbours miss it alike."""
    rng = np.random.default_rng(60)
    centres = rng.uniform(29, 34, (8, 2))

    def lobed(x, y):
        return disc(x, y, 14.0) * (1 + more * np.imag((x + 1j * y) ** 3) / 14.0**3).clip(0)

    light = np.stack([DARK + 100.0 * render(lobed, c) for c in centres])
    # Of a design whose spots are long: their outlines, and their skewness, say nothing.
    found = register(noisy(light, rng), longest_px=40.0)
    flags = found.flags & int(QualityFlag.NOT_SYMMETRIC)
    assert ((flags == 0) == symmetric).all()
    assert (np.isfinite(found.features).all(axis=1) == symmetric).all()


def test_windows_of_a_frame_are_registered_like_frames():
    frames, centres, _ = spots(gaussian, 6, 47)
    windows = frames[:, 8:56, 10:58]
    found = register(windows)
    np.testing.assert_allclose(found.features + np.array([10, 8]), centres, atol=0.05)
    assert (found.flags == 0).all()


@pytest.mark.parametrize(("dtype", "masked"), [(np.uint16, True), (np.float64, False)])
def test_a_frame_has_the_same_answer_alone_and_in_any_company(dtype, masked):
    """To the bit, whatever the others' windows are like: work space is shared."""
    rng = np.random.default_rng(50)
    kinds = [
        render(lambda x, y, radius=radius: disc(x, y, radius), (31.2, 30.7))
        for radius in (2.0, 8.0, 20.0)
    ]
    kinds += [render(gaussian, (22.4, 40.1)), render(disc, (3.0, 30.0)), np.zeros((SIZE, SIZE))]
    kinds += [render(disc, (14.0, 20.0)) + render(disc, (44.0, 40.0))]
    frames = noisy(DARK + PEAK * np.stack([kinds[k % len(kinds)] for k in range(64)]), rng)
    frames[::3, 33, 28] = 4095
    frames = frames.astype(dtype) + dtype(0 if dtype is np.uint16 else 0.25)
    bad = rng.uniform(size=(SIZE, SIZE)) < 0.01 if masked else None
    together = register(frames, bad)
    assert len(set(together.flags.tolist())) > 3, "several kinds of answers"
    for step in (1, 7):
        apart = [register(frames[k : k + step], bad) for k in range(0, len(frames), step)]
        for name in ("features", "covariance", "flags"):
            parts = np.concatenate([getattr(part, name) for part in apart])
            np.testing.assert_array_equal(parts, getattr(together, name))


def test_a_frame_without_the_sun_is_no_answer_whatever_its_hot_pixels():
    rng = np.random.default_rng(38)
    frames = noisy(np.full((300, SIZE, SIZE), DARK), rng)
    assert np.isnan(MirrorRegistration().extract(frames)).all()
    for frame in frames:
        frame[rng.integers(0, SIZE), rng.integers(0, SIZE)] = rng.integers(200, 4096)
    assert np.isnan(MirrorRegistration().extract(frames)).all()


def test_a_hot_pixel_does_not_outshine_a_weak_spot():
    frames, centres, rng = spots(disc, 40, 39, margin=20.0, peak=120.0)
    for frame, (x, y) in zip(frames, centres, strict=True):
        near = rng.integers(-13, 14, 2)
        frame[round(y) + near[0], round(x) + near[1]] = 4095
    found = MirrorRegistration().extract(frames)
    answered = np.isfinite(found).all(axis=1)
    assert answered.mean() > 0.9
    assert np.abs(found - centres)[answered].max() < 0.5


def test_a_spot_cut_by_the_edge_is_no_answer():
    rng = np.random.default_rng(40)
    along, across = rng.uniform(10, 53, 60), rng.uniform(-8, 6, 60)
    centres = np.column_stack([across, along])
    frames = noisy(np.stack([DARK + PEAK * render(disc, c) for c in centres]), rng)
    for turned in range(4):
        cut = np.rot90(frames, turned, axes=(1, 2))
        assert np.isnan(MirrorRegistration().extract(cut)).all()


def test_saturation_leaves_a_symmetric_spot_where_it_is_and_is_said():
    frames, centres, _ = spots(gaussian, 20, 41, peak=30_000.0)
    assert (frames == 4095).sum(axis=(1, 2)).min() > 20
    found = MirrorRegistration().measure(frames)
    assert rms(found.features, centres) < 0.02
    assert (found.flags == int(QualityFlag.SATURATED)).all()


def designed(**fields):
    """A hole of 16 px, 2 mm above pixels of 5 um, out to 20 deg."""
    given = {"focal_length_mm": 2.0, "pixel_pitch_mm": 0.005, "half_fov_deg": 20.0}
    hole = {"aperture_width_mm": 0.08, "aperture_shape": "round"}
    return MirrorRegistration.for_sensor(SensorGeometry(**{**given, **hole, **fields}))


def fringed(x, y):
    """A shadow of radius 8 with two bright fringes side by side, as oblique light has."""
    return disc(x, y) * (0.55 + 0.45 * np.tanh(0.3 * np.abs(x)))


def test_a_design_tells_fringes_of_one_spot_from_two_lights():
    frames, centres, _ = spots(fringed, 60, 301)
    assert np.isnan(MirrorRegistration().extract(frames)[:, 0]).mean() > 0.9
    found = designed().extract(frames)
    assert np.isfinite(found).all()
    assert rms(found, centres) < 0.05
    two = np.concatenate([lights(1.0, apart, 302) for apart in (11.0, 14.0, 17.0, 20.0)])
    assert np.isnan(designed().extract(two)).all()


@pytest.mark.slow
@pytest.mark.parametrize(("radius", "peak"), [(2.0, PEAK), (4.0, PEAK), (8.0, 200.0)])
def test_the_covariance_holds_for_few_pixels_and_for_weak_light(radius, peak):
    """Of 500 frames, within 20 % of 2: four deviations; few pixels tell little of their noise."""
    frames, centres, _ = spots(lambda x, y: disc(x, y, radius), 500, 52, peak=peak)
    found = MirrorRegistration().measure(frames)
    assert np.isfinite(found.features).all(axis=1).mean() > 0.97
    errors = found.features - centres
    seen = np.isfinite(errors[:, 0])
    inverse = np.linalg.inv(found.covariance[seen])
    squares = np.einsum("ni,nij,nj->n", errors[seen], inverse, errors[seen])
    assert 1.6 < squares.mean() < 2.4
