"""The Earth's light as compensations compute or estimate it, against the simulator's."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from algorithms.calibration.ground_light import EARTH_RADIUS_KM, ground_light, ground_points
from algorithms.compensations.interference.computed_earth import ComputedEarth, earth_light
from algorithms.compensations.interference.computed_earth_balance import ComputedEarthBalance
from algorithms.compensations.interference.estimated_earth import EstimatedEarth
from algorithms.extractors.currents.photodiode import VoltageBalance
from benchmark import datasets
from benchmark.simulator.light.environment import Earth


@pytest.mark.parametrize("altitude_km", [400.0, 600.0, 1200.0])
def test_light_of_the_ground_is_the_simulators(altitude_km: float) -> None:
    """By other lines of sight, with nadir, Sun and faces anywhere."""
    rng = np.random.default_rng(11)
    sun, nadir, faces = (
        v / np.linalg.norm(v, axis=1, keepdims=True)
        for v in (rng.standard_normal((count, 3)) for count in (400, 400, 5))
    )
    found = 0.3 * earth_light(sun, nadir, faces, altitude_km)
    exact = Earth(altitude_km=altitude_km, rings=40, spokes=120).response(
        sun, nadir, faces, "cosine"
    )
    assert exact.max() > 0.05
    np.testing.assert_allclose(found, exact, atol=1e-3)


def test_a_flown_cube_is_left_with_a_small_part_of_the_earths_light() -> None:
    """Nadir is read to half a degree, faces warm and age since they were calibrated."""
    preset: Any = datasets.get("pd-orbit")
    known = preset.generate("nominal", "calibration")
    flown = preset.generate("nominal", "test")
    sensor = preset.condition("nominal").sensor
    clean = ComputedEarth(sensor.normals).fit(known.observations, known.sun, known.context)
    assert clean.reflectance_ == pytest.approx(0.3, abs=0.01)
    earth = preset.scene("nominal", "test").albedo * sensor.readout.sunlit_ua
    lit = earth.max(axis=1) > 1.0
    left = flown.observations - clean.transform(flown.observations, flown.context) - earth
    assert np.sqrt(np.mean(left[lit] ** 2)) < 0.08 * np.sqrt(np.mean(earth[lit] ** 2))


@pytest.mark.parametrize(
    ("condition", "share"),
    [("albedo-clouds", 0.4), pytest.param("nominal", 1.02, marks=pytest.mark.slow)],
)
def test_faces_away_from_the_sun_tell_of_the_clouds(condition: str, share: float) -> None:
    """Light that is left on a flown cube, over what a uniform Earth leaves."""
    preset: Any = datasets.get("pd-orbit")
    known, flown = (preset.generate(condition, split) for split in ("calibration", "test"))
    sensor = preset.condition(condition).sensor
    without = preset.generate("no-albedo", "test").observations
    lit = ~flown.context["eclipse"]
    left = []
    for compensation in (EstimatedEarth, ComputedEarth):
        clean = compensation(sensor.normals).fit(known.observations, known.sun, known.context)
        off = clean.transform(flown.observations, flown.context) - without
        left.append(float(np.sqrt(np.mean((off - np.mean(off, axis=0))[lit] ** 2))))
    assert left[0] < share * left[1]


@pytest.mark.parametrize("seed", [5, 10])
def test_the_spread_of_a_ground_is_found_with_its_length(seed: int) -> None:
    """Reflectances drawn anew for each sample, alike over 1000 km, by the ground's own matrix.

    Of seed 10, weights of what a regression without noise explains left no spread at all.
    """
    rng = np.random.default_rng(seed)
    sun, nadir = (
        v / np.linalg.norm(v, axis=1, keepdims=True) for v in rng.standard_normal((2, 3000, 3))
    )
    faces = np.vstack(
        [np.eye(3), -np.eye(3), np.array([[1.0, 1.0, 1.0], [-1.0, -1.0, 1.0]]) / 3**0.5]
    )
    ground = EARTH_RADIUS_KM * ground_points(600.0)
    apart = np.linalg.norm(ground[:, None] - ground, axis=2)
    # Cholesky: which field is drawn does not depend on signs that another LAPACK turns
    alike = 0.06**2 * np.exp(-((apart / 1000.0) ** 2) / 2.0) + 1e-9 * np.eye(len(ground))
    drawn = rng.multivariate_normal(np.full(192, 0.3), alike, len(sun), method="cholesky")
    readings = np.maximum(sun @ faces.T, 0.0) + rng.normal(0.0, 1e-3, (len(sun), len(faces)))
    for rows, directions, light in ground_light(sun, nadir, 600.0):
        seen = np.maximum(directions @ faces.T, 0.0)
        readings[rows] += np.einsum("nj,nj,njk->nk", drawn[rows], light, seen)
    clean = EstimatedEarth(tuple(map(tuple, faces))).fit(readings, sun, {"nadir": nadir})
    assert np.sqrt(np.sum(clean.spread_[1:] ** 2)) == pytest.approx(0.06, rel=0.1)
    assert clean.noise_ == pytest.approx(1e-3, rel=0.1)


@pytest.mark.slow
def test_balances_of_flown_quadrants_are_nearly_those_without_an_earth() -> None:
    """Against the same readings, noise and all, under a black Earth."""
    preset: Any = datasets.get("qpd-orbit")
    splits = {
        (condition, split): preset.generate(condition, split)
        for condition in ("nominal", "no-albedo")
        for split in ("calibration", "test")
    }
    balance = {key: VoltageBalance().extract(one.observations) for key, one in splits.items()}
    known, flown = splits["nominal", "calibration"], splits["nominal", "test"]
    geometry = preset.geometry
    clean = ComputedEarthBalance(
        geometry.focal_length_mm, geometry.aperture_width_mm, geometry.half_fov_deg
    ).fit(balance["nominal", "calibration"], known.sun, known.context)
    lit = ~flown.context["eclipse"]
    before, after = (
        np.sqrt(np.nanmean((found - balance["no-albedo", "test"])[lit] ** 2))
        for found in (
            balance["nominal", "test"],
            clean.transform(balance["nominal", "test"], flown.context),
        )
    )
    assert after < 0.2 * before
