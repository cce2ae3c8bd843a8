"""The place of a slit's image, against diffraction integrated by brute force."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import fresnel

from algorithms.contract import SensorGeometry, UnsuitableDesignError
from algorithms.extractors.profiles import slit_image_kernel
from algorithms.extractors.profiles.eigen_analysis import EigenAnalysis
from algorithms.extractors.profiles.linear_phase import LinearPhase
from algorithms.extractors.profiles.slit_image import SlitImage

PITCH, PIXELS, HEIGHT = 0.05, 64, 2.5
#: Wavelengths, mm, and shares of what silicon detects of sunlight.
COLOURS = [(4.5e-4, 0.19), (5.5e-4, 0.28), (6.5e-4, 0.25), (7.5e-4, 0.16), (8.5e-4, 0.12)]
DRAWN = SensorGeometry(
    focal_length_mm=HEIGHT,
    pixel_pitch_mm=PITCH,
    centre_px=((PIXELS - 1) / 2,) * 2,
    half_fov_deg=25.0,
    line_axes=("x", "y"),
    line_pixels=PIXELS,
    slits=((0.0, 0.0, 0.2),),
)


def cast(tangents: tuple[float, float], fill: float = 1.0) -> NDArray[np.float64]:
    """(2 L) light on two lines behind a slit 0.2 mm wide: Huygens' waves, added up one by one.

    The Sun is 400 points evenly spread over its disc, a pixel the mean over its sensitive part.
    """
    number = np.repeat(np.arange(200), 2)  # a sunflower's seeds, each with its opposite
    turn = number * np.pi * (3.0 - np.sqrt(5.0)) + np.tile([0.0, np.pi], 200)
    radius = 0.00465 * np.sqrt((number + 0.5) / 200)
    steps = np.linspace(-0.5, 0.5, 9) * fill
    square = 1.0 + tangents[0] ** 2 + tangents[1] ** 2
    found = []
    for t in tangents:
        spread = HEIGHT * np.sqrt(square) * (1.0 + t * t)
        points = HEIGHT * np.sqrt(square * (1.0 + t * t)) * radius * np.cos(turn)
        middle = (PIXELS - 1) / 2 + HEIGHT * t / PITCH
        places = (np.arange(PIXELS)[:, None] + steps - middle) * PITCH
        near = np.abs(places) < 9 * PITCH
        grid = np.linspace(-0.6, 0.6, 801)
        pattern = np.zeros_like(grid)
        slit, step = np.linspace(-0.1, 0.1, 601, retstep=True)
        for wave, share in COLOURS:
            phase = (grid[:, None] - slit) ** 2 / (wave * spread)
            field = np.trapezoid(np.exp(1j * np.pi * phase), dx=step, axis=1)
            pattern += share * np.abs(field) ** 2 / (wave * spread)
        light = np.zeros_like(places)
        for point in points:
            light[near] += np.interp(places[near] - point, grid, pattern) / len(points)
        found.append(np.trapezoid(light, axis=1) / (len(steps) - 1))
    return np.concatenate(found)


PLACES = [(0.0, 0.0), (0.013, 0.207), (-0.166, 0.171), (0.1, 0.305), (-0.352, -0.253)]


@pytest.fixture(scope="module")
def profiles() -> NDArray[np.float64]:
    return np.array([cast(tangents) for tangents in PLACES])


def expected() -> NDArray[np.float64]:
    return (PIXELS - 1) / 2 + HEIGHT / PITCH * np.array(PLACES)


def test_fresnel_s_integrals_are_scipys_between_samples_and_beyond() -> None:
    samples = np.arange(4 * slit_image_kernel.FRESNEL_STEPS) / slit_image_kernel.FRESNEL_STEPS
    phase = 0.5 * np.pi * samples**2
    table = np.column_stack([*fresnel(samples)[::-1], np.cos(phase), np.sin(phase)])
    for u in np.random.default_rng(5).uniform(0.0, samples[-1], 300):
        s, c = fresnel(u)
        np.testing.assert_allclose(slit_image_kernel._fresnel(u, table), (c, s), atol=1e-8)
    for u in (5.0, 30.0):
        s, c = fresnel(u)
        np.testing.assert_allclose(slit_image_kernel._fresnel(u, table), (c, s), atol=2e-4)


@pytest.mark.slow
def test_places_are_those_of_waves_added_up_one_by_one(profiles: NDArray[np.float64]) -> None:
    fit = SlitImage.for_sensor(DRAWN)
    assert np.abs(fit.extract(700.0 * profiles + 3.0) - expected()).max() < 0.003
    for other in (LinearPhase, EigenAnalysis):  # what knows no diffraction errs more
        assert np.abs(other.for_sensor(DRAWN).extract(profiles) - expected()).max() > 0.006


@pytest.mark.slow
def test_a_part_of_each_pixel_that_is_deaf_is_found_with_the_place() -> None:
    deaf = np.array([cast(tangents, fill=0.85) for tangents in PLACES])
    assert np.abs(SlitImage.for_sensor(DRAWN).extract(deaf) - expected()).max() < 0.004


def test_noise_moves_places_as_little_as_the_bound_allows(profiles: NDArray[np.float64]) -> None:
    noise, light, one = 2.0, 600.0, profiles[1]
    moved = [cast((PLACES[1][0], PLACES[1][1] + step)) for step in (-1e-3, 1e-3)]
    slope = light * (moved[1] - moved[0])[PIXELS:] / 0.1  # a pixel is 0.02 of the tangent
    bound = noise / np.sqrt((slope**2).sum())
    draws = np.random.default_rng(5).normal(light * one, noise, (400, 2 * PIXELS))
    spread = SlitImage.for_sensor(DRAWN).extract(draws)[:, 1].std(ddof=1)
    assert 0.9 < spread / bound < 1.25


def test_slits_closer_than_their_light_is_wide_are_fitted_together() -> None:
    slits = tuple((place, 0.0, 0.15) for place in (-0.64, -0.32, 0.32, 0.64))
    drawn = SensorGeometry(**{**vars(DRAWN), "slits": slits, "pixel_pitch_mm": 0.1})
    fit = SlitImage.for_sensor(drawn)
    x = np.arange(PIXELS) - (PIXELS - 1) / 2
    displaced = np.array([[1.3, -2.6], [0.0, 4.05]])
    lines = [
        sum(np.clip(1.25 - np.abs(x - slit[0] / 0.1 - shift), 0.0, 1.0) for slit in slits)
        for shift in displaced.ravel()
    ]
    found = fit.extract(np.array(lines).reshape(2, -1)) - (PIXELS - 1) / 2
    assert np.abs(found - displaced).max() < 0.03


def test_the_height_of_pixels_behind_a_slanted_slit_need_not_be_known() -> None:
    slits = ((-0.9, 45.0, 0.2), (0.9, 0.0, 0.2))
    drawn = SensorGeometry(**{**vars(DRAWN), "slits": slits, "line_axes": ("y",)})
    x, middle = np.arange(PIXELS) - (PIXELS - 1) / 2, (PIXELS - 1) / 2
    fine = np.linspace(-0.5, 0.5, 201)
    for height in (2.0, 5.0):  # of the pixels, which the slant turns into as much blur
        along, across = 1.35, -2.2
        slanted = np.abs(x[:, None] + fine * height - (-18.0 + along + across))[..., None]
        light = np.clip(0.2 / PITCH / np.sqrt(2) + 0.5 - slanted, 0.0, 1.0).mean(axis=(1, 2))
        light += np.clip(2.5 - np.abs(x - 18.0 - along), 0.0, 1.0)
        found = SlitImage.for_sensor(drawn).extract(light[None]) - middle
        assert np.abs(found - [[across, along]]).max() < 0.03


def test_slits_of_one_slant_that_differ_in_width_are_refused() -> None:
    slits = ((-0.5, 0.0, 0.2), (0.5, 0.0, 0.15))  # one image cannot stand for both
    with pytest.raises(UnsuitableDesignError, match="equally wide"):
        SlitImage.for_sensor(SensorGeometry(**{**vars(DRAWN), "slits": slits}))
