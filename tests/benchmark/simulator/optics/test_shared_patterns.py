"""What round holes share: one lattice a frame, tables of the drawn height for every unit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmark import datasets
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.masks.apertures import Aperture
from benchmark.simulator.masks.errors import MaskErrors
from benchmark.simulator.masks.layouts import grid
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.diffraction import Spectrum
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.optics.table_grids import spread
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.lit_pixels import LitPixels
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor

TWO = Spectrum((500.0, 800.0), (0.6, 0.4))


def sensor_of(
    height_mm: float, *, holes: int = 10, hole_mm: float = 0.07, error_mm: float = 0.0
) -> MultiSpotSensor:
    """Holes 0.12 mm apart above 160 x 144 px of 9 um: a design that no data set has."""
    base = datasets.get("cmos-multi-aperture").setups["nominal"].sensor
    assert isinstance(base, MultiSpotSensor)
    mask = grid(holes, holes, 0.12, Aperture("round", hole_mm, hole_mm))
    camera = Camera(height_mm, mask, assembly=Assembly(focal_length_error_mm=error_mm))
    detector = replace(base.detector, columns=160, rows=144, pitch_mm=0.009)
    return MultiSpotSensor(camera, detector, base.errors, spectrum=TWO, widest_deg=50.0)


def seen(alpha: float, beta: float) -> Scene:
    sun = from_angles(np.array([alpha]), np.array([beta]))
    return Scene(sun, np.ones(1), np.zeros(1))


@pytest.mark.parametrize(("alpha", "beta"), [(0.0, 0.0), (17.0, -4.0), (-31.0, 38.0)])
def test_a_pattern_shared_by_many_holes_is_that_of_each(alpha: float, beta: float) -> None:
    sensor = sensor_of(0.8)
    pattern = sensor.fixed_pattern("test")
    (group,) = sensor._spots.groups
    assert group.lattice > 0
    shared = sensor.lit(seen(alpha, beta), pattern)
    sensor._spots.__dict__["groups"] = (replace(group, lattice=0),)
    each = sensor.lit(seen(alpha, beta), pattern)
    assert np.abs(shared - each).max() < 1e-3 * each.max()
    assert shared.sum() == pytest.approx(each.sum(), rel=1e-4)
    # light ends on the same pixels
    assert np.array_equal(shared > 0.0, each > 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("error_mm", [0.004, -0.006])
def test_tables_of_the_drawn_height_serve_the_built_one(error_mm: float) -> None:
    """Half a per cent: more than assembly is wrong by in any data set."""
    built = sensor_of(0.8, holes=2, error_mm=error_mm)
    drawn = sensor_of(0.8 + error_mm, holes=2)
    pattern = drawn.fixed_pattern("test")
    scene = seen(12.0, -20.0)
    found, expected = (sensor.lit(scene, pattern) for sensor in (built, drawn))
    assert np.abs(found - expected).max() < 2e-3 * expected.max()
    # spots lie where the built height puts them
    columns = np.arange(160)
    middles = [np.sum(light[0].sum(axis=0) * columns) / light.sum() for light in (found, expected)]
    assert middles[0] == pytest.approx(middles[1], abs=1e-3)


def test_holes_further_off_than_the_masks_errors_are_refused() -> None:
    sensor = replace(sensor_of(0.8, holes=2, hole_mm=0.04), errors=MaskErrors(size_mm=0.002))
    pattern = dict(sensor.fixed_pattern("test"))
    pattern["apertures"] = pattern["apertures"] * np.array([1.0, 1.0, 1.0, 1.5, 1.5, 1.0, 1.0])
    with pytest.raises(ValueError, match=r"drawn 0.04.*28.1"):
        sensor.lit(seen(0.0, 0.0), pattern)


def test_pixels_of_a_bound_are_all_that_a_step_lights() -> None:
    sensor = sensor_of(0.8, holes=3)
    scene, pattern = seen(41.0, -30.0), sensor.fixed_pattern("test")
    listed = np.zeros(144 * 160, dtype=bool)
    pixels = LitPixels(sensor, scene, pattern)._pixels[0]
    listed[pixels[pixels >= 0]] = True
    for step in (0.0, 5e-4, -5e-4):
        moved = from_angles(np.array([41.0 + np.degrees(step)]), np.array([-30.0]))
        light = sensor.lit(scene.seen_from(moved), pattern)
        assert listed[light.ravel() > 0.0].all()
    assert listed.sum() < 1.6 * (sensor.lit(scene, pattern) > 0.0).sum()


def test_light_spread_over_the_sun_is_the_sum_of_its_shifts() -> None:
    """Against the definition on a cubic polynomial, which cubics interpolate exactly."""
    reach, margin = 12, 6
    size = reach + margin

    def light(along: np.ndarray, across: np.ndarray) -> np.ndarray:
        return np.asarray(1.0 + 0.1 * along + 0.02 * along**3 + 0.3 * across**2)

    rows, columns = np.arange(-size, size + 1.0)[:, None], np.arange(size + 1.0)
    shifts = np.array([[0.3, -1.2], [0.3, 1.2], [-2.4, 0.0]])
    weights = np.array([0.25, 0.25, 0.5])
    found = spread(light(rows, columns), shifts, weights, margin)
    x, y = np.arange(-reach, reach + 1.0)[:, None], np.arange(reach + 1.0)
    parts = zip(shifts, weights, strict=True)
    expected = sum(weight * light(x - dx, y - dy) for (dx, dy), weight in parts)
    assert found == pytest.approx(expected, abs=1e-9)
