"""Thirteen mistakes of a bench, each in a file of its own: found, and what they cost."""

from __future__ import annotations

from functools import cache

import bench
import mistakes
import numpy as np
import pytest

from calibrate.calibration import calibrate
from calibrate.readings import readings_of
from calibrate.settings import Settings
from calibrate.table import read_table
from calibrate.uncertainty import tangent_offsets

pytestmark = pytest.mark.slow
FOUND = {
    "swapped": "after swap-xy",
    "mirrored": "after mirror-x",
    "inverted": "after rotate-180",
    "radians": "seem to be radians",
    "other gimbal": "of the form beta-inner",
    "azimuth and elevation": "of the form azimuth-elevation",
    "a row late": "1 row before their own",
    "quadrant order": "in the order q1, q3, q2, q4",
}
CASES = [
    *(("spots", mistake) for mistake in FOUND if mistake != "quadrant order"),
    *(("quadrants", mistake) for mistake in ("mirrored", "radians", "quadrant order")),
    *(("balances", mistake) for mistake in ("swapped", "azimuth and elevation", "a row late")),
    *(("electrodes", mistake) for mistake in ("inverted", "other gimbal")),
]
KINDS = [*mistakes.SENSORS, "faces"]


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """RMS error on samples left out of the file without a mistake, by kind and seed."""
    directory = tmp_path_factory.mktemp("sound")

    @cache
    def error(kind: str, seed: int) -> float:
        path = directory / f"{kind}{seed}.csv"
        made = (
            mistakes.on_sphere(path, seed)
            if kind == "faces"
            else mistakes.untouched(path, kind, seed)
        )
        found = calibrate(made.paths)
        assert found.findings == ()
        assert len(found.excluded) <= 0.01 * len(found.readings)
        return found.chosen.rms_deg

    return error


@pytest.mark.parametrize(("kind", "mistake"), CASES)
def test_a_convention_is_found_and_applied_at_no_cost(kind, mistake, sound, tmp_path):
    made = mistakes.mistaken(tmp_path / "bench.csv", kind, mistake, 1)
    found = calibrate(made.paths, apply=True)
    assert [FOUND[mistake] in one.found for one in found.findings] == [True]
    assert found.applied == found.findings
    assert found.chosen.rms_deg <= 1.1 * sound(kind, 1)


@pytest.mark.parametrize("kind", KINDS)
def test_wrong_poses_are_left_out_at_no_cost(kind, sound, tmp_path):
    path = tmp_path / "bench.csv"
    made = (
        mistakes.on_sphere(path, 1, wrong=0.05)
        if kind == "faces"
        else mistakes.mistaken(path, kind, "outliers", 1)
    )
    found = calibrate(made.paths)
    listed = {one.row - 2 for one in found.excluded if one.reason == "wrong pose"}
    assert len(made.wrong - listed) <= 0.1 * len(made.wrong)
    assert len(listed - made.wrong) <= 0.01 * len(found.readings)
    assert found.chosen.rms_deg <= 1.1 * sound(kind, 1)


@pytest.mark.parametrize("kind", mistakes.SENSORS)
def test_a_run_off_by_three_degrees_is_left_out_at_no_cost(kind, tmp_path):
    whole = calibrate(mistakes.run_off(tmp_path / "a.csv", kind, 1, bad=None).paths)
    found = calibrate(mistakes.run_off(tmp_path / "b.csv", kind, 1).paths)
    assert whole.off_runs == ()
    assert [one.run for one in found.off_runs] == [2]
    assert found.off_runs[0].offset_deg == pytest.approx(3.0, abs=0.2)
    assert found.chosen.rms_deg <= 1.1 * whole.chosen.rms_deg


def test_falling_readings_of_faces_are_found_and_applied(sound, tmp_path):
    made = mistakes.on_sphere(tmp_path / "bench.csv", 1, level=mistakes.LEVEL)
    found = calibrate(made.paths, apply=True)
    assert [one.about for one in found.applied] == ["light"]
    assert found.settings.readings.inverted
    assert np.asarray(found.settings.readings.dark) == pytest.approx(mistakes.LEVEL, abs=0.01)
    assert found.chosen.rms_deg <= 1.1 * sound("faces", 1)


@pytest.mark.parametrize("kind", ["quadrants", "electrodes"])
def test_falling_readings_are_found_and_cost_nothing_once_stated(kind, sound, tmp_path):
    made = mistakes.mistaken(tmp_path / "bench.csv", kind, "falling", 1)
    found = calibrate(made.paths)
    assert found.verdict.word == "conventions uncertain"
    assert any("fall when light rises" in one.found for one in found.findings)
    readings = found.settings.readings.model_copy(update={"inverted": True, "dark": mistakes.LEVEL})
    stated: Settings = found.settings.model_copy(update={"readings": readings})
    again = calibrate(made.paths, stated)
    assert again.findings == ()
    assert again.chosen.rms_deg <= 1.1 * sound(kind, 1)


def bench_inside(made: mistakes.Made) -> np.ndarray:
    """Larger of the two tangents of each pose of a file."""
    angles = np.loadtxt(made.paths[0], delimiter=",", skiprows=1)[:, -2:]
    sun = bench.sun_of(angles)
    return np.abs(sun[:, :2] / sun[:, [2]]).max(axis=1)


def test_a_fold_is_left_out(tmp_path):
    made = mistakes.beyond_fold(tmp_path / "bench.csv", 1)
    found = calibrate(made.paths)
    inside = np.abs(found.readings.sun[:, :2] / found.readings.sun[:, [2]]).max(axis=1)
    # the patch of light, 2 mm wide and 1.5 mm away, leaves a quadrant at 33.7 deg
    assert inside.max() < 0.8
    assert 25.0 < found.fold_deg < 40.0
    assert inside.max() > 0.6
    assert (inside < 0.5).sum() >= 0.99 * (bench_inside(made) < 0.5).sum()
    assert found.chosen.rms_deg < 0.07  # noise is 0.055 deg


@pytest.mark.parametrize("kind", mistakes.SENSORS)
def test_a_cross_misses_poses_and_one_axis_is_calibrated_as_such(kind, tmp_path):
    found = calibrate(mistakes.cross(tmp_path / "cross.csv", kind, 1).paths)
    assert found.verdict.word == "poses missing"
    assert found.fold_deg is None
    one = calibrate(mistakes.one_axis(tmp_path / "one.csv", kind, 1).paths)
    assert "one-axis calibration" in one.verdict.reason
    assert one.chosen.rms_deg < 3.0 * found.chosen.rms_deg


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("kind", KINDS)
def test_95_percent_intervals_cover_93_to_97_percent_of_fresh_poses(kind, seed, tmp_path):
    fresh = tmp_path / "fresh.csv"
    if kind == "faces":
        made = mistakes.on_sphere(tmp_path / "bench.csv", seed)
        sun = bench.sphere(4000, 90 + seed)
        names = [*mistakes.FACES, *mistakes.VECTOR_NAMES]
        bench.write(fresh, names, bench.faces(sun, 70 + seed), sun)
    else:
        sensor = mistakes.SENSORS[kind]
        made = mistakes.untouched(tmp_path / "bench.csv", kind, seed)
        drawn = np.random.default_rng(90 + seed)
        angles = drawn.uniform(-sensor.half_deg, sensor.half_deg, (4000, 2))
        readings = sensor.read(bench.sun_of(angles), 70 + seed)
        bench.write(fresh, [*sensor.names, *mistakes.ANGLE_NAMES], readings, angles)
    found = calibrate(made.paths)
    new = readings_of(read_table(fresh), found.settings)
    predicted = found.model.predict(new.features, new.context)
    sigma = found.deviation_deg(new.features, dict(new.context))
    along = np.abs(tangent_offsets(predicted - new.sun, new.sun))
    known = np.isfinite(along).all(axis=1)
    assert known.mean() > 0.9
    assert 0.93 <= np.mean(along[known] <= 1.96 * sigma[known, None]) <= 0.97
