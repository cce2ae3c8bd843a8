"""Light from the Earth: tens of degrees on bare photodiodes, next to nothing behind a pinhole."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from shadows import shadows

from algorithms.extractors.frames.centroid import BasicCentroid, ThresholdedCentroid
from benchmark import datasets
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.sensors.frames import FrameSensor
from benchmark.sweeps.albedo_influence import (
    Influence,
    Patches,
    aperture_earthlight,
    influence,
    lit_patches,
    maximum_currents,
    on_aperture,
    on_balance,
    on_cube,
)


def cmos() -> FrameSensor:
    sensor = datasets.get("cmos-single-aperture").condition("nominal").sensor
    mask = Mask((Aperture("round", 0.2, 0.2),), 0.01)
    camera = replace(sensor.camera, mask=mask, focal_length_mm=1.2)
    return shadows(sensor, camera=camera, pitch_mm=0.012)


def test_patches_light_a_face_as_the_face_sensors_earth_does() -> None:
    """Two quadratures, one integral; and the closed form of a fully lit disc straight below."""
    earth = Earth()
    rng = np.random.default_rng(6)
    sun = np.array([0.48, 0.6, 0.64])
    nadir = np.array([-0.8, 0.0, -0.6])
    normals = rng.normal(size=(20, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    patches = lit_patches(earth, sun, nadir)
    seen = np.maximum(patches.directions @ normals.T, 0.0)
    found = patches.light @ seen
    expected = earth.response(sun[None], nadir[None], normals, "cosine")[0]
    assert found == pytest.approx(expected, abs=2e-3 * expected.max())


def test_one_patch_throws_one_image_of_the_aperture() -> None:
    sensor = cmos()
    thin = replace(
        sensor,
        camera=replace(sensor.camera, mask=replace(sensor.camera.mask, thickness_mm=0.0)),
    )
    direction = np.array([[0.1, -0.05, math.sqrt(1 - 0.0125)]])
    spot = thin.spot_px(direction)[0]
    origin = np.rint(spot).astype(np.int64) - 32
    flux = aperture_earthlight(thin, Patches(direction, np.array([0.02])), origin)
    head = thin.camera.assembly.to_head(direction)
    area = math.pi * 0.1**2 / thin.detector.pitch_mm**2
    assert flux.sum() == pytest.approx(0.02 * head[0, 2] * area, rel=1e-9)
    x = np.arange(64) + origin[0]
    y = np.arange(64) + origin[1]
    centre = [(flux.sum(axis=0) @ x) / flux.sum(), (flux.sum(axis=1) @ y) / flux.sum()]
    assert centre == pytest.approx(spot, abs=0.02)  # pixels average over their area


def test_earthlight_is_what_each_pixel_sees_through_the_hole() -> None:
    """Brute force, traced from the pixel outwards: the share of sky in the hole, Earth or not."""
    sensor = cmos()
    camera = replace(
        sensor.camera,
        mask=replace(sensor.camera.mask, thickness_mm=0.0),
        assembly=type(sensor.camera.assembly)(),
    )
    thin = replace(sensor, camera=camera)
    # the limb of a well lit Earth runs through the window
    earth, sun = Earth(), np.array([-0.8, 0.0, 0.6])
    nadir = np.array([math.sin(math.radians(60)), 0.0, math.cos(math.radians(60))])
    origin = np.array([256, 224])
    flux = aperture_earthlight(thin, lit_patches(earth, sun, nadir, 256, 768), origin)
    rng = np.random.default_rng(7)
    radius = 0.1 * np.sqrt(rng.random(20_000))
    turn = 2 * math.pi * rng.random(20_000)
    hole = np.column_stack([radius * np.cos(turn), radius * np.sin(turn)])
    centre_px = np.array(thin.detector.centre_px)
    reach = earth.radius_km / (earth.radius_km + earth.altitude_km)
    traced, drawn = [], []
    for column, row in [(5, 32), (20, 10), (40, 50), (60, 32)]:
        pixel = (origin + np.array([column, row]) - centre_px) * thin.detector.pitch_mm
        # the detector's axes are flipped: light falling at +X comes from +x
        sight = np.column_stack([pixel - hole, np.full(20_000, camera.focal_length_mm)])
        distance2 = np.sum(sight**2, axis=1)
        sight /= np.sqrt(distance2)[:, None]
        along = sight @ nadir
        hits = along > math.sqrt(1 - reach**2)
        length = along - np.sqrt(np.maximum(along**2 - 1 + reach**2, 0.0))
        ground = (length[:, None] * sight - nadir) / reach
        radiance = np.where(hits, 0.3 / math.pi * np.maximum(ground @ sun, 0.0), 0.0)
        # from pixel and hole both facing z: radiance cos^2 / distance^2 dA
        traced.append(math.pi * 0.1**2 * np.mean(radiance * sight[:, 2] ** 2 / distance2))
        drawn.append(flux[row, column])
    assert max(traced) > 5e-4
    assert drawn == pytest.approx(traced, abs=0.03 * max(traced))


def test_an_influence_is_of_what_moved_and_has_a_bound() -> None:
    moved, bound = np.array([3.0, 4.0, np.nan, 0.2]), np.array([1.0, 2.0, 1.0, np.inf])
    found = Influence(moved, bound)
    assert found.worst_deg == 4.0
    assert found.rms_deg == pytest.approx(np.sqrt((9.0 + 16.0 + 0.04) / 3.0))
    assert found.rms_over_bound == pytest.approx(np.sqrt(25.0 / 5.0))
    assert Influence(moved, 20.0 * bound).share_above_a_tenth == 0.5  # 3 of 20, 4 of 40


def test_the_larger_current_of_each_pair_of_faces_is_a_component_of_the_sun() -> None:
    sun = np.array([[0.6, 0.0, 0.8], [-0.48, 0.64, -0.6]])
    currents = np.stack([np.maximum(sign * sun, 0.0) for sign in (1.0, -1.0)], axis=2)
    np.testing.assert_allclose(maximum_currents(7.0 * currents.reshape(2, 6)), sun, atol=1e-15)


def test_a_few_samples_are_moved_as_many_are() -> None:
    """By some degrees on a cube, less behind an opening, not above a third of a peak."""
    cube, balance = on_cube(samples=24), influence("qpd-single-aperture", 24)
    assert len(cube.moved_deg) == len(balance.moved_deg) == 24
    assert 2.0 < cube.rms_deg < 6.0
    assert cube.rms_over_bound > 10
    assert 0.2 < balance.rms_deg < 1.5
    assert 4.0 < balance.rms_over_bound < 100.0
    assert on_aperture(samples=3, extractor=ThresholdedCentroid(threshold=0.3)).worst_deg == 0.0
    plain = on_aperture(samples=3, extractor=BasicCentroid())
    assert 0.0 < plain.worst_deg < 0.01
    with pytest.raises(TypeError, match="pd-code-dial has 18 currents, no balance"):
        on_balance("pd-code-dial")
    with pytest.raises(TypeError, match="pd-orbit has no condition 'albedo'"):
        on_balance("pd-orbit")
    with pytest.raises(TypeError, match="ccd-slit has no pixel array behind one aperture"):
        influence("ccd-slit")


@pytest.mark.slow
def test_albedo_moves_the_cubes_estimate_by_up_to_some_tens_of_degrees() -> None:
    """Soken2023 reports up to 20 deg; here 17 deg at worst, 3.7 deg root mean square."""
    influence = on_cube()
    assert 10 < influence.worst_deg < 40
    assert influence.worst_deg == pytest.approx(16.6, abs=0.1)
    assert influence.rms_deg == pytest.approx(3.7, abs=0.05)
    assert influence.rms_over_bound > 10


@pytest.mark.slow
def test_albedo_hardly_moves_a_thresholded_centroid() -> None:
    """Not at all above 30 % of the peak; above the dark level, in 3 of 100 frames by a little."""
    above_peaks = on_aperture(samples=100, extractor=ThresholdedCentroid(threshold=0.3))
    assert above_peaks.worst_deg == 0.0
    influence = on_aperture(samples=100)
    assert influence.share_above_a_tenth < 0.1
    assert influence.rms_over_bound < 0.1


@pytest.mark.slow
def test_albedo_moves_a_plain_centroid_by_about_the_bound_where_earth_is_in_the_window() -> None:
    """Reported, not wished away: without a threshold every lit pixel counts."""
    influence = on_aperture(samples=100, extractor=BasicCentroid())
    assert 0.0 < influence.worst_deg < 0.01
    assert influence.rms_over_bound < 2.0
    assert influence.share_above_a_tenth < 0.2


@pytest.mark.slow
def test_albedo_moves_the_balance_of_a_quadrant_sensor_by_many_times_its_bound() -> None:
    result = influence("qpd-single-aperture", 200)
    assert 0.4 < result.rms_deg < 1.0
    assert result.worst_deg > 1.5
    assert result.rms_over_bound > 10
    with pytest.raises(TypeError, match="pd-code-dial has 18 currents, no balance"):
        on_balance("pd-code-dial")
    with pytest.raises(TypeError, match="pd-orbit has no condition 'albedo'"):
        on_balance("pd-orbit")
