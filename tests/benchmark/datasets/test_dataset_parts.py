"""A dataset of a sensor that does nothing but tell what it was shown: streams, batches, cards."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets import Condition, Preset
from benchmark.datasets.fields import AngleField, SphereField
from benchmark.datasets.repeats import Repeats
from benchmark.seeds import generator
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.scene import Scene

LIGHT = Irradiance(spread=0.1, stray=0.3, stray_spread=0.02)
BUILT = Assembly(tilt_x_deg=0.1, tilt_y_deg=-0.3, offset_x_mm=0.02)
ASKED: list[int] = []  # how many samples sensors were shown at a time


@dataclass(frozen=True)
class Teller:
    """Says what it was shown: the Sun, both lights, its window, a number of its unit, noise."""

    level: float = 1.0
    assembly: Assembly = BUILT

    def fixed_pattern(self, *names: str | int) -> dict[str, Any]:
        return {"unit": np.array([float(len(repr(names)))]), "names": np.array([repr(names)])}

    def origins(self, sun: Any, generator: np.random.Generator) -> Any:
        return generator.integers(0, 1000, (len(sun), 2))

    def observe(self, scene: Scene, pattern: Any, streams: Any) -> Any:
        ASKED.append(len(scene))
        columns = (scene.sun, scene.irradiance, scene.stray, scene.origin_px)
        noise = streams.gaussian.standard_normal(len(scene))
        unit = np.full(len(scene), self.level * pattern["unit"][0])
        return np.column_stack([*columns, unit, noise])


def fake(**changed: Any) -> Preset:
    made: dict[str, Any] = {
        "name": "fake-teller",
        "version": 3,
        "detector": "PD",
        "mask": "Slit",
        "observation": Observation.CURRENTS,
        "units": "none",
        "geometry": SensorGeometry(half_fov_deg=20.0),
        "setups": {
            "nominal": Condition("As it is.", Teller(), LIGHT),
            "brighter": Condition("More.", Teller(level=2.0), LIGHT),
            "longer": Condition(
                "Another design.", Teller(), LIGHT, geometry=SensorGeometry(focal_length_mm=2.0)
            ),
        },
        "directions": AngleField(20.0, steps=5, test_samples=11),
        "follows": ("Nobody2020",),
        "description": "Made up.",
        "repeats": Repeats(poses=3, passes=4),
    }
    return Preset(**{**made, **changed})


@pytest.fixture(autouse=True)
def nothing_asked():
    ASKED.clear()


# Batches


def test_repeats_are_poses_of_the_test_split_pass_after_pass() -> None:
    one = fake()
    test, repeat = one.scene("nominal", "test"), one.scene("nominal", "repeat")
    # every third of 11, from the middle of the first third
    assert one.repeats.pose_indices(11).tolist() == [1, 5, 9]
    rows = [1, 5, 9] * 4
    for name in ("sun", "irradiance", "stray", "origin_px"):
        np.testing.assert_array_equal(getattr(repeat, name), getattr(test, name)[rows])


@pytest.mark.parametrize(
    ("poses", "samples", "chosen"),
    [
        (1, 9, [4]),
        (2, 10, [2, 7]),
        (4, 4, [0, 1, 2, 3]),
        (9, 3, [0, 1, 2]),
        (5, 12, [1, 3, 6, 8, 10]),
    ],
)
def test_poses_stand_in_the_middle_of_equal_parts(
    poses: int, samples: int, chosen: list[int]
) -> None:
    assert Repeats(poses, 2).pose_indices(samples).tolist() == chosen
    card = Repeats(poses, 2).card(samples)
    assert (card["samples"], card["poses"], card["passes"]) == (2 * len(chosen), len(chosen), 2)


@pytest.mark.parametrize("n", [0, -1])
def test_less_than_one_sample_is_refused(n: int) -> None:
    with pytest.raises(ValueError, match=rf"^n\b.*\b1\b.* {n}$"):
        fake().generate("nominal", "test", n)


# Directions


def test_a_turntable_s_grid_has_its_edges_and_alpha_is_slow() -> None:
    field = AngleField(30.0, steps=3, test_samples=4000)
    grid = field.sun("calibration", generator("unused"))
    alpha = np.repeat([-30.0, 0.0, 30.0], 3)
    beta = np.tile([-30.0, 0.0, 30.0], 3)
    np.testing.assert_allclose(grid, from_angles(alpha, beta), atol=1e-15)
    drawn = field.sun("test", generator("test"))
    angles = np.degrees(np.arctan(drawn[:, [1, 0]] / drawn[:, 2:]))
    share = generator("test").random((4000, 2))
    np.testing.assert_allclose(angles, 60.0 * share - 30.0, atol=1e-9)
    assert field.card()["calibration"]["samples"] == 9
    assert field.card()["test"]["samples"] == 4000


def test_a_sphere_is_covered_evenly() -> None:
    field = SphereField(calibration_samples=200, test_samples=3000)
    lattice = field.sun("calibration", generator("unused"))
    np.testing.assert_allclose(np.linalg.norm(lattice, axis=1), 1.0, rtol=1e-12)
    np.testing.assert_allclose(lattice[:, 2], 1.0 - (2.0 * np.arange(200) + 1.0) / 200.0)
    turn = np.unwrap(np.arctan2(lattice[:, 1], lattice[:, 0]))
    golden = math.pi * (3.0 - math.sqrt(5.0))
    np.testing.assert_allclose(np.diff(turn), golden, rtol=1e-9)
    nearest = np.sort(np.degrees(np.arccos(np.clip(lattice @ lattice.T, -1, 1))), axis=1)[:, 1]
    assert nearest.min() > 0.7 * nearest.max() > 5.0
    drawn = field.sun("test", generator("test"))
    assert drawn.shape == (3000, 3)
    np.testing.assert_allclose(drawn.mean(axis=0), 0.0, atol=0.05)
    np.testing.assert_allclose(drawn.T @ drawn / 3000, np.eye(3) / 3, atol=0.03)
