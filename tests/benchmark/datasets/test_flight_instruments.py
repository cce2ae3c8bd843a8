"""Instruments in orbit: attitude, magnetometer, field model and thermometer are off as stated."""

from __future__ import annotations

import math
from dataclasses import fields, replace

import numpy as np
import pytest

from benchmark import datasets
from benchmark.datasets.calibration import IDEAL, STANDARD_BENCH
from benchmark.datasets.conditions.flight import FlightPreset
from benchmark.datasets.conditions.instruments import ABOARD, Instruments
from benchmark.seeds import generator
from benchmark.simulator.flight.magnetic_field import Quadrupole
from benchmark.simulator.light.environment import uniform_direction

NONE = Instruments(**dict.fromkeys((f.name for f in fields(Instruments)), 0.0))
PRESET = datasets.get("pd-orbit")
SPHERE = np.array([uniform_direction(generator("sphere", n)) for n in range(300)])


def with_bench(bench: Instruments | None) -> FlightPreset:
    assert isinstance(PRESET, FlightPreset)
    setup = replace(PRESET.condition("nominal"), bench=bench)
    return replace(PRESET, setups={"nominal": setup})


def potential(field: Quadrupole, places: np.ndarray) -> np.ndarray:
    """Scalar potential at places (N, 3) in km, Earth-fixed, by Schmidt's functions."""
    distance = np.linalg.norm(places, axis=1)
    x, y, z = places.T
    sine, longitude = z / distance, np.arctan2(y, x)
    cosine = np.sqrt(1 - sine**2)
    terms = (
        field.g20_nt * (3 * sine**2 - 1) / 2
        + math.sqrt(3) * sine * cosine
        * (field.g21_nt * np.cos(longitude) + field.h21_nt * np.sin(longitude))
        + math.sqrt(3) / 2 * cosine**2
        * (field.g22_nt * np.cos(2 * longitude) + field.h22_nt * np.sin(2 * longitude))
    )  # fmt: skip
    return field.radius_km * (field.radius_km / distance) ** 3 * terms


def test_the_quadrupole_is_the_gradient_of_its_potential() -> None:
    """Central differences over 2 km: their error is (step / r)^2, 1e-7 of the field."""
    field = Quadrupole(-2500.0, 2982.0, -2991.6, 1676.8, -734.8)
    distance, step = 6971.0, 1.0
    gradient = np.column_stack(
        [
            (
                potential(field, distance * SPHERE + step * axis)
                - potential(field, distance * SPHERE - step * axis)
            )
            / (2 * step)
            for axis in np.eye(3)
        ]
    )
    found = field.inertial(SPHERE, distance, np.zeros(len(SPHERE)))
    np.testing.assert_allclose(found, -gradient, atol=1e-6 * np.abs(gradient).max())


def test_the_quadrupole_turns_with_earth() -> None:
    field = Quadrupole(100.0, 200.0, -300.0, 400.0, 500.0)
    day = 86164.0905  # of the stars
    now, then = (field.inertial(SPHERE, 7000.0, np.full(300, t)) for t in (0.0, day))
    np.testing.assert_allclose(now, then, atol=1e-4)
    turned = SPHERE[:, [1, 0, 2]] * [-1, 1, 1]  # by 90 deg about z
    quarter = field.inertial(turned, 7000.0, np.full(300, day / 4))
    np.testing.assert_allclose(quarter, now[:, [1, 0, 2]] * [-1, 1, 1], atol=1e-3)


def test_the_missing_field_is_as_strong_as_stated() -> None:
    """Mean square over the sphere and over 200 draws; a draw's has a spread of sqrt(2 / 5)."""
    some = SPHERE[:60]
    squares = [
        np.mean(
            np.sum(ABOARD.missing_field(6971.0, trial).inertial(some, 6971.0, np.zeros(60)) ** 2, 1)
        )
        for trial in range(200)
    ]
    error = np.std(squares) / math.sqrt(len(squares))
    assert abs(np.mean(squares) - ABOARD.field_difference_nt**2) < 4 * error


def test_the_reference_in_orbit_is_off_by_noise_and_a_fixed_rotation() -> None:
    noisy = replace(NONE, attitude_random_deg=0.02).report(SPHERE, "unit")
    error = np.degrees(np.linalg.norm(np.cross(noisy, SPHERE), axis=1))
    # of 600 numbers: 4 standard errors
    assert math.sqrt(np.mean(error**2) / 2) == pytest.approx(0.02, rel=4 / math.sqrt(1200))
    bias = replace(NONE, attitude_bias_deg=0.02)
    squares = [
        np.mean(np.sum(np.cross(bias.report(SPHERE[:30], trial), SPHERE[:30]) ** 2, axis=1))
        for trial in range(500)
    ]
    stated = math.radians(bias.systematic_deg(SPHERE)) ** 2
    assert abs(np.mean(squares) - stated) < 4 * np.std(squares) / math.sqrt(500)


def test_the_magnetometer_has_one_offset_on_both_splits_and_another_on_another_unit() -> None:
    def offset(preset: FlightPreset, split: str) -> np.ndarray:
        return preset.context("nominal", split)["magnetic_field_nT"]

    plain, biased = with_bench(NONE), with_bench(replace(NONE, magnetometer_bias_nt=300.0))
    found = [offset(biased, split) - offset(plain, split) for split in ("calibration", "test")]
    np.testing.assert_allclose(found[0], np.tile(found[0][0], (len(found[0]), 1)), atol=1e-9)
    np.testing.assert_allclose(found[1][0], found[0][0], atol=1e-9)
    other = offset(biased.for_unit(1), "test") - offset(plain.for_unit(1), "test")
    assert np.abs(other[0] - found[0][0]).min() > 1.0


def test_the_thermometer_reads_digits_of_a_shifted_temperature() -> None:
    true = np.full(4000, 293.0)
    read = ABOARD.thermometer_k(true, ("unit",), ("split",))
    np.testing.assert_allclose(read / 0.25, np.round(read / 0.25), atol=1e-9)
    exact = replace(ABOARD, thermometer_step_k=0.0).thermometer_k(true, ("unit",), ("split",))
    assert np.abs(read - exact).max() <= 0.125 + 1e-9
    assert exact.std() == pytest.approx(0.2, rel=4 / math.sqrt(8000))
    drawn = [
        replace(NONE, thermometer_bias_k=1.0).thermometer_k(true[:1], (n,), ("split",))[0] - 293.0
        for n in range(400)
    ]
    assert np.std(drawn) == pytest.approx(1.0, rel=4 / math.sqrt(800))


def test_perfect_instruments_leave_the_noise_that_the_flight_states() -> None:
    for split in ("calibration", "test"):
        none, perfect = (with_bench(b).context("nominal", split) for b in (NONE, None))
        for name, column in none.items():
            np.testing.assert_allclose(column, perfect[name], rtol=1e-12, err_msg=name)


def test_errors_of_instruments_change_neither_light_nor_truth() -> None:
    off, perfect = with_bench(ABOARD), with_bench(None)
    one, other = (preset.generate("nominal", "test", 40) for preset in (off, perfect))
    assert one.observations.tobytes() == other.observations.tobytes()
    assert np.array_equal(one.sun, other.sun)
    assert one.true_sun is None
    changed = {
        name for name, column in one.context.items() if (column != other.context[name]).any()
    }
    assert changed == {"temperature_K", "magnetic_field_nT"}
    one, other = (preset.generate("nominal", "calibration", 40) for preset in (off, perfect))
    assert one.observations.tobytes() == other.observations.tobytes()
    assert np.array_equal(one.truth, other.sun)
    assert not np.array_equal(one.sun, other.sun)


def test_a_flight_is_not_calibrated_on_the_ground() -> None:
    setup = replace(PRESET.condition("nominal"), bench=STANDARD_BENCH)
    with pytest.raises(TypeError, match=r"calibrated in orbit \(Instruments\).*got Bench"):
        replace(PRESET, setups={"nominal": setup})
    with pytest.raises(ValueError, match="thermometer_bias_k must be finite, not negative"):
        Instruments(thermometer_bias_k=-1.0)
    assert PRESET.condition(IDEAL).bench is None
