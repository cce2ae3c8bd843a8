"""Sensors where light misses them, nothing disturbs them, or nothing like that can be built."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scenes import nominal
from scipy.special import fresnel

from benchmark import datasets
from benchmark.simulator.light.stray_slope import UnevenScene
from benchmark.simulator.light.sun_disc import SolarDisc, from_angles
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.diffraction import SUNLIT_SILICON, round_intensity, round_skew
from benchmark.simulator.optics.flare import Flare
from benchmark.simulator.optics.ghosts import Ghost
from benchmark.simulator.optics.plates import CoverGlass, Plate
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.optics.rectangle_patterns import RectanglePattern
from benchmark.simulator.readout.detectors import CurrentReadout
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.readout.pixel_errors import PixelErrors
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.lit_pixels import LitPixels
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor
from benchmark.simulator.sensors.position_sensitive import LateralEffect, PositionSensor

POINT = SolarDisc(diameter_deg=0.0)


def lit_by(*angles: tuple[float, float]) -> Scene:
    alpha, beta = np.array(angles, dtype=float).T
    return Scene(from_angles(alpha, beta), np.ones(len(alpha)), np.full(len(alpha), 0.002))


def shadows() -> MultiSpotSensor:
    """One hole over 24 by 20 pixels without errors, in geometric light."""
    wide = nominal("cmos-multi-aperture")
    detector = replace(
        wide.detector, columns=24, rows=20, prnu=0.05, tunnel=0.0, errors=PixelErrors()
    )
    mask = Mask((Aperture("round", 0.03, 0.03),))
    camera = Camera(0.4, mask, POINT, CoverGlass(), Assembly())
    return MultiSpotSensor(camera, detector, spectrum=None)


def test_a_scene_of_uneven_light_that_does_not_slope_has_the_light_of_an_even_one() -> None:
    sensor, scene = shadows(), lit_by((0.0, 3.0), (5.0, -8.0))
    pattern = sensor.fixed_pattern("unit")
    uneven = UnevenScene.of(scene, np.full((2, 2), 1e-3))
    plain, sloping, flat = (
        LitPixels(sensor, seen, pattern).expected(seen, pattern)
        for seen in (scene, uneven, replace(uneven, slope=None))
    )
    np.testing.assert_array_equal(flat, plain)
    assert np.abs(sloping - plain).max() > 0.1, "digital numbers"


def test_the_boxes_of_a_shadow_hold_its_light() -> None:
    sensor, scene = shadows(), lit_by((0.0, 3.0), (5.0, -8.0), (80.0, 0.0))
    pattern = sensor.fixed_pattern("unit")
    boxes, light = sensor.boxes(scene, pattern), sensor.lit(scene, pattern)
    for frame, (left, right, top, bottom) in zip(light, boxes[:, 0].tolist(), strict=True):
        inside = frame[top:bottom, left:right].copy() if right > left else np.zeros(0)
        assert inside.sum() == pytest.approx(frame.sum())
    assert light[:2].reshape(2, -1).any(axis=1).all()
    assert not light[2].any(), "its light misses the detector"


def test_an_image_beside_the_detector_leaves_it_dark() -> None:
    camera = nominal("ccd-lens").camera
    camera = replace(camera, flare=Flare(), sun=SolarDisc(rings=(4,)), assembly=Assembly())
    sun = from_angles(np.array([0.0, 75.0, 0.0]), np.array([0.0, 0.0, 75.0]))
    here, *beside = camera.shares(sun)
    assert here.sum() == pytest.approx(1.0)
    assert not np.any(beside)


def test_a_ghost_of_the_cover_glass_falls_beside_its_spot_whole() -> None:
    """The light goes through the glass twice more: Snell's law says how far that takes it."""
    glass = CoverGlass((Plate(0.5, 1.5),))
    camera = Camera(3.0, Mask((Aperture("round", 0.4, 0.4),)), POINT, glass)
    readout = CurrentReadout(100.0, 0.0, 0.0, full_scale_ua=200.0, bits=24)
    sensor = PositionSensor(camera, LateralEffect(8.0), readout)
    scene = lit_by((0.0, 0.0), (20.0, 0.0), (0.0, -35.0))
    direct = sensor.lit(scene)
    both = replace(sensor, ghost=Ghost(0.5, 0.04, "glass")).lit(scene)
    ghost = both - direct
    np.testing.assert_allclose(ghost.sum(axis=1), 0.02 * direct.sum(axis=1))

    def place_mm(currents: np.ndarray) -> np.ndarray:
        q1, q2, q3, q4 = currents.T
        sums = np.column_stack([q2 + q3 - q1 - q4, q1 + q2 - q3 - q4])
        return np.asarray(4.0 * sums / currents.sum(axis=1)[:, None])

    inside = [math.asin(math.sin(math.radians(angle)) / 1.5) for angle in (0.0, 20.0, 35.0)]
    further = np.linalg.norm(place_mm(ghost) - place_mm(direct), axis=1)
    assert further == pytest.approx([2.0 * 0.5 * math.tan(angle) for angle in inside], abs=1e-9)


def test_noise_of_columns_is_added_to_lines_that_bloom() -> None:
    preset = datasets.get("ccd-slit")
    saturated: Any = preset.setups["saturated"].sensor
    errors = PixelErrors(column_noise_e=500.0)
    noisy = replace(saturated, detector=replace(saturated.detector, errors=errors))
    quiet = replace(saturated, detector=replace(saturated.detector, errors=PixelErrors()))
    dark = replace(lit_by((14.0, -33.0)), irradiance=np.zeros(1), stray=np.full(1, 0.2))
    pattern = quiet.fixed_pattern("unit")
    one, other = (
        sensor.observe(dark, pattern, NoiseStreams.named("test")).astype(float)
        for sensor in (noisy, quiet)
    )
    added = (one - other) * noisy.detector.gain_e_per_dn
    assert added.std() == pytest.approx(500.0, rel=0.1)


def test_rims_a_whole_hole_apart_let_no_light_through() -> None:
    places, numbers = np.linspace(-3.0, 3.0, 7), (1.0, 1.0)
    light, skew = round_skew(places, places, numbers, (0.1, 0.1, 0.1, 0.1), apart=2.0)
    assert light.shape == skew.shape == (7, 7)
    assert not light.any()
    assert not skew.any()
    assert not round_intensity(places, places, numbers, apart=2.0).any()


FOIL = RectanglePattern(
    half_mm=(0.05, 1.0),
    thickness_mm=0.1,
    height_mm=1.0,
    glass=CoverGlass(),
    sun=SolarDisc(),
    spectrum=SUNLIT_SILICON,
    pitch_mm=0.01,
    reach_mm=1.0,
    widest_deg=70.0,
)


def test_a_foil_that_shades_its_whole_slit_leaves_no_light_at_the_ends() -> None:
    """60 deg off along x, a foil 0.1 mm thick shades 0.17 mm, and the slit is 0.1 mm wide."""
    oblique = from_angles(np.array([5.0]), np.array([60.0]))
    assert oblique[0, 0] > oblique[0, 2] > 0.0, "off along x"
    end = FOIL._end(oblique)
    assert end.shape[0] == 1
    assert not end.any()


@pytest.mark.parametrize("height_mm", [0.25, 1.0, 4.0])
def test_a_foil_softens_an_edge_by_one_length_wherever_the_light_is_caught(
    height_mm: float,
) -> None:
    """By what the light behind its upper rim lacks, in Fresnel's unit for the foil's thickness."""
    places = np.arange(0.0, 100.0, 1e-3)
    sine, cosine = fresnel(places)
    lit = (1 - 1j) / 2 * (cosine + 0.5 + 1j * (sine + 0.5))
    lacking = 1e-3 * float(np.sum(1 - lit).imag)
    softness = replace(FOIL, height_mm=height_mm).softness
    assert softness * math.sqrt(height_mm / 0.1) == pytest.approx(lacking, rel=0.01)
