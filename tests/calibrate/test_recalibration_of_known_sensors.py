"""What a few poses say of a sensor whose answers are a formula: a turn, an offset, or nothing."""

from __future__ import annotations

from pathlib import Path

import bench
import numpy as np
import pytest
from numpy.typing import NDArray

from calibrate.recalibration import recalibrate
from calibrate.roles import guess
from calibrate.table import read_table

Array = NDArray[np.float64]
RNG = np.random.default_rng(5)
SUN = bench.sun_of(RNG.uniform(-40.0, 40.0, (12, 2)))
SPOTS = bench.CENTRE + bench.FOCAL * SUN[:, :2] / SUN[:, 2:] + RNG.normal(0.0, 0.05, (12, 2))
VECTOR = ["sun_x", "sun_y", "sun_z"]
NOT_TURNED = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class Pinhole:
    """A camera that answers spots of which x is at most so much below y."""

    def __init__(self, path: Path, below: float = np.inf) -> None:
        self.settings = guess(read_table(path))
        self.below = below

    def predict(self, features: Array, _: object = None) -> Array:
        tangents = (features - bench.CENTRE) / bench.FOCAL
        sun = np.column_stack([tangents, np.ones(len(tangents))])
        sun /= np.linalg.norm(sun, axis=1)[:, None]
        sun[features[:, 1] - features[:, 0] > self.below] = np.nan
        return sun


def spots(path: Path, features: Array, sun: Array = SUN) -> Path:
    return bench.write(path, ["x_px", "y_px", *VECTOR], features, sun)


def test_moved_readings_are_an_offset_that_a_wrong_pose_does_not_move(tmp_path: Path) -> None:
    sun = SUN.copy()
    sun[3] = [0.0, 0.0, 1.0]
    path = spots(tmp_path / "few.csv", SPOTS + np.array([3.0, -4.0]), sun)
    found = recalibrate([path], Pinhole(path))
    assert found.kinds == ("offset",)
    assert found.offset == pytest.approx((3.0, -4.0), abs=0.1)
    assert found.rotation == NOT_TURNED
    assert found.gain == (1.0, 1.0)
    assert found.after.median_deg < 0.03
    assert found.before.median_deg > 0.5
    assert found.after.largest_deg > 10.0  # the wrong pose is not hidden
    for errors in (found.before, found.after):
        said = f"median {errors.median_deg:.3g}, largest {errors.largest_deg:.3g}"
        assert f"{errors.rms_deg:.3g} deg RMS ({said})" in found.sentence()


def test_poses_at_the_edge_of_the_old_field_settle_no_offset(tmp_path: Path) -> None:
    edge = np.repeat(SPOTS[:, [0]].round(3), 2, axis=1)
    path = spots(tmp_path / "few.csv", edge + np.array([3.0, 3.0]))
    found = recalibrate([path], Pinhole(path, below=0.0))
    assert found.offset == (0.0, 0.0)
    assert found.samples == 12


@pytest.mark.parametrize("moved", [60.0, 200.0])
def test_an_offset_far_beyond_the_spread_of_few_poses_is_found_whole(
    tmp_path: Path, moved: float
) -> None:
    rng = np.random.default_rng(6)
    sun = bench.sun_of(rng.uniform(-1.0, 1.0, (12, 2)))
    seen = bench.CENTRE + bench.FOCAL * sun[:, :2] / sun[:, 2:] + rng.normal(0.0, 0.05, (12, 2))
    path = spots(tmp_path / "few.csv", seen + np.array([moved, 0.0]), sun)
    found = recalibrate([path], Pinhole(path))
    assert found.kinds == ("offset",)
    assert found.offset == pytest.approx([moved, 0.0], abs=0.2)
    assert found.after.rms_deg < 0.05
