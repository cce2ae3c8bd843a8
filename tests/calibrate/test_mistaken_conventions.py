"""Mistakes of a bench in its conventions, each in a file of its own: found at no cost."""

from __future__ import annotations

from functools import cache

import bench
import mistakes
import numpy as np
import pytest

from calibrate.calibration import calibrate
from calibrate.readings import readings_of
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
        found = calibrate([made])
        assert found.findings == ()
        assert len(found.excluded) <= 0.01 * len(found.readings)
        return found.chosen.rms_deg

    return error


@pytest.mark.parametrize(("kind", "mistake"), CASES)
def test_a_convention_is_found_and_applied_at_no_cost(kind, mistake, sound, tmp_path):
    made = mistakes.mistaken(tmp_path / "bench.csv", kind, mistake, 1)
    found = calibrate([made], apply=True)
    assert [FOUND[mistake] in one.found for one in found.findings] == [True]
    assert found.applied == found.findings
    assert found.chosen.rms_deg <= 1.1 * sound(kind, 1)


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
    found = calibrate([made])
    new = readings_of(read_table(fresh), found.settings)
    predicted = found.model.predict(new.features, new.context)
    sigma = found.deviation_deg(new.features, dict(new.context))
    along = np.abs(tangent_offsets(predicted - new.sun, new.sun))
    known = np.isfinite(along).all(axis=1)
    assert known.mean() > 0.9
    assert 0.93 <= np.mean(along[known] <= 1.96 * sigma[known, None]) <= 0.97
