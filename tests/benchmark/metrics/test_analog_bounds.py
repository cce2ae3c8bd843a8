"""Cramer-Rao bounds of the analog datasets against Monte Carlo and against scaling laws."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from benchmark import datasets
from benchmark.datasets import Condition
from benchmark.metrics.bounds import cramer_rao
from benchmark.seeds import generator
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.light.sun_disc import from_angles, tangent_axes
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene

#: Sunlight as good as unknown, stray light as good as known: the noise alone limits.
LIGHT = Irradiance(spread=0.5, stray=0.002, stray_spread=1e-8)


def still(setup: Condition, sun: np.ndarray) -> Scene:
    return Scene(sun, np.ones(len(sun)), np.full(len(sun), setup.irradiance.stray))


def most_likely(setup: Condition, pattern: Any, scene: Scene, seen: np.ndarray) -> np.ndarray:
    """(N, 2) tangent offsets, degrees, from `scene.sun` at the maximum of the likelihood.

    Fisher scoring from the truth over two gnomonic coordinates, sunlight and stray light, the
    latter two with the Gaussian they are drawn from; the noise's own dependence on the signal is
    left out, as in the bound.
    """
    light, count = setup.irradiance, len(scene)
    first, second = tangent_axes(scene.sun)
    typical = np.array([0.0, 0.0, 1.0, light.stray])
    prior = np.array([0.0, 0.0, light.spread**-2, light.stray_spread**-2])
    steps = np.array([2e-4, 2e-4, 3e-3, 2e-4])

    def model(p: np.ndarray) -> np.ndarray:
        moved = scene.sun + p[:, :1] * first + p[:, 1:2] * second
        moved /= np.linalg.norm(moved, axis=1, keepdims=True)
        return setup.sensor.expected(
            replace(scene, sun=moved, irradiance=p[:, 2], stray=p[:, 3]), pattern
        )

    guess = np.tile(typical, (count, 1))
    for _ in range(5):
        mean = model(guess)
        weight = 1 / setup.sensor.variance(mean)
        slopes = np.stack(
            [
                (model(guess + h * e) - model(guess - h * e)) / (2 * h)
                for h, e in zip(steps, np.eye(4), strict=True)
            ],
            axis=2,
        )
        left = np.einsum("nmi,nm,nmj->nij", slopes, weight, slopes) + np.diag(prior)
        right = np.einsum("nmi,nm->ni", slopes, weight * (seen - mean)) - prior * (guess - typical)
        guess = guess + np.linalg.solve(left, right[:, :, None])[:, :, 0]
    return np.degrees(guess[:, :2])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "alpha", "beta"),
    [
        ("pd-maskless-pyramid", 22.0, -31.0),
        ("psd-single-aperture", -33.0, 48.0),
        ("ltf-maskless-cube", 25.0, 40.0),
        ("oi-maskless-pyramid", -18.0, 27.0),
        ("pva-maskless-sphere", 35.0, 50.0),
    ],
)
def test_bound_is_what_a_maximum_likelihood_fit_reaches(
    name: str, alpha: float, beta: float
) -> None:
    trials = 2000
    preset = datasets.get(name)
    setup, pattern = preset.setups["nominal"], preset.fixed_pattern("nominal")
    sun = from_angles(np.array([alpha]), np.array([beta]))
    bound = cramer_rao(setup.sensor, still(setup, sun), pattern, setup.irradiance)
    light, stray = setup.irradiance.draw(trials, generator("test", name))
    scene = Scene(np.repeat(sun, trials, axis=0), light, stray)
    seen = setup.sensor.observe(scene, pattern, NoiseStreams.named("test", "analog", name))
    errors = most_likely(setup, pattern, scene, seen)
    assert math.sqrt(np.mean(errors**2) * 2) == pytest.approx(bound.angle_deg[0], rel=0.1)
    spread = errors.std(axis=0)
    assert (np.abs(errors.mean(axis=0)) < 4 * spread / math.sqrt(trials)).all()


def test_counting_bound_falls_with_the_pulses() -> None:
    """Counts are whole and little else: on average over what is left of them, a step's share."""
    setup = datasets.get("ltf-maskless-cube").setups["nominal"]
    sun = from_angles(np.linspace(-50.0, 50.0, 400), np.linspace(35.0, 55.0, 400))
    found = []
    for gate in (0.1, 0.4):
        sensor = replace(setup.sensor, readout=replace(setup.sensor.readout, gate_s=gate))
        pattern = sensor.fixed_pattern("test")
        found.append(cramer_rao(sensor, still(setup, sun), pattern, LIGHT).rms_deg)
    assert found[0] / found[1] == pytest.approx(4.0, rel=0.15)


@pytest.mark.parametrize("name", ["psd-single-aperture", "pd-maskless-pyramid", "pd-slit"])
def test_amplifier_limited_bound_falls_in_proportion_to_the_light(name: str) -> None:
    setup = datasets.get(name).setups["nominal"]
    sun = from_angles(np.array([20.0, -12.0]), np.array([15.0, 30.0]))
    found = []
    for brighter in (1.0, 3.0):
        readout = setup.sensor.readout
        readout = replace(
            readout,
            sunlit_ua=brighter * readout.sunlit_ua,
            full_scale_ua=4.0 * readout.full_scale_ua,  # which holds three times the light
            bits=readout.bits + 2,
        )
        sensor = replace(setup.sensor, readout=replace(readout, integration_s=1e3))
        pattern = sensor.fixed_pattern("test")
        found.append(cramer_rao(sensor, still(setup, sun), pattern, LIGHT).angle_deg)
    assert found[0] / found[1] == pytest.approx(3.0, rel=0.01)


def test_a_position_sensor_is_bounded_by_its_balance() -> None:
    """On the boresight every electrode has I/4, so s_a has the variance 4 sigma^2 / I^2.

    Sunlight scales all four alike and so takes nothing from the balances; with stray light known
    ``sigma_beta = L / (2 h) * 2 sigma / I``.
    """
    setup = datasets.get("psd-single-aperture").setups["linear"]
    readout = replace(setup.sensor.readout, bits=24, gain_mismatch=0.0, integration_s=1e3)
    camera = replace(setup.sensor.camera, assembly=type(setup.sensor.camera.assembly)())
    sensor = replace(setup.sensor, readout=readout, camera=camera)
    scene = Scene(np.array([[0.0, 0.0, 1.0]]), np.ones(1), np.zeros(1))
    bound = cramer_rao(sensor, scene, sensor.fixed_pattern("test"), LIGHT)
    expected = math.degrees(4.0 / (2 * 1.5) * 2 * 0.01 / 100.0)
    assert bound.alpha_deg[0] == pytest.approx(expected, rel=2e-3)
    assert bound.beta_deg[0] == pytest.approx(expected, rel=2e-3)


def test_stray_light_that_varies_costs_the_pyramid_dearly() -> None:
    """All faces lean alike to the boresight, so stray light passes for a Sun nearer to it."""
    preset = datasets.get("pd-maskless-pyramid")
    plain = preset.bound("nominal", "calibration").rms_deg
    assert preset.bound("stray-light", "calibration").rms_deg > 3 * plain


def test_more_faces_bound_closer() -> None:
    """Sixteen cells on a sphere beat six panels of the same relative noise, on equal terms."""
    sphere, panels = (datasets.get(f"pva-maskless-{kind}") for kind in ("sphere", "panels"))
    found = [
        np.median(preset.bound("nominal", "calibration").angle_deg) for preset in (sphere, panels)
    ]
    assert found[0] < found[1]
