"""The calibration bench: what its errors do, that they are drawn alone, and what they spare."""

from __future__ import annotations

import math
from dataclasses import fields, replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmark import datasets
from benchmark.datasets.calibration import Bench
from benchmark.datasets.fields import AngleField, SphereField
from benchmark.datasets.samples import samples_hash
from benchmark.seeds import generator

PERFECT = Bench(**dict.fromkeys((f.name for f in fields(Bench)), 0.0))
GRID = AngleField(60.0, steps=9).sun("calibration", generator("unused"))
SPHERE = SphereField(200).sun("calibration", generator("unused"))


def off_deg(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.degrees(np.linalg.norm(np.cross(one, other), axis=1))


def test_a_bench_without_errors_reports_the_truth() -> None:
    np.testing.assert_allclose(PERFECT.report(SPHERE, "unit"), SPHERE, atol=4e-16)
    assert (PERFECT.light(SPHERE, "unit") == 1.0).all()
    assert PERFECT.systematic_deg(SPHERE) == 0.0


def test_a_mounting_rotation_is_an_error_until_a_rotation_is_fitted() -> None:
    """Of length w about n the readings are off by w |n x s|; Kabsch takes it away to rounding."""
    bench = replace(PERFECT, mounting_deg=0.02)
    said = bench.report(GRID, "unit")
    vector = np.array(bench.draw_errors("unit").mounting_deg)
    expected = np.linalg.norm(np.cross(vector, GRID), axis=1)
    np.testing.assert_allclose(off_deg(said, GRID), expected, rtol=1e-3)  # w^2 / 2 of an axis
    fitted, _ = Rotation.align_vectors(said, GRID)
    np.testing.assert_allclose(fitted.apply(GRID), said, atol=1e-14)
    np.testing.assert_allclose(fitted.as_rotvec(degrees=True), vector, atol=1e-12)


def test_the_table_is_that_of_its_rotations() -> None:
    """Mounting, outer axis, missing right angle, inner axis: one rotation after another."""
    bench = replace(
        PERFECT, mounting_deg=0.5, squareness_deg=0.4, eccentricity_deg=0.3, axis_random_deg=0.0
    )
    built = bench.draw_errors("unit")
    outer = np.degrees(np.arctan2(SPHERE[:, 1], SPHERE[:, 2]))
    inner = np.degrees(np.arcsin(SPHERE[:, 0]))

    def read(angle: np.ndarray, harmonic: tuple[float, float]) -> np.ndarray:
        turn = np.radians(angle)
        return angle + harmonic[0] * np.cos(turn) + harmonic[1] * np.sin(turn)

    turned = (
        Rotation.from_rotvec(built.mounting_deg, degrees=True)
        * Rotation.from_euler("X", -read(outer, built.outer_deg)[:, None], degrees=True)
        * Rotation.from_euler("Z", built.squareness_deg, degrees=True)
        * Rotation.from_euler("Y", read(inner, built.inner_deg)[:, None], degrees=True)
    )
    expected = turned.apply([0.0, 0.0, 1.0])
    np.testing.assert_allclose(bench.report(SPHERE, "unit"), expected, atol=1e-14)


@pytest.mark.parametrize("poses", [9, 81])
def test_random_errors_of_the_axes_average_out_in_a_linear_fit(poses: int) -> None:
    """Over poses near the boresight the mean of either angle is off by size / sqrt(poses)."""
    bench = replace(PERFECT, axis_random_deg=0.003)
    sun = np.repeat([[0.0, 0.0, 1.0]], poses, axis=0)
    trials = 400
    means = [bench.report(sun, trial, poses)[:, :2].mean(axis=0) for trial in range(trials)]
    ratio = np.degrees(np.std(means)) / (0.003 / math.sqrt(poses))
    # of a standard deviation from 800 numbers: 4 standard errors
    assert ratio == pytest.approx(1.0, abs=4 / math.sqrt(2 * 2 * trials))


@pytest.mark.parametrize("sun", [GRID, SPHERE], ids=["square field", "sphere"])
def test_the_stated_reference_error_is_the_spread_of_benches(sun: np.ndarray) -> None:
    bench = Bench(
        axis_random_deg=0.0, mounting_deg=0.01, squareness_deg=0.02, eccentricity_deg=0.015
    )
    few = sun[::6]
    squares = [np.mean(off_deg(bench.report(few, trial), few) ** 2) for trial in range(500)]
    error = np.std(squares) / math.sqrt(len(squares))
    assert abs(np.mean(squares) - bench.systematic_deg(few) ** 2) < 4 * error
    assert bench.systematic_deg(few) == Bench(
        **{f.name: getattr(bench, f.name) for f in fields(Bench)[1:]}
    ).systematic_deg(few), "random errors are none of it"


def test_lamp_drift_goes_with_the_order_of_poses_and_leaves_ratios_unmoved() -> None:
    bench = replace(PERFECT, lamp_drift_per_hour=0.05, lamp_level=0.02, pose_s=9.0)
    built = bench.draw_errors("unit")
    hours = np.arange(len(GRID)) * 9.0 / 3600.0
    light = bench.light(GRID, "unit")
    expected = (1 + built.level) * (1 + built.drift_per_hour * hours)
    np.testing.assert_allclose(light, expected, rtol=1e-15)
    preset = datasets.get("qpd-single-aperture")
    sensor, pattern = preset.condition("nominal").sensor, preset.fixed_pattern("nominal")
    whole = replace(preset.scene("nominal", "calibration").part(0, 20), stray=np.zeros(20))
    steady, drifting, dark = (
        sensor.expected(replace(whole, irradiance=share), pattern)
        for share in (np.ones(20), light[:20], np.zeros(20))
    )
    ratio = (drifting - dark) / (steady - dark)
    np.testing.assert_allclose(ratio, np.tile(light[:20, None], 4), rtol=1e-9)


def test_an_uneven_beam_changes_light_with_the_pose_and_flicker_at_random() -> None:
    uneven = replace(PERFECT, lamp_uneven=0.01)
    gradient = np.array(uneven.draw_errors("unit").uneven)
    expected = 1 + (GRID - [0.0, 0.0, 1.0]) @ gradient
    np.testing.assert_allclose(uneven.light(GRID, "unit"), expected, rtol=1e-15)
    many = np.repeat([[0.0, 0.0, 1.0]], 4000, axis=0)
    flicker = replace(PERFECT, lamp_flicker=0.002).light(many, "unit")
    assert flicker.std() == pytest.approx(0.002, rel=4 / math.sqrt(2 * 4000))


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["cmos-single-aperture", "qpd-single-aperture", "pd-maskless-cube"]
)
def test_a_bench_changes_the_calibration_split_alone(name: str) -> None:
    """Directions and windows stay, and every byte of test and repeat."""
    preset = datasets.get(name)
    setup = replace(preset.condition("nominal"), bench=None)
    perfect = replace(preset, setups={**preset.setups, "nominal": setup})
    for split in ("test", "repeat"):
        one, other = (p.generate("nominal", split, 12) for p in (preset, perfect))
        assert samples_hash(one) == samples_hash(other)
        assert one.true_sun is None
    one, other = (p.generate("nominal", "calibration", 12) for p in (preset, perfect))
    assert other.true_sun is None
    assert np.array_equal(one.truth, other.sun)
    assert np.array_equal(one.origin_px, other.origin_px)
    error = off_deg(one.sun, one.truth)
    assert 0.0 < error.min() < error.max() < 0.2
    again = preset.generate("nominal", "calibration", 5)
    assert np.array_equal(again.sun, one.sun[:5]), "the first are those of the whole"


def test_conditions_share_a_bench_and_units_do_not() -> None:
    preset = datasets.get("pd-maskless-cube")
    nominal, noisy = (preset.generate(c, "calibration") for c in ("nominal", "high-noise"))
    assert np.array_equal(nominal.sun, noisy.sun)
    lamps = [preset.scene(c, "calibration").irradiance for c in ("nominal", "high-noise")]
    assert np.array_equal(*lamps)
    other = preset.for_unit(2)
    assert not np.array_equal(other.generate("nominal", "calibration", 9).sun, nominal.sun[:9])
    assert not np.array_equal(other.scene("nominal", "calibration").irradiance, lamps[0])
