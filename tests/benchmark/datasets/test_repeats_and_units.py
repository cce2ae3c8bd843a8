"""The split of repeated poses, and other units of a sensor."""

from __future__ import annotations

from dataclasses import astuple, replace

import numpy as np
import pytest

from benchmark import datasets
from benchmark.datasets.repeats import Repeats
from benchmark.datasets.units import assemble, tolerance_of, tolerances

PRESETS = {name: datasets.get(name) for name in datasets.names()}


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["cmos-single-aperture", "pd-orbit", "cmos-single-aperture-pinhole"]
)
def test_passes_differ_in_noise_alone(name: str) -> None:
    preset = PRESETS[name]
    scene, test = preset.scene("nominal", "repeat"), preset.scene("nominal", "test")
    again = preset.repeats.pose_indices(len(test))
    poses, passes = len(again), preset.repeats.passes
    assert len(scene) == poses * passes == 200
    for column in ("sun", "irradiance", "stray", "origin_px", "albedo", "temperature_k"):
        whole = getattr(test, column, None)
        if whole is not None:
            held = getattr(scene, column).reshape(passes, poses, *whole.shape[1:])
            assert (held == whole[again]).all(), column
    samples = preset.generate("nominal", "repeat")
    observed = samples.observations.reshape(passes, poses, -1)
    assert (observed[0] != observed[1]).any(axis=1).all()
    assert (
        observed != preset.generate("nominal", "test").observations[again].reshape(poses, -1)
    ).any()


@pytest.mark.slow
def test_the_spread_of_repeats_is_the_noise_the_sensor_states() -> None:
    """Over 200 passes the variance of every pixel is the shot, read and rounding noise."""
    preset = replace(PRESETS["cmos-single-aperture"], repeats=Repeats(poses=3, passes=200))
    samples = preset.generate("nominal", "repeat")
    frames = samples.observations.reshape(200, 3, -1).astype(float)
    sensor, pattern = preset.condition("nominal").sensor, preset.fixed_pattern("nominal")
    scene = preset.scene("nominal", "repeat").part(0, 3)
    variance = sensor.variance(sensor.expected(scene, pattern)).reshape(3, -1)
    ratio = frames.var(axis=0, ddof=1) / variance
    assert ratio.mean() == pytest.approx(1.0, abs=0.01)


def test_repeats_of_a_flight_carry_the_context_of_their_moments() -> None:
    preset = PRESETS["pd-orbit"]
    repeat, test = (preset.generate("nominal", split) for split in ("repeat", "test"))
    again = np.tile(preset.repeats.pose_indices(len(test.sun)), preset.repeats.passes)
    assert repeat.context.keys() == test.context.keys()
    for name, column in repeat.context.items():
        assert (column == test.context[name][again]).all(), name


def test_unit_0_is_the_dataset_itself() -> None:
    preset = PRESETS["cmos-single-aperture"]
    assert preset.for_unit(0) is preset
    with pytest.raises(ValueError, match="numbered from 0; got -1"):
        preset.for_unit(-1)
    with pytest.raises(ValueError, match="this is unit 2"):
        preset.for_unit(2).for_unit(1)


@pytest.mark.slow
@pytest.mark.parametrize("name", PRESETS)
def test_another_unit_sees_the_same_suns_otherwise(name: str) -> None:
    standard, other = PRESETS[name], PRESETS[name].for_unit(1)
    one, two = (preset.generate("nominal", "test", 8) for preset in (standard, other))
    assert np.array_equal(one.sun, two.sun)
    assert one.observations.dtype == two.observations.dtype
    same = one.observations.tobytes() == two.observations.tobytes()
    assert not same
    assert other.geometry == standard.geometry, "the design is what it was"
    again = PRESETS[name].for_unit(1).generate("nominal", "test", 8)
    assert again.observations.tobytes() == two.observations.tobytes()


def test_errors_of_assembly_are_uniform_within_the_tolerance_of_unit_0() -> None:
    """Standard deviation: the size in unit 0, of two axes the larger one's."""
    sensor = PRESETS["cmos-single-aperture"].condition("nominal").sensor
    built = sensor.camera.assembly
    ((place, limit),) = tolerances(sensor).items()
    assert place == "camera.assembly"
    drawn = np.array([astuple(assemble(sensor, "test", n).camera.assembly) for n in range(2000)])
    height = 0.002 * sensor.camera.focal_length_mm
    expected = np.array([0.05, 0.05, 0.05, height, 0.004, 0.004])
    assert (np.abs(drawn) <= np.array(astuple(limit))).all()
    np.testing.assert_allclose(drawn.std(axis=0), expected, rtol=0.05)
    np.testing.assert_allclose(np.abs(drawn).max(axis=0), np.sqrt(3) * expected, rtol=0.01)
    assert np.abs(drawn.mean(axis=0) / expected).max() < 0.1
    correlation = np.corrcoef(drawn.T) - np.eye(6)
    assert np.abs(correlation).max() < 0.1
    assert astuple(tolerance_of(built)) == astuple(limit)


def test_conditions_of_equal_tolerance_see_one_unit() -> None:
    preset = PRESETS["cmos-single-aperture"].for_unit(4)
    nominal, noisy, crooked = (
        preset.condition(name).sensor.camera.assembly
        for name in ("nominal", "high-noise", "misaligned")
    )
    assert nominal == noisy
    # the same draw, of twenty times the tolerance
    assert crooked.tilt_x_deg == pytest.approx(20 * nominal.tilt_x_deg)
    patterns = [preset.fixed_pattern(name)["gain"] for name in ("nominal", "misaligned")]
    assert np.array_equal(*patterns)
    assert not np.array_equal(patterns[0], PRESETS[preset.name].fixed_pattern("nominal")["gain"])


def test_a_mask_that_lies_on_its_glass_takes_it_along() -> None:
    """The gap of pd-single-aperture is glass all through: a shorter one holds thinner glass."""
    preset = PRESETS["pd-single-aperture"]
    cameras = [preset.for_unit(n).condition("nominal").sensor.camera for n in range(1, 30)]
    gaps = np.array([camera.height_mm for camera in cameras])
    glass = np.array([camera.glass.thickness_mm for camera in cameras])
    assert (gaps < 0.5).any()
    np.testing.assert_allclose(glass, np.minimum(gaps, 0.5), rtol=1e-12)


def test_heads_of_other_units_bend_and_creep_by_rates_of_their_own() -> None:
    """Uniform, with the standard unit's size as standard deviation, on average none."""
    rates = np.array(
        [
            astuple(PRESETS["qpd-orbit"].for_unit(n).setups["nominal"].sensor.assembly)
            for n in range(1, 301)
        ]
    )
    own = np.array(astuple(PRESETS["qpd-orbit"].setups["nominal"].sensor.assembly))
    np.testing.assert_allclose(rates.std(axis=0), np.abs(own), rtol=0.12)
    assert (np.abs(rates.mean(axis=0)) < 0.25 * np.abs(own)).all()
    assert (np.abs(rates).max(axis=0) <= np.sqrt(3.0) * np.abs(own)).all()
