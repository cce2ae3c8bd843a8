"""Methods that claim so answer one whole light, and nothing else."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.special import ndtr

from algorithms.contract import FeatureKind, Observation, SensorGeometry
from algorithms.discovery import discover_extractors
from algorithms.extractors.frames.gaussian import GaussianFit
from algorithms.extractors.frames.single_light import judge, light_of, refused_flags
from algorithms.measurement import QualityFlag

SIZE, RADIUS = 64, 8.0
#: A hole of 16 px, as wide as the spots are.
SENSOR = SensorGeometry(
    focal_length_mm=1.0,
    pixel_pitch_mm=0.01,
    centre_px=(31.5, 31.5),
    aperture_width_mm=0.16,
    aperture_shape="round",
    half_fov_deg=30.0,
)


def made():
    """Methods that claim it, by a field for the longest light that they take, for that sensor."""
    for name, extractor in discover_extractors().items():
        about, fields = extractor.about, {field.name for field in dataclasses.fields(extractor)}
        if about.observation is Observation.FRAMES and "longest_px" in fields:
            assert about.kind is FeatureKind.SPOT
            yield name, extractor.for_sensor(SENSOR)


METHODS = dict(made())


def disc(x, y):
    rows, columns = np.mgrid[:SIZE, :SIZE]
    return ndtr((RADIUS - np.hypot(columns - x, rows - y)) / 0.7)


def read(light, rng):
    mean = 20 + 2000 * np.asarray(light)
    shown = np.clip(np.rint(rng.poisson(mean) + rng.normal(0, 10, mean.shape)), 0, 4095)
    return shown.astype(np.uint16)


def frozen(frames):
    """Frames as extractors get them, for which kernels are compiled already."""
    frames.setflags(write=False)
    return frames


def scenes(kind, count, rng):
    """Frames, and where the Sun is."""
    centres = rng.uniform(26, 37, (count, 2))
    turns = rng.uniform(0, 2 * np.pi, count)
    away = np.column_stack([np.cos(turns), np.sin(turns)])
    light = [disc(*c) for c in centres]
    if kind in {"two", "ghost"}:
        off = rng.uniform(5, 20, (count, 1)) * away
        share = 1.0 if kind == "two" else 0.5
        light = [a + share * disc(*c) for a, c in zip(light, centres + off, strict=True)]
    elif kind == "cut":
        centres[:, 0] = rng.uniform(-3, 7, count)
        light = [disc(*c) for c in centres]
    elif kind in {"none", "one hot"}:
        light = np.zeros((count, SIZE, SIZE))
    frames = read(light, rng)
    if kind in {"hot", "one hot"}:
        for frame in frames:
            frame.flat[rng.integers(0, frame.size, 5 if kind == "hot" else 1)] = 4095
    return frames, centres


@pytest.mark.parametrize("kind", ["two", "ghost", "cut", "hot", "none", "one hot"])
@pytest.mark.parametrize("name", METHODS)
def test_no_answer_is_a_pixel_off(name, kind):
    frames, centres = scenes(kind, 25, np.random.default_rng(771))
    found = METHODS[name].extract(frames)
    answered = np.isfinite(found).all(axis=1)
    if kind == "hot":
        assert (np.hypot(*(found - centres)[answered].T) < 1.0).all()
    else:
        assert not answered.any()


@pytest.mark.parametrize("name", METHODS)
def test_one_whole_spot_is_answered(name):
    frames, centres = scenes("one", 25, np.random.default_rng(772))
    found = METHODS[name].extract(frames)
    assert np.abs(found - centres).max() < 0.1


def test_an_answer_to_something_else_than_the_light_is_none():
    frames, centres = scenes("one", 4, np.random.default_rng(773))
    centres[1] += 0.8
    centres[2] = np.nan
    flags = judge(frames, centres).flags
    assert flags.tolist() == [0, int(QualityFlag.NO_SPOT), int(QualityFlag.NO_SPOT), 0]
    assert refused_flags(flags).tolist() == [False, True, True, False]


def test_designs_without_a_hole_take_any_light_but_no_hot_pixel():
    """A slit's line is no spot, yet it is what its sensor sees."""
    assert light_of(SENSOR) == "spot"
    slit = GaussianFit.for_sensor(SensorGeometry(focal_length_mm=1.0))
    assert slit.light == "any"
    rng = np.random.default_rng(774)
    rows, columns = np.mgrid[:SIZE, :SIZE]
    line = ndtr((25 - abs(rows - 31)) / 0.7) * ndtr((3 - abs(columns - 30)) / 0.7)
    frames = frozen(np.concatenate([read(line[None], rng), scenes("one hot", 1, rng)[0]]))
    assert np.isfinite(slit.extract(frames))[:, 0].tolist() == [True, False]
    assert np.isnan(GaussianFit().extract(frames)).all()


def gaussians(count, rng):
    """Frames of Gaussian spots, and where they are."""
    rows, columns = np.mgrid[:SIZE, :SIZE]
    centres = rng.uniform(26, 37, (count, 2))
    light = [np.exp(-((columns - x) ** 2 + (rows - y) ** 2) / 18.0) for x, y in centres]
    return read(light, rng), centres


@pytest.mark.parametrize(("name", "own"), [("gaussian-fit", False), ("mirror", True)])
def test_the_covariance_is_about_that_of_the_errors(name, own):
    """Of 300 frames, two coordinates' normalised errors squared average 2 within a third."""
    rng = np.random.default_rng(775)
    frames, centres = scenes("one", 300, rng) if own else gaussians(300, rng)
    found = METHODS[name].measure(frames)
    errors = found.features - centres
    stated = np.isfinite(found.covariance).all(axis=(1, 2))
    assert stated.mean() > 0.9, "registration's noise, which tells misfits, is uncertain itself"
    inverse = np.linalg.inv(found.covariance[stated])
    squares = np.einsum("ni,nij,nj->n", errors[stated], inverse, errors[stated])
    assert 1.4 < squares.mean() < 2.7
    np.testing.assert_array_equal(found.features, METHODS[name].extract(frames))


@pytest.mark.parametrize("dark", [0.0, 50.0])
@pytest.mark.parametrize("name", ["gaussian-fit", "mirror"])
def test_frames_without_noise_are_answered(name, dark):
    """Nothing scatters that an error could be determined by: no covariance, or next to none."""
    line = np.exp(-((np.arange(SIZE) - 31.4) ** 2) / 18.0)
    for light, centre in ((disc(30.3, 31.6), [30.3, 31.6]), (np.outer(line, line), [31.4, 31.4])):
        found = METHODS[name].measure(dark + 900.0 * light)
        assert not (found.covariance > 1e-6).any()
        if np.isfinite(found.features).all():
            np.testing.assert_allclose(found.features[0], centre, atol=0.02)


@pytest.mark.parametrize("spoilt", ["shape", "slope", "dead"])
def test_no_covariance_is_stated_where_the_light_is_of_another_shape(spoilt):
    """What a fit of the wrong shape errs by, noise does not tell; a mirror asks for no shape."""
    rng = np.random.default_rng(776)
    rows, columns = np.mgrid[:SIZE, :SIZE]
    centres = rng.uniform(28, 35, (40, 2))
    stretch = 1.6 if spoilt == "shape" else 1.0
    light = np.array(
        [ndtr((7 - np.hypot((columns - x) / stretch, rows - y)) / 0.7) for x, y in centres]
    )
    if spoilt == "slope":
        light += 0.3 * columns / SIZE
    frames = read(light, rng)
    if spoilt == "dead":
        frames[:, [28, 31, 34], [33, 30, 32]] = 0
    for name, answers in (("gaussian-fit", 0.9), ("mirror", 0.0)):
        found = METHODS[name].measure(frames)
        answered = np.isfinite(found.features[:, 0])
        stated = np.isfinite(found.covariance).all(axis=(1, 2))
        if name == "mirror":
            np.testing.assert_array_equal(stated, answered)
        else:
            assert answered.mean() >= answers
            assert not stated.any()
