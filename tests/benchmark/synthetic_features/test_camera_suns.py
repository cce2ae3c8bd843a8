"""Black Suns, blooming lines and circles found on rendered frames, all over the field."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.angles import sun_from_angles
from algorithms.extractors.events.centroid import EventCentroid
from algorithms.extractors.frames.cameras.black_sun import BlackSunCentroid
from algorithms.extractors.frames.cameras.blooming_cameras import (
    LineCamera,
    sun_from_blooming_lines,
)
from algorithms.extractors.frames.cameras.hough import HoughCircle, HoughLines
from benchmark.datasets import get
from benchmark.datasets.preview_overlay import true_places
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene

CONDITIONS = ("nominal", "high-noise", "glare", "saturation-clouds", "dead-pixels")
FRAMES = 30


def errors_px(dataset, condition, extractor):
    preset = get(dataset)
    samples = preset.generate(condition, "test", FRAMES)
    found = extractor.for_sensor(preset.geometry_for(condition)).extract(samples.observations)
    return found - true_places(preset, condition, samples)


@pytest.mark.parametrize("condition", CONDITIONS)
@pytest.mark.parametrize("extractor", [BlackSunCentroid, HoughCircle])
def test_the_black_sun_is_found_in_every_frame(extractor, condition):
    errors = errors_px("cmos-lens", condition, extractor)
    assert np.hypot(*errors.T).max() < 0.5
    assert np.sqrt(np.mean(errors**2)) < 0.08


@pytest.mark.parametrize("condition", [c for c in CONDITIONS if c != "saturation-clouds"])
def test_the_blooming_sun_is_found_in_every_frame(condition):
    errors = errors_px("ccd-lens", condition, HoughLines)
    assert np.abs(errors[:, 0]).max() < 0.1
    assert np.abs(errors[:, 1]).max() < 0.5


def scene(sun):
    still = np.ones(len(sun)), np.full(len(sun), 0.02), np.zeros((len(sun), 2), dtype=np.int64)
    return Scene(np.asarray(sun), *still, None)


@pytest.mark.parametrize("x_deg", [-19.0, -7.0, 5.0, 19.0])
def test_the_sun_is_found_at_the_border_of_the_field(x_deg):
    """Corners included: the datasets' Suns are drawn at random, these are the extreme ones."""
    for dataset, scale, extractor in (
        ("cmos-lens", 2.0, BlackSunCentroid),
        ("ccd-lens", 1.0, HoughLines),
    ):
        preset = get(dataset)
        angles = [[scale * x_deg, scale * y] for y in (-19.0, 0.5, 19.0)]
        there = scene(sun_from_angles(np.array(angles)))
        sensor = preset.condition("nominal").sensor
        streams = NoiseStreams.named("test", dataset, str(x_deg))
        frames = sensor.observe(there, preset.fixed_pattern("nominal"), streams)
        found = extractor.for_sensor(preset.geometry).extract(frames)
        assert np.hypot(*(found - sensor.camera.image_px(there.sun)).T).max() < 0.3


def test_the_line_is_found_under_clouds_that_cover_the_place_on_it():
    preset = get("ccd-lens")
    samples = preset.generate("saturation-clouds", "test", FRAMES)
    truth = true_places(preset, "saturation-clouds", samples)
    method = HoughLines.for_sensor(preset.geometry)
    lines = method.lines(samples.observations)
    assert np.abs(lines[:, 0] - truth[:, 0]).max() < 0.6
    found = method.extract(samples.observations)
    assert np.isnan(found).any(axis=1).mean() > 0.5  # it says so, most of the time


def test_two_cameras_find_the_sun_under_clouds():
    """Two cameras, one turned by a quarter: each gives a line, and the lines meet in the Sun."""
    preset = get("ccd-lens")
    sensor = preset.condition("saturation-clouds").sensor
    rng = np.random.default_rng(3)
    sun = sun_from_angles(rng.uniform(-17.0, 17.0, (20, 2)))
    quarter = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    camera = sensor.camera
    built = camera.assembly.matrix()
    lines, cameras = [], []
    for name, turn in (("one", np.eye(3)), ("two", quarter)):
        streams = NoiseStreams.named("test", "two cameras", name)
        pattern = sensor.fixed_pattern("test", name)
        frames = sensor.observe(scene(sun @ turn.T), pattern, streams)
        lines.append(HoughLines.for_sensor(preset.geometry).lines(frames))
        cameras.append(
            LineCamera(
                camera.built_focal_length_mm,
                camera.detector.pitch_mm,
                tuple(camera.axis_px),
                (camera.lens.k1, camera.lens.k2),
                tuple(map(tuple, turn.T @ built.T)),
            )
        )
    found = sun_from_blooming_lines(lines, cameras)
    error_deg = np.degrees(np.linalg.norm(np.cross(found, sun), axis=1))
    assert np.median(error_deg) < 0.03
    assert error_deg.max() < 0.2


@pytest.mark.slow
@pytest.mark.parametrize("dataset", ["event-l-slit", "event-single-aperture"])
def test_events_place_lines_and_spots_to_a_fraction_of_a_pixel(dataset):
    preset = get(dataset)
    samples = preset.generate("nominal", "test", 100)
    sensor = preset.condition("nominal").sensor
    truth = (
        sensor.camera.spot_mm(samples.sun) / sensor.detector.pitch_mm + sensor.detector.centre_px
    )
    found = EventCentroid.for_sensor(preset.geometry).extract(samples.observations)
    assert np.sqrt(np.mean((found - truth) ** 2)) < 0.05
    hot = samples.observations.copy()
    hot[:, 1:] = hot[:, :-1]
    hot[:, 0] = (3.0, 50.0, 0.3)  # a hot pixel that fires before all others
    # The last event, of the dimmest pixel, has to make room. What that costs, not how far it moves
    # what is found: without it the brightest pixels of a soft spot are now and then taken for hot.
    away = np.abs(EventCentroid.for_sensor(preset.geometry).extract(hot) - truth)
    assert (away - np.abs(found - truth)).max() < 0.1
