"""Cramer-Rao bounds against Monte Carlo of a maximum-likelihood fit, and against scaling laws."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from shadows import shadows

from benchmark import datasets
from benchmark.datasets import Condition
from benchmark.metrics.bounds import cramer_rao
from benchmark.seeds import generator
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.readout.detectors import DarkCurrent
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.faces import FaceSensor
from benchmark.simulator.sensors.frames import FrameSensor


def setup_of(name: str, condition: str = "nominal") -> tuple[Condition, Any]:
    preset = datasets.get(name)
    return preset.setups[condition], preset.fixed_pattern(condition)


def scene_at(setup: Condition, alpha: list[float], beta: list[float]) -> Scene:
    sun = from_angles(np.array(alpha), np.array(beta))
    return still(setup, sun)


def still(setup: Condition, sun: np.ndarray) -> Scene:
    origin = setup.sensor.origins(sun, generator("test", "windows"))
    stray = np.full(len(sun), setup.irradiance.stray)
    return Scene(sun, np.ones(len(sun)), stray, origin)


def fitted_angles(setup: Condition, pattern: Any, scene: Scene, seen: np.ndarray) -> np.ndarray:
    """Maximum-likelihood (alpha, beta) of every sample, degrees: Gauss-Newton on four unknowns.

    Unknown are both angles, sunlight and stray light, the latter two with the Gaussian they are
    drawn from; steps and parameters are not those of the bound's own derivatives.
    """
    light, count = setup.irradiance, len(scene)
    sun = scene.sun
    start = np.degrees(np.arctan2(sun[:, [1, 0]], sun[:, 2:]))
    guess = np.column_stack([start, np.ones(count), np.full(count, light.stray)])
    prior_mean = np.array([0, 0, 1.0, light.stray])
    prior = np.array([0, 0, light.spread**-2, light.stray_spread**-2])
    steps = np.array([0.02, 0.02, 0.01, 0.0005])

    def model(p: np.ndarray) -> np.ndarray:
        moved = replace(scene, sun=from_angles(p[:, 0], p[:, 1]), irradiance=p[:, 2], stray=p[:, 3])
        return setup.sensor.expected(moved, pattern)

    for _ in range(4):
        mean = model(guess)
        weight = 1 / setup.sensor.variance(mean).reshape(count, -1)
        rest = (seen - mean).reshape(count, -1)
        slopes = np.stack(
            [
                ((model(guess + s * e) - model(guess - s * e)) / (2 * s)).reshape(count, -1)
                for s, e in zip(steps, np.eye(4), strict=True)
            ],
            axis=2,
        )
        left = np.einsum("nmi,nm,nmj->nij", slopes, weight, slopes) + np.diag(prior)
        right = np.einsum("nmi,nm,nm->ni", slopes, weight, rest) - prior * (guess - prior_mean)
        guess = guess + np.linalg.solve(left, right[:, :, None])[:, :, 0]
    return guess[:, :2]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "alpha", "beta", "trials"),
    [
        ("cmos-single-aperture", 41.3, -17.2, 350),
        ("qpd-single-aperture", 21.0, -9.0, 1500),
        ("pd-maskless-cube", 25.0, 40.0, 1500),
    ],
)
def test_bound_is_what_a_maximum_likelihood_fit_reaches(
    name: str, alpha: float, beta: float, trials: int
) -> None:
    setup, pattern = setup_of(name)
    one = scene_at(setup, [alpha], [beta])
    bound = cramer_rao(setup.sensor, one, pattern, setup.irradiance)
    light, stray = setup.irradiance.draw(trials, generator("test", name))
    origin = None if one.origin_px is None else np.repeat(one.origin_px, trials, axis=0)
    scene = Scene(np.repeat(one.sun, trials, axis=0), light, stray, origin)
    seen = setup.sensor.observe(scene, pattern, NoiseStreams.named("test", "monte-carlo", name))
    errors = fitted_angles(setup, pattern, scene, seen.astype(float)) - [alpha, beta]
    reached = errors.std(axis=0)
    assert reached[0] == pytest.approx(bound.alpha_deg[0], rel=0.1)
    assert reached[1] == pytest.approx(bound.beta_deg[0], rel=0.1)
    assert np.abs(errors.mean(axis=0)).max() < 4 * reached.max() / math.sqrt(trials)
    sun = from_angles(errors[:, 0] + alpha, errors[:, 1] + beta)
    apart = np.degrees(np.linalg.norm(np.cross(sun, one.sun), axis=1))
    assert math.sqrt(np.mean(apart**2)) == pytest.approx(bound.angle_deg[0], rel=0.1)


@pytest.mark.slow
def test_shot_limited_bound_falls_with_the_square_root_of_the_photons() -> None:
    setup, _ = setup_of("cmos-single-aperture")
    assert isinstance(setup.sensor, FrameSensor)
    scene = scene_at(setup, [10.0, 40.0], [-20.0, 5.0])
    found = []
    for electrons in (1e6, 4e6):
        detector = replace(
            setup.sensor.detector,
            sunlit_e=electrons,
            full_well_e=1e8,
            gain_e_per_dn=1.0,
            read_noise_e=0.0,
            bits=24,
        )
        sensor = replace(setup.sensor, detector=detector)
        pattern = sensor.fixed_pattern("test")
        found.append(cramer_rao(sensor, scene, pattern, setup.irradiance).angle_deg)
    assert found[0] / found[1] == pytest.approx(2.0, rel=0.01)


def bounds_by_pitch(sunlit_e: float, read_noise_e: float) -> list[np.ndarray]:
    """Bounds with pixels of 6, 3 and 1.5 micrometres, their light in proportion to their area.

    In the shadow of a hole, whose rim the Sun alone dims.
    """
    setup, _ = setup_of("cmos-single-aperture")
    mask = Mask((Aperture("round", 0.2, 0.2),), 0.01)
    camera = replace(setup.sensor.camera, mask=mask, focal_length_mm=1.2)
    found = []
    for ratio in (0.5, 0.25, 0.125):
        detector = replace(
            setup.sensor.detector,
            columns=2048,
            rows=2048,
            pitch_mm=0.012 * ratio,
            sunlit_e=sunlit_e * ratio**2,
            full_well_e=1e8,
            gain_e_per_dn=1.0,
            read_noise_e=read_noise_e,
            bits=24,
            prnu=0.0,
            dark=DarkCurrent(0.0),
        )
        sensor = shadows(setup.sensor, camera=camera, detector=detector, window_px=(256, 256))
        scene = scene_at(replace(setup, sensor=sensor), [10.0, 40.0], [-20.0, 5.0])
        pattern = sensor.fixed_pattern("test")
        found.append(cramer_rao(sensor, scene, pattern, setup.irradiance).angle_deg)
    return found


@pytest.mark.slow
def test_counting_photons_finer_pixels_gain_ever_less() -> None:
    """What a pixel blurs is lost at the dim rim of the spot: first order in the pitch."""
    coarse, middle, fine = bounds_by_pitch(sunlit_e=1e6, read_noise_e=0.0)
    once, twice = 1 - middle / coarse, 1 - fine / middle
    assert (once < 0.1).all()
    assert twice / once == pytest.approx(0.5, rel=0.1)


def test_read_noise_makes_finer_pixels_worse_in_proportion() -> None:
    """``sum (dS/dx)^2 / r^2``: pitch^4 a pixel, and pitch^-2 pixels."""
    _, middle, fine = bounds_by_pitch(sunlit_e=1e3, read_noise_e=1e3)
    assert fine / middle == pytest.approx(2.0, rel=0.03)


def test_a_signal_that_ends_within_the_step_is_not_observed() -> None:
    """A face that the Sun is about to leave: derivatives promise what one side does not keep."""
    setup, _ = setup_of("pd-maskless-cube")
    assert isinstance(setup.sensor, FaceSensor)
    # noise so low that a standard deviation is far below the differences' step
    readout = replace(setup.sensor.readout, noise_ua=1e-7, bits=40, integration_s=1e6)
    sensor = replace(setup.sensor, readout=readout)
    light = Irradiance(spread=0.02, stray=0.002, stray_spread=1e-3)
    scene = scene_at(replace(setup, sensor=sensor), [30.0, 0.0], [35.0, 0.0])
    sun = np.array([[0.0, 0.0, 1.0], *scene.sun[:1]])
    seen = cramer_rao(sensor, still(setup, sun), sensor.fixed_pattern("test"), light)
    assert seen.observable.tolist() == [False, True]


def test_a_step_that_is_none_is_refused() -> None:
    setup, pattern = setup_of("cmos-single-aperture")
    scene = scene_at(setup, [0.0], [0.0])
    with pytest.raises(ValueError, match="step_rad must be positive; got 0"):
        cramer_rao(setup.sensor, scene, pattern, setup.irradiance, 0.0)


def test_read_limited_bound_grows_in_proportion_to_the_noise() -> None:
    setup, pattern = setup_of("pd-maskless-cube")
    assert isinstance(setup.sensor, FaceSensor)
    # stray light as good as known, so that the amplifiers alone limit
    light = Irradiance(spread=0.02, stray=0.002, stray_spread=1e-7)
    scene = scene_at(setup, [30.0, 20.0], [35.0, -40.0])
    found = []
    for noise in (0.02, 0.2):
        readout = replace(setup.sensor.readout, noise_ua=noise, bits=24)
        sensor = replace(setup.sensor, readout=readout)
        found.append(cramer_rao(sensor, scene, pattern, light).angle_deg)
    assert found[1] / found[0] == pytest.approx(10.0, rel=0.02)


def test_bound_of_a_cosine_cube_is_the_textbook_one() -> None:
    """Three lit orthogonal faces measure I s; unknown I costs the radial part only: sigma/I."""
    setup, _ = setup_of("pd-maskless-cube", "cosine")
    assert isinstance(setup.sensor, FaceSensor)
    readout = replace(setup.sensor.readout, gain_mismatch=0.0, noise_ua=0.1, bits=24)
    sensor = replace(setup.sensor, readout=readout, normal_error_deg=0.0)
    light = Irradiance(spread=0.5, stray=0.0, stray_spread=1e-8)
    scene = scene_at(setup, [30.0, -20.0], [35.0, 40.0])
    found = cramer_rao(sensor, scene, sensor.fixed_pattern("test"), light).angle_deg
    assert found == pytest.approx(math.degrees(math.sqrt(2) * 0.1 / 100), rel=2e-3)


def test_kelly_dark_faces_leave_the_direction_unobservable() -> None:
    setup, pattern = setup_of("pd-maskless-cube")
    boresight = np.array([[0.0, 0.0, 1.0], [0.48, 0.6, 0.64]])
    bound = cramer_rao(setup.sensor, still(setup, boresight), pattern, setup.irradiance)
    assert bound.observable.tolist() == [False, True]
    assert np.isinf(bound.angle_deg[0])
    assert bound.rms_deg == bound.angle_deg[1]


def test_one_dark_axis_is_enough_to_lose_the_direction() -> None:
    setup, pattern = setup_of("pd-maskless-cube")
    in_face_plane = np.array([[0.0, 0.6, 0.8]])
    bound = cramer_rao(setup.sensor, still(setup, in_face_plane), pattern, setup.irradiance)
    assert not bound.observable[0]
    assert math.isnan(bound.rms_deg)


def test_sun_in_a_face_plane_of_a_cosine_cube_has_a_finite_bound() -> None:
    """The Sun's disc lights both opposite faces: half the slope each, so sqrt(2) on that axis."""
    setup, _ = setup_of("pd-maskless-cube", "cosine")
    assert isinstance(setup.sensor, FaceSensor)
    readout = replace(setup.sensor.readout, gain_mismatch=0.0, noise_ua=0.1, bits=24)
    sensor = replace(setup.sensor, readout=readout, normal_error_deg=0.0)
    light = Irradiance(spread=0.5, stray=0.0, stray_spread=1e-8)
    scene = still(setup, np.array([[0.0, 0.6, 0.8]]))
    bound = cramer_rao(sensor, scene, sensor.fixed_pattern("test"), light)
    assert bound.observable[0]
    expected = math.degrees(math.sqrt(1 + 2) * 0.1 / 100)
    assert bound.angle_deg[0] == pytest.approx(expected, rel=0.02)
