"""Glass, thick masks and the Sun's disc taken out: rays traced here are found again."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.angles import separation_deg
from algorithms.compensations.environment.solar_disc import SolarDiscBias
from algorithms.compensations.interference.shadow import MaskShadow
from algorithms.compensations.optics.refraction import Refraction
from algorithms.extractors.frames.centroid import BasicCentroid
from algorithms.models.non_physical.polynomial import SurfacePolynomial
from algorithms.pipeline import Pipeline

UP = [[0.0, 0.0, 1.0]]
LAYERS = st.lists(st.tuples(st.floats(0.05, 0.6), st.floats(1.0, 3.0)), max_size=3)


def traced(tangents, gap_mm, layers):
    """Snell's law, layer by layer, in the plane of incidence: where rays (N, 2) fall, mm."""
    across = np.hypot(*tangents.T)
    theta = np.arctan(across)
    fallen = gap_mm * np.tan(theta)
    for thickness, index in layers:
        fallen = fallen + thickness * np.tan(np.arcsin(np.sin(theta) / index))
    return tangents * (fallen / np.where(across > 0, across, 1.0))[:, None]


@settings(deadline=None, derandomize=True, max_examples=60)
@given(layers=LAYERS, gap=st.floats(0.01, 3.0), seed=st.integers(0, 99))
def test_rays_through_any_plates_are_straightened(layers, gap, seed):
    angles = np.random.default_rng(seed).uniform(-75, 75, (40, 2))
    tangents = np.tan(np.radians(angles))
    height = gap + sum(thickness for thickness, _ in layers)
    stage = Refraction(height, 0.01, (120.0, 80.0), tuple(layers))
    spots = traced(tangents, gap, layers) / 0.01 + (120.0, 80.0)
    found = stage.fit(spots[:1], UP).transform(spots)
    np.testing.assert_allclose(found, tangents * height / 0.01 + (120.0, 80.0), rtol=1e-9)


def test_glass_that_fills_the_distance_ends_where_rays_end():
    """The flattest ray within glass of index n is at arcsin(1/n): nothing falls farther out."""
    stage = Refraction(1.0, 1.0, layers=((1.0, 1.5),))
    limit = np.tan(np.arcsin(1 / 1.5))
    spots = np.array([[0.0, 0.0], [0.9 * limit, 0.0], [1.01 * limit, 0.0]])
    found = stage.fit(spots, np.repeat(UP, 3, axis=0)).transform(spots)
    assert np.isnan(found).any(axis=1).tolist() == [False, False, True]
    assert found[0].tolist() == [0.0, 0.0]
    inside = np.arcsin(1.5 * np.sin(np.arctan(0.9 * limit)))
    assert found[1, 0] == pytest.approx(np.tan(inside), rel=1e-9)


def test_optical_and_polynomial_is_one_chain(geometry, field):
    """You2011: compensation, then a polynomial for what is left, here a turn in the plane."""
    layers = ((0.7, 1.5),)
    tangents = field[:, :2] / field[:, 2:]
    c, s = np.cos(0.03), np.sin(0.03)
    turned = traced(tangents, 1.3, layers) @ np.array([[c, s], [-s, c]])
    spots = turned / geometry.pixel_pitch_mm + (203.0, 148.0)
    glass = Refraction(2.0, geometry.pixel_pitch_mm, (203.0, 148.0), layers)
    chain = Pipeline(BasicCentroid(), SurfacePolynomial(degree=1, target="tangent"), (glass,))
    assert chain.name == "optical + polynomial-2d"
    chain.fit_features(spots, field)
    assert separation_deg(chain.predict_features(spots), field).max() < 1e-6
    alone = Pipeline(BasicCentroid(), SurfacePolynomial(degree=1, target="tangent"))
    alone.fit_features(spots, field)
    assert separation_deg(alone.predict_features(spots), field).max() > 0.5


def overlap_middle(thickness, height, diameter, theta_deg, phi_deg):
    """Centroid of the lit lens by counting points: both projected discs hold them."""
    t = np.tan(np.radians(theta_deg))
    way = np.array([np.cos(np.radians(phi_deg)), np.sin(np.radians(phi_deg))])
    upper, lower = (thickness + height) * t * way, height * t * way
    steps = np.linspace(-1.5 * diameter, 1.5 * diameter, 801)
    points = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2) + (upper + lower) / 2
    lit = np.hypot(*(points - upper).T) < diameter / 2
    lit &= np.hypot(*(points - lower).T) < diameter / 2
    return points[lit].mean(axis=0)


@pytest.mark.parametrize(("theta", "phi"), [(10, 0), (40, 25), (60, 200)])
def test_the_middle_of_a_thick_masks_light_is_that_of_a_thin_one(theta, phi):
    thickness, height, diameter = 0.1, 1.5, 0.4
    middle = overlap_middle(thickness, height, diameter, theta, phi)
    stage = MaskShadow(height, 1.0, thickness, diameter)
    found = stage.fit([middle], UP).transform([middle])[0]
    expected = height * np.tan(np.radians(theta))
    assert np.hypot(*found) == pytest.approx(expected, abs=2e-3)
    off = np.degrees(np.arctan2(*found[::-1])) - phi
    assert abs((off + 180) % 360 - 180) < 0.1


def test_nothing_passes_a_mask_thicker_than_its_hole_at_that_angle():
    stage = MaskShadow(1.5, 1.0, thickness_mm=0.2, aperture_mm=0.4)  # ends at tan(theta) = 2
    spots = np.array([[1.6 * 1.99, 0.0], [1.6 * 2.01, 0.0]])
    found = stage.fit(spots, np.repeat(UP, 2, axis=0)).transform(spots)
    assert np.isnan(found).any(axis=1).tolist() == [False, True]


@settings(deadline=None, derandomize=True, max_examples=40)
@given(theta=st.floats(0.0, 70.0), phi=st.floats(0, 360), disc=st.floats(0.1, 3.0))
def test_the_outlines_middle_is_moved_to_the_suns(theta, phi, disc):
    limbs = np.tan(np.radians([theta - disc / 2, theta + disc / 2]))
    way = np.array([np.cos(np.radians(phi)), np.sin(np.radians(phi))])
    stage = SolarDiscBias(1.0, 1.0, disc_deg=disc)
    found = stage.fit([limbs.mean() * way], UP).transform([limbs.mean() * way])[0]
    np.testing.assert_allclose(found, np.tan(np.radians(theta)) * way, atol=1e-6)


def test_a_centroid_by_light_is_not_moved_by_the_disc():
    """Rays pass in proportion to their cosine: the mean of their tangents is the centre's own."""
    theta, disc = 60.0, np.radians(2.0)
    rng = np.random.default_rng(3)
    radius = disc / 2 * np.sqrt(rng.uniform(0, 1, 400_000))
    turn = rng.uniform(0, 2 * np.pi, radius.size)
    axis = np.array([np.sin(np.radians(theta)), 0.0, np.cos(np.radians(theta))])
    first, second = np.array([axis[2], 0.0, -axis[0]]), np.array([0.0, 1.0, 0.0])
    rays = (
        np.cos(radius)[:, None] * axis
        + (np.sin(radius) * np.cos(turn))[:, None] * first
        + (np.sin(radius) * np.sin(turn))[:, None] * second
    )
    mean = np.average(rays[:, 0] / rays[:, 2], weights=rays[:, 2])
    outline = np.tan(np.radians([theta - 1.0, theta + 1.0])).mean()
    assert abs(mean - np.tan(np.radians(theta))) < 2e-4
    assert outline - np.tan(np.radians(theta)) > 2e-3
