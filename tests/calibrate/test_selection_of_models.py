"""Models are compared by samples left out: runs or blocks; what cannot be judged is refused."""

from __future__ import annotations

import bench
import numpy as np
import pytest
from samples import samples

from algorithms.contract import FeatureKind, SensorGeometry
from algorithms.discovery import discover_models
from calibrate.exclusions import kept_by_model, sound_of
from calibrate.readings import Readings
from calibrate.roles import guess
from calibrate.selection import Candidate, compare, fold_of, geometry_of
from calibrate.table import Table

CAMERA = SensorGeometry(focal_length_mm=3.5, pixel_pitch_mm=0.01, centre_px=(512.0, 512.0))
GRID = bench.grid(6, 8.0)
HOMOGRAPHY = {"homography": discover_models()["homography"]}
AXES = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], dtype=float)


def camera(angles: np.ndarray, run: np.ndarray | None = None) -> Readings:
    sun = bench.sun_of(angles)
    return samples(bench.spots(sun, 1), sun, run=run)


def runs(*shifts: tuple[float, float]) -> Readings:
    """A run of 36 poses for each place in the field."""
    angles = np.vstack([GRID + shift for shift in shifts])
    return camera(angles, np.repeat(np.arange(len(shifts)), 36))


def table(*names: str) -> Table:
    return Table({name: np.ones(2) for name in names}, 2, "bench.csv", {})


def test_three_runs_of_twenty_samples_are_left_out_one_by_one() -> None:
    used = runs((0, 0), (0.3, 0), (0, 0.3))
    fold, word = fold_of(used)
    assert word == "runs"
    assert fold.tolist() == used.run.tolist()
    assert fold_of(used.only(used.run < 2))[1] == "blocks of poses"


def test_runs_of_fields_apart_judge_no_model() -> None:
    found = compare(runs((30, 0), (-20, 25), (-20, -25)), CAMERA, HOMOGRAPHY)
    assert [one.refused for one in found] == ["no sample left out was answered"]


def test_faces_that_nobody_stated_are_told_by_their_light() -> None:
    sun = bench.sphere(300, 1)
    names = ("xp", "xm", "yp", "ym", "zp", "zm")
    settings = guess(table(*names, "sun_x", "sun_y", "sun_z"))
    assert settings.sensor.face_normals is not None
    assert np.array_equal(settings.sensor.face_normals, AXES)
    unnamed = guess(table(*(f"ch{n}" for n in range(6)), "sun_x", "sun_y", "sun_z"))
    assert unnamed.readings.columns == tuple(f"ch{n}" for n in range(6))
    assert unnamed.sensor.face_normals is None
    told = geometry_of(samples(bench.faces(sun, 2), sun, FeatureKind.SIGNALS), unnamed)
    assert told.face_normals is not None
    assert np.array_equal(told.face_normals, AXES)


def test_a_run_that_is_off_is_left_out_with_its_turn_as_the_reason() -> None:
    used = runs((0, 0), (0.3, 0), (0, 0.3), (-0.3, 0), (0, -0.3), (35, 0))
    sun = used.sun.copy()
    sun[used.run == 2] = sun[used.run == 2] @ bench.turn("x", 3.0).T
    sound, excluded, off, fold = sound_of(samples(used.features, sun, run=used.run))
    assert [one.run for one in off] == [2]
    assert off[0].offset_deg == pytest.approx(3.0, abs=0.05)
    assert off[0].others_deg < 0.05
    assert set(sound.run) == {0, 1, 3, 4, 5}
    assert [(one.source, one.row) for one in excluded] == [("run2", 2 + 72 + n) for n in range(36)]
    assert {one.reason for one in excluded} == {f"run off by {off[0].offset_deg:.2f} deg"}
    assert fold is None


def test_a_wrong_pose_is_left_out_where_the_comparison_took_only_some_samples() -> None:
    used = camera(bench.grid(15, 30.0))
    sun = used.sun.copy()
    sun[100] = bench.turn("x", 8.0) @ sun[100]
    wrong = samples(used.features, sun)
    thinned = Candidate("homography", errors=np.full(len(wrong) // 2, 0.01))
    kept = kept_by_model(HOMOGRAPHY["homography"], thinned, wrong, wrong, CAMERA)
    assert not kept[100]
    assert kept.mean() > 0.97
