"""Thick masks: rays of the Sun's disc, counted one by one here, are turned into its direction."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.angles import separation_deg
from algorithms.chain import Chain
from algorithms.compensations.interference.shadow import MaskShadow
from algorithms.contract import FeatureKind, SensorGeometry
from algorithms.models.geometric.standard_projection import StandardProjection

THICK = SensorGeometry(
    focal_length_mm=1.2,
    pixel_pitch_mm=0.005,
    centre_px=(250.0, 240.0),
    aperture_width_mm=0.3,
    mask_thickness_mm=0.1,
)
ANGLES = [(0.0, 0.0), (20.0, 70.0), (45.0, 200.0), (60.0, 310.0)]


def direction(theta_deg, phi_deg):
    """Unit vector (3,) at an angle from the boresight and an azimuth."""
    theta, phi = np.radians([theta_deg, phi_deg])
    return np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])


def seen(sun):
    """Mean place (1, 2), px, of the rays from the Sun's disc that pass both rims of the hole.

    The drawing's distance ends in the mask's middle. A ray counts by the light that it brings to
    the plane, in proportion to its cosine.
    """
    thickness, diameter = THICK.mask_thickness_mm, THICK.aperture_width_mm
    below = THICK.focal_length_mm - thickness / 2.0
    across = np.linalg.svd(sun[None])[2][1:]
    steps = (np.arange(9) - 4.0) / 4.5
    disc = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    disc = disc[np.hypot(*disc.T) < 1.0] * np.radians(0.533 / 2.0)
    rays = sun + disc @ across
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    steps = (np.arange(300) + 0.5) / 300.0 - 0.5
    lower = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2) * diameter
    lower = lower[np.hypot(*lower.T) < diameter / 2.0]
    light, place = 0.0, np.zeros(2)
    for ray in rays:
        slope = (
            ray[:2] / ray[2]
        )  # towards the Sun, so that the ray came through the upper rim there
        upper = lower + slope * thickness
        passed = lower[np.hypot(*upper.T) < diameter / 2.0]
        light += ray[2] * len(passed)
        place += ray[2] * (passed - slope * below).sum(axis=0)
    # features are counted towards the Sun, and light falls away from it
    return (-place / light / THICK.pixel_pitch_mm + THICK.centre_px)[None]


@pytest.mark.parametrize(("theta", "phi"), ANGLES)
def test_rays_through_both_rims_give_the_suns_direction(theta, phi):
    sun = direction(theta, phi)
    model = Chain((MaskShadow,), StandardProjection).for_sensor(THICK, FeatureKind.SPOT)
    spot = seen(sun)
    found = model.fit(spot, sun[None]).predict(spot)
    assert separation_deg(found, sun[None])[0] < 0.005


@pytest.mark.parametrize(("theta", "phi"), ANGLES[1:])
def test_counted_from_the_lower_face_the_mask_must_be_compensated(theta, phi):
    """As eq:shadcomp draws it: h ends at the lower face, and so does the model's."""
    sun = direction(theta, phi)
    spot, h, pitch = seen(sun), 1.15, 0.005
    alone = StandardProjection(h, pitch, (250.0, 240.0)).fit(spot, sun[None])
    mask = MaskShadow(h, pitch, 0.1, 0.3, (250.0, 240.0)).fit(spot, sun[None])
    assert separation_deg(alone.predict(mask.transform(spot)), sun[None])[0] < 0.005
    assert separation_deg(alone.predict(spot), sun[None])[0] > 0.5
