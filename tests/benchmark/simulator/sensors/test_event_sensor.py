"""Time-to-first-spike pixels: times from photocurrents, order, jitter, what the bound counts."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from benchmark import datasets
from benchmark.metrics.bounds import cramer_rao
from benchmark.seeds import generator
from benchmark.simulator.light.sun_disc import SolarDisc, from_angles, tangent_axes
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.diffraction import Spectrum
from benchmark.simulator.readout.detectors import DarkCurrent
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.events import EventSensor, _censored_share

NAMES = ("event-l-slit", "event-single-aperture")


def sensor_of(name: str, condition: str = "nominal") -> EventSensor:
    sensor = datasets.get(name).setups[condition].sensor
    assert isinstance(sensor, EventSensor)
    return sensor


def scene_of(angles: list[tuple[float, float]], light: float = 1.0, stray: float = 0.002) -> Scene:
    alpha, beta = np.array(angles).T
    count = len(alpha)
    return Scene(from_angles(alpha, beta), np.full(count, light), np.full(count, stray))


def perfect(name: str) -> EventSensor:
    """No dark current, no mismatch, a point Sun, everything where the drawing has it.

    Waves so short that they cast shadows, which have the centroids of their outlines.
    """
    sensor = sensor_of(name)
    detector = replace(sensor.detector, threshold_mismatch=0, prnu=0, dark=DarkCurrent(0.0))
    camera = replace(sensor.camera, assembly=Assembly(), sun=SolarDisc(0.0))
    return EventSensor(camera, detector, Spectrum((1e-5,), (1.0,)))


def test_times_are_inversely_proportional_to_the_photocurrent() -> None:
    sensor = perfect("event-l-slit")
    pattern = sensor.fixed_pattern("unit")
    angles = [(11.0, -23.0)]
    once, twice = (
        sensor.expected(scene_of(angles, light, 0.002 * light), pattern) for light in (1.0, 2.0)
    )
    assert once == pytest.approx(2 * twice, rel=1e-12)
    light = sensor.lit(scene_of(angles)).reshape(1, -1) + 0.002
    assert once * light == pytest.approx(sensor.detector.sunlit_us, rel=1e-12)
    # normal incidence, fully lit: the stated time
    assert sensor.expected(scene_of([(0.0, 0.0)], stray=0.0), pattern).min() == pytest.approx(100.0)


@pytest.mark.parametrize(
    ("alpha", "beta"), [(0.0, 0.0), (31.7, -12.9), (-39.0, 39.0), (17.0, 36.0)]
)
def test_the_lines_of_the_l_are_inverted_exactly(alpha: float, beta: float) -> None:
    """Inverse times weigh the rows that only the upright arm crosses, and the like columns."""
    sensor = perfect("event-l-slit")
    geometry = datasets.get("event-l-slit").geometry
    pattern = sensor.fixed_pattern("unit")
    times = sensor.expected(scene_of([(alpha, beta)], stray=0.0), pattern)[0].reshape(64, 64)
    light = 1.0 / times
    assert geometry.slits is not None
    position, _, width = geometry.slits[0]
    found = []
    for other, picture in ((alpha, light), (beta, light.T)):
        # rows beyond the other arm
        edge = position + math.tan(math.radians(other)) + width / 2
        clear = (np.arange(64) - 31.5 - 0.5) * 0.05 > edge
        assert clear.sum() >= 25
        profile = picture[clear].sum(axis=0)
        place = (profile * np.arange(64)).sum() / profile.sum()
        displacement = (place - 31.5) * 0.05 - position
        found.append(math.degrees(math.atan2(displacement, geometry.focal_length_mm)))
    assert found == pytest.approx([beta, alpha], abs=1e-6)


def test_a_spot_of_whole_pixels_is_inverted_exactly() -> None:
    """A square hole, for the centroid of a box of whole pixels is that of its pixels."""
    sensor = perfect("event-l-slit")
    pattern = sensor.fixed_pattern("unit")
    sun = from_angles(np.array([41.3, -8.0]), np.array([-17.2, 49.0]))
    mask = Mask((Aperture("rectangle", 0.2, 0.2),))
    sensor = replace(sensor, camera=replace(sensor.camera, mask=mask))
    scene = Scene(sun, np.ones(2), np.zeros(2))
    weight = 1.0 / sensor.expected(scene, pattern)
    rows, columns = (c.ravel() for c in np.indices((64, 64)))
    place = np.stack([(weight * c).sum(axis=1) / weight.sum(axis=1) for c in (columns, rows)], 1)
    vectors = np.column_stack([(place - 31.5) * 0.05, np.ones(2)])
    vectors /= np.linalg.norm(vectors, axis=1)[:, None]
    assert np.degrees(np.linalg.norm(np.cross(vectors, sun), axis=1)).max() < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_events_are_the_first_pixels_in_the_order_of_their_times(name: str) -> None:
    preset = datasets.get(name)
    for condition in ("nominal", "hot"):
        sensor, pattern = sensor_of(name, condition), preset.fixed_pattern(condition)
        detector = sensor.detector
        scene = preset.scene(condition, "test").part(0, 64)
        events = sensor.observe(scene, pattern, NoiseStreams.named("test", "order"))
        assert events.shape[1:] == (detector.events, 3)
        assert events.dtype == np.float64
        missing = np.isnan(events)
        assert np.array_equal(missing.all(axis=2), missing.any(axis=2))
        gone = missing[:, :, 0]
        assert (gone[:, 1:] >= gone[:, :-1]).all()  # nothing after the first missing one
        times = events[:, :, 2]
        assert (np.diff(times, axis=1)[~gone[:, 1:]] >= 0).all()
        assert np.nanmin(times) > 0
        assert np.nanmax(times) <= detector.timeout_us + detector.clock_us / 2
        ticks = times[~gone] / detector.clock_us
        assert ticks == pytest.approx(np.rint(ticks), abs=1e-6)
        for sample in events[:20]:
            seen = sample[~np.isnan(sample[:, 0]), :2]
            assert (seen >= 0).all()
            assert (seen <= 63).all()
            assert len(np.unique(seen, axis=0)) == len(seen)
    assert not gone.any()  # 80 deg C: dark current alone fires all that are read


def test_no_pixel_that_is_not_read_out_was_earlier() -> None:
    sensor = sensor_of("event-l-slit")
    exact = {"jitter": 0, "latency_us": 0, "threshold_e": 1e15, "service_us": 0.0}
    quiet = replace(sensor, detector=replace(sensor.detector, **exact))
    pattern = quiet.fixed_pattern("unit")
    scene = scene_of([(5.0, 20.0), (-30.0, -30.0)])
    mean = quiet.expected(scene, pattern)
    events = quiet.observe(scene, pattern, NoiseStreams.named("test"))
    for times, sample in zip(mean, events, strict=True):
        read = sample[~np.isnan(sample[:, 0])]
        pixels = (read[:, 1] * 64 + read[:, 0]).astype(int)
        left = np.setdiff1d(np.arange(64 * 64), pixels)
        assert read[:, 2] == pytest.approx(times[pixels], abs=0.05 + 1e-6)
        last = quiet.detector.timeout_us if len(read) < 384 else read[-1, 2]
        assert times[left].min() >= last - 0.05


@pytest.mark.slow
def test_jitter_has_the_stated_spread_and_the_mean_its_time() -> None:
    sensor = sensor_of("event-single-aperture", "high-noise")
    detector = replace(sensor.detector, events=4096, timeout_us=1e9, service_us=0.0)
    sensor = replace(sensor, detector=detector)
    pattern = sensor.fixed_pattern("unit")
    scene = scene_of([(3.0, -14.0)] * 300)
    events = sensor.observe(scene, pattern, NoiseStreams.named("test", "jitter"))
    mean = sensor.expected(scene.part(0, 1), pattern)[0]
    times = np.empty((300, 4096))
    place = (events[:, :, 1] * 64 + events[:, :, 0]).astype(int)
    np.put_along_axis(times, place, events[:, :, 2], axis=1)
    spread = np.sqrt(detector.jitter**2 * mean**2 + mean**2 / 50_000 + 2.0**2 + 0.1**2 / 12)
    ratio = times.std(axis=0, ddof=1) / spread
    assert np.sqrt(np.mean(ratio**2)) == pytest.approx(1.0, abs=0.01)
    bright = mean < 200
    assert bright.sum() > 5
    assert ratio[bright] == pytest.approx(1.0, abs=0.2)
    pull = (times.mean(axis=0) - mean) / (spread / math.sqrt(300))
    assert np.mean(pull) == pytest.approx(0.0, abs=0.1)
    assert np.std(pull) == pytest.approx(1.0, abs=0.06)


def test_a_silent_pixel_is_worth_what_a_censored_gaussian_is() -> None:
    """Variance of the score of a normal mean known only below z, by numerical integration."""
    z = np.array([-5.0, -2.0, -0.5, 0.0, 0.7, 2.5, 5.0])
    share = _censored_share(z)
    for cut, value in zip(z, share, strict=True):
        grid = np.linspace(-12, cut, 200_001)
        fired = np.trapezoid(grid**2 * norm.pdf(grid), grid)
        silent = norm.pdf(cut) ** 2 / norm.sf(cut)
        assert value == pytest.approx(fired + silent, rel=1e-6, abs=1e-12)
    assert _censored_share(np.array([-40.0, 40.0])).tolist() == [0.0, 1.0]
    assert (np.diff(share) > 0).all()


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("loaded", [False, True])
def test_the_bound_is_what_the_events_tell(name: str, loaded: bool) -> None:
    """One scoring step from the truth on real events, silent pixels counted as silent.

    Where nothing waits for the bus it reaches the bound; where pixels queue, it does not come
    below it (400 trials of two angles tell a root mean square to 2.5 %: three of those).
    """
    preset = datasets.get(name)
    sensor, light = sensor_of(name), preset.setups["nominal"].irradiance
    if not loaded:
        sensor = replace(sensor, detector=replace(sensor.detector, service_us=0.0))
    pattern = preset.fixed_pattern("nominal")
    trials = 400
    one = scene_of([(14.0, -21.0)])
    bound = cramer_rao(sensor, one, pattern, light)
    irradiance, stray = light.draw(trials, generator("test", name))
    scene = Scene(np.repeat(one.sun, trials, axis=0), irradiance, np.maximum(stray, 0))
    events = sensor.observe(scene, pattern, NoiseStreams.named("test", "bound", name))
    first, second = tangent_axes(one.sun)

    def times(x: float, y: float, brighter: float = 0.0, hazier: float = 0.0) -> np.ndarray:
        moved = one.sun + x * first + y * second
        there = replace(
            one,
            sun=moved / np.linalg.norm(moved),
            irradiance=one.irradiance + brighter,
            stray=one.stray + hazier,
        )
        return sensor.expected(there, pattern)[0]

    mean, step = times(0, 0), 3e-4
    slopes = np.stack(
        [
            (times(step, 0) - times(-step, 0)) / (2 * step),
            (times(0, step) - times(0, -step)) / (2 * step),
            times(0, 0, light.spread) - mean,
            times(0, 0, 0, light.stray_spread) - mean,
        ],
        axis=1,
    )
    weight = 1 / sensor.variance(mean[None])[0]
    fisher = slopes.T @ (weight[:, None] * slopes) + np.diag([0, 0, 1.0, 1.0])
    deviation = np.sqrt(sensor.detector.variance_us2(mean))
    errors = np.empty((trials, 2))
    for n, sample in enumerate(events):
        read = sample[~np.isnan(sample[:, 0])]
        reset = read[-1, 2] if len(read) == sensor.detector.events else 5000.0
        z = (reset - mean) / deviation
        score = norm.pdf(z) / np.maximum(norm.sf(z), 1e-300) / deviation
        pixels = (read[:, 1] * 64 + read[:, 0]).astype(int)
        score[pixels] = (read[:, 2] - mean[pixels]) / deviation[pixels] ** 2
        errors[n] = np.linalg.solve(fisher, slopes.T @ score)[:2]
    if loaded:
        assert np.degrees(np.sqrt(np.mean(np.sum(errors**2, axis=1)))) > 0.925 * bound.angle_deg[0]
        return
    reached = np.degrees(np.sqrt(np.sum(errors.var(axis=0, ddof=1))))
    assert reached == pytest.approx(bound.angle_deg[0], rel=0.15)


def test_more_events_tell_more_and_batches_do_not_matter() -> None:
    sensor = sensor_of("event-l-slit")
    light = datasets.get("event-l-slit").setups["nominal"].irradiance
    pattern = sensor.fixed_pattern("unit")
    scene = scene_of([(14.0, -21.0), (-30.0, 30.0), (2.0, 2.0)])
    bounds = []
    for count in (128, 256, 384):
        fewer = replace(sensor, detector=replace(sensor.detector, events=count))
        bounds.append(cramer_rao(fewer, scene, pattern, light).angle_deg)
    assert (np.diff(bounds, axis=0) <= 0).all()
    whole = sensor.observe(scene, pattern, NoiseStreams.named("test", "batch"))
    streams = NoiseStreams.named("test", "batch")
    parts = [sensor.observe(scene.part(n, n + 1), pattern, streams) for n in range(3)]
    assert np.concatenate(parts).tobytes() == whole.tobytes()
    with pytest.raises(ValueError, match=r"events must be in \[1, 4096\]"):
        replace(sensor.detector, events=0)
