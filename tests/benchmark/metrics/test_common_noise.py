"""Noise that a column shares, in bounds: against the covariance written out and inverted."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmark import datasets
from benchmark.metrics.bounds import cramer_rao
from benchmark.metrics.noise_products import noise_products
from benchmark.simulator.light.sun_disc import from_angles, tangent_axes
from benchmark.simulator.readout.column_noise import CommonNoise
from benchmark.simulator.readout.pixel_errors import PixelErrors
from benchmark.simulator.readout.references import References
from benchmark.simulator.scene import Scene


@given(st.integers(0, 2**31), st.floats(0.0, 30.0))
def test_products_are_those_over_the_inverse_covariance(seed: int, common: float) -> None:
    rng = np.random.default_rng(seed)
    group = rng.integers(0, 4, size=(2, 12))
    variance = rng.uniform(0.5, 3.0, size=(2, 12)) ** 2
    variance[0, 3] = math.inf
    mean, first, second = rng.standard_normal((3, 2, 12))
    signals = np.stack([mean + first, mean + second])
    found = noise_products(mean, signals, variance, CommonNoise(group, common))
    for n in range(2):
        known = np.isfinite(variance[n])
        same = group[n, known][:, None] == group[n, known][None]
        covariance = np.diag(variance[n, known]) + common**2 * same
        changes = np.stack([first[n, known], second[n, known]])
        expected = changes @ np.linalg.solve(covariance, changes.T)
        assert found[n] == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_columns_are_groups_of_every_so_many_elements() -> None:
    """Rows of columns, and without common noise: the sums written out."""
    rng = np.random.default_rng(3)
    mean, change = rng.standard_normal((2, 2, 12))
    variance = rng.uniform(0.5, 3.0, size=(2, 12))
    listed = CommonNoise(np.arange(12) % 4, 0.7)
    one, other = (
        noise_products(mean, (mean + change)[None], variance, common)
        for common in (listed, CommonNoise(4, 0.7))
    )
    assert one == pytest.approx(other, rel=1e-12)
    alone = noise_products(mean, (mean + change)[None], variance)
    assert alone[:, 0, 0] == pytest.approx(np.sum(change**2 / variance, axis=1), rel=1e-12)
    assert (one < alone).all()


def window(errors: PixelErrors) -> tuple[Any, Any, Scene]:
    """A small window of a slit's end: both axes are determined, columns by many rows."""
    setup = datasets.get("cmos-single-aperture").setups["nominal"]
    sensor: Any = setup.sensor
    detector = replace(sensor.detector, columns=96, rows=96, errors=errors)
    sensor = replace(sensor, detector=detector, window_jitter_px=0)
    sun = from_angles(np.array([3.3]), np.array([-2.2]))
    scene = Scene(sun, np.ones(1), np.full(1, 0.01), sensor.origins(sun, np.random.default_rng(0)))
    return setup, sensor, scene


NOISY = PixelErrors(crosstalk=0.02, nonlinearity=0.02, column_offset_e=60.0, column_noise_e=40.0)
OFFERED = References()


@pytest.mark.parametrize("references", [None, OFFERED, References(flats=0, darks=0)])
def test_the_bound_is_that_of_the_whole_covariance(references: References | None) -> None:
    """Fisher information of the frame with a matrix of 4096 x 4096, inverted column by column."""
    setup, sensor, scene = window(NOISY)
    unit = sensor.fixed_pattern("unit")
    bound = cramer_rao(sensor, scene, unit, setup.irradiance, references=references or OFFERED)
    mean = sensor.expected(scene, unit)
    variance = sensor.variance(mean)
    shared = 40.0**2
    if references is not None:
        variance = variance + sensor.unit_variance(mean, scene, references)
        readings = references.flats + references.darks
        # the offset, of its spread and of the mean of readings that share a column's noise
        shared += 1.0 / (60.0**-2 + readings * 40.0**-2)
    shared /= sensor.detector.gain_e_per_dn**2
    first, second = tangent_axes(scene.sun)
    step, derivatives = 5e-4, []
    for axis in (first, second):
        ends = []
        for sign in (1.0, -1.0):
            sun = math.cos(step) * scene.sun + sign * math.sin(step) * axis
            ends.append(sensor.expected(replace(scene, sun=sun), unit)[0])
        derivatives.append((ends[0] - ends[1]) / (2.0 * step))
    light = setup.irradiance
    brighter = replace(scene, irradiance=scene.irradiance + light.spread)
    hazier = replace(scene, stray=scene.stray + light.stray_spread)
    derivatives += [sensor.expected(seen, unit)[0] - mean[0] for seen in (brighter, hazier)]
    fisher = np.diag([0.0, 0.0, 1.0, 1.0])
    for column in range(mean.shape[2]):
        own = variance[0, :, column]
        known = np.isfinite(own)
        covariance = np.diag(own[known]) + shared
        slopes = np.stack([d[known, column] for d in derivatives], axis=1)
        fisher += slopes.T @ np.linalg.solve(covariance, slopes)
    exact = math.degrees(math.sqrt(np.trace(np.linalg.inv(fisher)[:2, :2])))
    found = bound.angle_deg if references is None else bound.unit_angle_deg
    assert found is not None
    assert found[0] == pytest.approx(exact, rel=1e-6)


def test_common_noise_costs_more_than_nothing_and_less_than_noise_of_pixels() -> None:
    """Along columns it cancels; as noise of single pixels it would cost both axes."""
    setup, sensor, scene = window(PixelErrors())
    unit = sensor.fixed_pattern("unit")
    angles = []
    for errors, read_e in (
        (PixelErrors(), 30.0),
        (PixelErrors(column_noise_e=60.0), 30.0),
        (PixelErrors(), math.hypot(30.0, 60.0)),
    ):
        detector = replace(sensor.detector, errors=errors, read_noise_e=read_e)
        noisy = replace(sensor, detector=detector)
        found = cramer_rao(noisy, scene, unit, setup.irradiance)
        angles.append((found.alpha_deg[0], found.beta_deg[0]))
    (alpha, beta), (shared_alpha, shared_beta), (own_alpha, own_beta) = angles
    assert alpha < shared_alpha < own_alpha
    assert beta < shared_beta
    # columns lie along y: alpha is determined by differences within them
    assert shared_alpha / alpha < 1.05 < own_alpha / alpha
    assert own_beta > beta
