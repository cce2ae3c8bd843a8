"""The outline of a thick pinhole's spot, against rays from the whole disc through both rims."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.angles import separation_deg, sun_from_angles
from algorithms.compensations.environment.solar_disc import SolarDiscBias
from algorithms.compensations.interference.pinhole_shadow import PinholeShadow
from algorithms.contract import (
    FeatureKind,
    SensorGeometry,
    UnsuitableDesignError,
    UnusableDataError,
)
from algorithms.discovery import discover_chains

DISC_DEG = 0.533
LOWER, THICK, WIDE = 0.725, 0.05, 0.1
MASK = PinholeShadow(LOWER + THICK / 2, 0.01, THICK, WIDE, (30.0, 20.0))
ANGLES = np.stack(np.meshgrid([-45, -30, -15, 0, 15, 30, 45], [-45, -20, 0, 20, 45]), -1)
SUN = sun_from_angles(ANGLES.reshape(-1, 2).astype(np.float64))


def outline_middle(theta_deg, disc_deg=DISC_DEG):
    """Middle, mm, of all places in the plane of incidence that some ray of the disc reaches."""
    rays = np.radians(theta_deg + np.linspace(-disc_deg / 2, disc_deg / 2, 4001))
    rims = np.stack([LOWER * np.tan(rays), (LOWER + THICK) * np.tan(rays)])
    near, far = rims.max(axis=0) - WIDE / 2, rims.min(axis=0) + WIDE / 2
    passing = far > near
    return (near[passing].min() + far[passing].max()) / 2


@pytest.mark.parametrize("theta_deg", [0.0, 0.1, 0.2, 0.3, 1.0, 10.0, 30.0, 45.0, 58.0])
def test_the_outline_is_that_of_every_ray_through_both_rims(theta_deg):
    tangent = np.array([[np.tan(np.radians(theta_deg)), 0.0]])
    found = (MASK.spots(tangent, share=1.0)[0, 0] - 30.0) * 0.01
    assert found == pytest.approx(outline_middle(theta_deg), abs=1e-9)


def test_outlines_are_brought_to_the_suns_centre():
    tangents = SUN[:, :2] / SUN[:, 2:]
    radial = np.hypot(*tangents.T)
    seen = [outline_middle(float(t)) for t in np.degrees(np.arctan(radial))]
    spots = tangents * (np.array(seen) / np.where(radial > 0, radial, 1.0))[:, None] / 0.01
    spots += (30.0, 20.0)
    mask = MASK.fit(spots, SUN)
    assert mask.share_ == pytest.approx(1.0, abs=1e-6)
    disc = SolarDiscBias(LOWER + THICK / 2, 0.01, (30.0, 20.0), DISC_DEG).fit(spots, SUN)
    found = disc.transform(mask.transform(spots))
    expected = tangents * (LOWER + THICK / 2) / 0.01 + (30.0, 20.0)
    np.testing.assert_allclose(found, expected, atol=1e-7)


def test_the_whole_chain_finds_the_sun_where_parts_of_it_do_not():
    design = SensorGeometry(
        focal_length_mm=LOWER + THICK / 2, pixel_pitch_mm=0.01, centre_px=(30.0, 20.0),
        aperture_width_mm=WIDE, aperture_shape="round", mask_thickness_mm=THICK,
    )  # fmt: skip
    spots = MASK.spots(SUN[:, :2] / SUN[:, 2:], share=1.0)
    off = {}
    for name in ("spm", "solar-disc + spm", "pinhole-shadow + solar-disc + spm"):
        made = discover_chains()[name].for_sensor(design, FeatureKind.SPOT)
        off[name] = float(separation_deg(made.fit(spots, SUN).predict(spots), SUN).max())
    assert off["pinhole-shadow + solar-disc + spm"] < 1e-6
    # t rho / (2 h): the shift of the outline over the focal length
    assert 0.006 < off["solar-disc + spm"] < 0.01
    assert 0.006 < off["spm"] < 0.012


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_the_share_is_learnt_beside_a_turned_and_shifted_head(share):
    turn = np.radians(0.5)
    head = SUN @ np.array(
        [[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]]
    )
    spots = np.add(MASK.spots(head[:, :2] / head[:, 2:], share), (1.5, -0.7))
    assert MASK.fit(spots, SUN).share_ == pytest.approx(share, abs=0.03)


def test_no_light_passes_where_the_rims_part():
    steepest = np.degrees(np.arctan(WIDE / THICK))
    near = np.tan(np.radians([steepest - 0.5, steepest + 0.5]))
    MASK.fit(MASK.spots(SUN[:, :2] / SUN[:, 2:], 0.5), SUN)
    found = MASK.transform(MASK.spots(np.column_stack([near, [0.0, 0.0]]), MASK.share_))
    assert np.isnan(found).any(axis=1).tolist() == [False, True]


def test_a_calibration_about_the_boresight_tells_no_share():
    sun = sun_from_angles(np.random.default_rng(1).uniform(-0.1, 0.1, (40, 2)))
    with pytest.raises(UnusableDataError, match="spread over the field"):
        MASK.fit(MASK.spots(sun[:, :2] / sun[:, 2:], 1.0), sun)


@pytest.mark.parametrize(
    "other",
    [{"aperture_shape": "square"}, {"mask_thickness_mm": 0.0}, {"cover_glass": ((0.2, 1.5),)}],
)
def test_it_is_made_for_bare_thick_round_holes_alone(other):
    design = {
        "focal_length_mm": 0.75, "pixel_pitch_mm": 0.01, "centre_px": (0.0, 0.0),
        "aperture_width_mm": 0.1, "aperture_shape": "round", "mask_thickness_mm": 0.05,
    } | other  # fmt: skip
    with pytest.raises(UnsuitableDesignError, match="round hole"):
        PinholeShadow.for_sensor(SensorGeometry(**design), FeatureKind.SPOT)
