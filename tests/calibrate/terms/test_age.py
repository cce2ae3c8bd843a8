"""What age did to a sensor whose answers are a formula: gains, dark levels, scale, two at once."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import bench
import numpy as np
import pytest

from algorithms.angles import separation_deg
from algorithms.contract import Floats
from calibrate.readings import quadrant_balances
from calibrate.recalibration import Correction, recalibrate
from calibrate.settings import Settings, parse_settings

FACES = ["xp", "xm", "yp", "ym", "zp", "zm"]
VECTOR = ["sun_x", "sun_y", "sun_z"]
NORMALS = np.repeat(np.eye(3), 2, axis=0) * np.tile([1.0, -1.0], 3)[:, None]
KINDS = {6: ("channels", FACES), 4: ("quadrants", ["a", "b", "c", "d"]), 2: ("spot", ["x", "y"])}


def settings(count: int) -> Settings:
    kind, names = KINDS[count]
    stated = {
        "readings": {"kind": kind, "columns": names},
        "direction": {"columns": VECTOR, "form": "vector"},
    }
    return parse_settings(stated, "made")


def box(signals: Floats, _: Any = None) -> Floats:
    """Direction by the brighter of two opposite cells."""
    plus, minus = signals[:, ::2], signals[:, 1::2]
    sun = np.where(plus > minus, plus, -minus)
    return np.asarray(sun / np.linalg.norm(sun, axis=1)[:, None])


def plane(balances: Floats, _: Any = None) -> Floats:
    sun = np.column_stack([balances, np.ones(len(balances))])
    return np.asarray(sun / np.linalg.norm(sun, axis=1)[:, None])


def cells(sun: Floats, seed: int, noise: float = 2e-3) -> Floats:
    """Currents of six faces of a cube that are cosines."""
    light = np.maximum(sun @ NORMALS.T, 0.0)
    return np.asarray(light + np.random.default_rng(seed).normal(0.0, noise, light.shape))


def quadrants(sun: Floats) -> Floats:
    """Four signals whose balances are the tangents."""
    u, v = (sun[:, :2] / sun[:, 2:]).T
    signals = [(1 - u) * (1 + v), (1 + u) * (1 + v), (1 + u) * (1 - v), (1 - u) * (1 - v)]
    return np.column_stack(signals) * sun[:, 2:]


def corrected(tmp_path: Path, signals: Floats, sun: Floats, predict: Any) -> Correction:
    made = settings(signals.shape[1])
    path = bench.write(tmp_path / "few.csv", [*KINDS[signals.shape[1]][1], *VECTOR], signals, sun)
    return recalibrate([path], SimpleNamespace(settings=made, predict=predict, stated_deg=0.2))


@pytest.mark.parametrize(
    ("dimmed", "count"), [({0: 0.9, 3: 0.6}, 8), ({4: 0.5}, 20), ({1: 0.7}, 50)]
)
def test_dimmed_cells_are_named_and_no_others(
    tmp_path: Path, dimmed: dict[int, float], count: int
) -> None:
    gain = np.array([dimmed.get(at, 1.0) for at in range(6)])
    sun = bench.sphere(count, 11)
    found = corrected(tmp_path, cells(sun, 1) * gain, sun, box)
    assert found.kinds == ("gain",)
    assert {at for at in range(6) if found.gain[at] != 1.0} == set(dimmed)
    assert found.gain == pytest.approx(gain, abs=0.02)
    test = bench.sphere(300, 12)
    answers = box(cells(test, 2) * gain / np.asarray(found.gain))
    clean = box(cells(test, 2))
    assert np.sqrt(np.mean(separation_deg(answers, test) ** 2)) < 2.0 * np.sqrt(
        np.mean(separation_deg(clean, test) ** 2)
    )


def test_a_dimmed_cell_and_a_turn_are_told_apart(tmp_path: Path) -> None:
    sun, turn = bench.sphere(40, 13), bench.turn("y", 1.5)
    gain = np.array([1.0, 1.0, 0.8, 1.0, 1.0, 1.0])
    found = corrected(tmp_path, cells(sun, 3) * gain, sun @ turn.T, box)
    assert set(found.kinds) == {"gain", "boresight"}
    assert found.gain == pytest.approx(gain, abs=0.01)
    assert np.asarray(found.rotation) == pytest.approx(turn, abs=3e-3)


def test_a_dark_level_of_one_channel_is_an_offset_of_it(tmp_path: Path) -> None:
    sun, dark = bench.sphere(40, 14), np.array([0.0, 0.0, 0.06, 0.0, 0.0, 0.0])
    found = corrected(tmp_path, cells(sun, 4) + dark, sun, box)
    assert found.kinds == ("offset",)
    assert found.offset == pytest.approx(dark, abs=5e-3)


def test_a_dimmed_quadrant_is_a_gain_of_its_reading(tmp_path: Path) -> None:
    sun = bench.sun_of(np.random.default_rng(6).uniform(-20.0, 20.0, (20, 2)))
    gain = np.array([1.0, 1.0, 0.85, 1.0])
    noise = np.random.default_rng(7).normal(0.0, 1e-3, (20, 4))
    found = corrected(tmp_path, quadrants(sun) * gain + noise, sun, plane)
    assert found.kinds == ("gain",)
    assert found.gain == pytest.approx(gain, abs=5e-3)
    balances = quadrant_balances(quadrants(sun) * gain / np.asarray(found.gain))
    assert np.max(separation_deg(plane(balances), sun)) < 0.1


def test_a_spot_pattern_that_grew_is_a_scale(tmp_path: Path) -> None:
    sun = bench.sun_of(np.random.default_rng(8).uniform(-40.0, 40.0, (20, 2)))
    spots = 500.0 + 350.0 * 1.01 * sun[:, :2] / sun[:, 2:]
    spots += np.random.default_rng(9).normal(0.0, 0.05, spots.shape)
    found = corrected(tmp_path, spots, sun, lambda f, _: plane((f - 500.0) / 350.0))
    assert found.kinds == ("scale",)
    assert found.gain == pytest.approx((1.01, 1.01), abs=1e-3)


@pytest.mark.parametrize("wrong", [0, 2])
@pytest.mark.parametrize("seed", range(2))
def test_a_sensor_as_it_was_gets_no_correction_by_wrong_poses(
    tmp_path: Path, seed: int, wrong: int
) -> None:
    sun = bench.sphere(20, 100 + seed)
    signals = cells(sun, seed)
    sun[:wrong] = bench.sphere(wrong, 200 + seed)
    found = corrected(tmp_path, signals, sun, box)
    assert found.kinds == ()
    assert found.gain == (1.0,) * 6
