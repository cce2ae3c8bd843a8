"""How precise many spots are together, on the simulated mask of `cmos-multi-aperture`."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.typing import NDArray

from algorithms.angles import sun_from_angles
from algorithms.contract import SensorGeometry
from algorithms.extractors.frames.multi_spot.image_correlation import ImageCorrelation
from algorithms.extractors.frames.multi_spot.mean_shift import MeanShift
from algorithms.extractors.frames.multi_spot.multiple_centroids import MultipleCentroids
from benchmark.datasets.conditions.full_frames import draw_frames
from benchmark.datasets.standard.cmos_multi_aperture import PRESET
from benchmark.simulator.masks.layouts import grid
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor

METHODS = (MultipleCentroids, MeanShift, ImageCorrelation)
#: Directions and draws of noise by number of holes a side. One spot scatters as it falls on the
#: pixels: few spots need many directions to show their mean.
DRAWS = {1: (100, 6), 2: (40, 6), 4: (12, 10), 5: (10, 10), 10: (6, 12)}


@dataclass(frozen=True)
class Drawn:
    """Frames of some directions without noise, and draws of the same frames with it."""

    geometry: SensorGeometry
    clean: NDArray[np.float64]  # (D, H, W)
    noisy: NDArray[np.float64]  # (D * draws, H, W), directions one after another


def sensor_of(side: int, missing: float = 0.0) -> MultiSpotSensor:
    """The dataset's sensor with a grid of `side` holes a side, and a detector just large enough."""
    full = PRESET.condition("nominal").sensor
    corner, neighbour = full.camera.mask.apertures[:2]
    spacing = neighbour.x_mm - corner.x_mm
    mask = grid(side, side, spacing, replace(corner, x_mm=0.0, y_mm=0.0), 0.01)
    pixels = round((side - 1) * spacing / full.detector.pitch_mm) + 64
    return replace(
        full,
        camera=replace(full.camera, mask=mask),
        detector=replace(full.detector, columns=pixels, rows=pixels),
        errors=replace(full.errors, missing=missing),
    )


def draw(side: int, missing: float = 0.0) -> Drawn:
    """Frames within 5 degrees of the boresight."""
    directions, draws = DRAWS[side]
    sensor = sensor_of(side, missing)
    rng = np.random.default_rng(20)
    sun = sun_from_angles(rng.uniform(-5.0, 5.0, (directions, 2)))
    scene = Scene(sun, np.ones(directions), np.full(directions, 0.002), None, None)
    clean = sensor.expected(scene, sensor.fixed_pattern("precision", side))
    spread = np.sqrt(sensor.variance(clean))
    noise = rng.standard_normal((directions, draws, *clean.shape[1:]), dtype=np.float32)
    noise *= spread[:, None]
    noise += clean[:, None]
    mask = sensor.camera.mask
    geometry = replace(
        PRESET.geometry, apertures=draw_frames(mask), centre_px=sensor.detector.centre_px
    )
    return Drawn(geometry, clean, noise.reshape(-1, *clean.shape[1:]))


def scatter(method, seen: Drawn) -> float:
    """Scatter, px an axis, of noisy frames about the estimate of the same frame without noise."""
    extractor = method.for_sensor(seen.geometry)
    found = extractor.extract(seen.noisy).reshape(len(seen.clean), -1, 2)
    return float(np.sqrt(np.mean((found - extractor.extract(seen.clean)[:, None]) ** 2)))


@pytest.fixture(scope="module")
def grids():
    """Frames by the number of holes a side."""
    return {side: draw(side) for side in DRAWS}


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
def test_precision_grows_with_the_root_of_the_number_of_spots(method, grids):
    """sigma_N sqrt(N) is the same whatever N: within 15 % of the mean.

    A spot alone is its own goal for FMMS: its weights are equal, and their noise is not there.
    """
    sides = [side for side in DRAWS if side > 1 or method is not MeanShift]
    one = np.array([scatter(method, grids[side]) * side for side in sides])
    assert np.abs(one / np.sqrt(np.mean(one**2)) - 1.0).max() < 0.15


@pytest.mark.slow
def test_fmms_alone_is_more_precise_than_its_share(grids):
    assert scatter(MeanShift, grids[1]) < 0.9 * 4 * scatter(MeanShift, grids[4])  # 0.81


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
def test_a_fifth_of_the_spots_missing_costs_no_more_than_their_light(method, grids):
    """Noise grows by sqrt(1 / 0.8) = 1.12; nothing of the missing spots adds to it."""
    loss = scatter(method, draw(10, missing=0.2)) / scatter(method, grids[10])
    assert 0.95 < loss < 1.25
