"""Rows that are kept, left out or called wrong, and columns that are missing."""

from __future__ import annotations

import bench
import numpy as np
import pytest
from samples import spot_table, table

from calibrate.readings import BEHIND, readings_of
from calibrate.robust import wrong_poses
from calibrate.roles import guess
from calibrate.table import TableError

ANGLES = bench.grid(15, 40.0)
SUN = bench.sun_of(ANGLES)
SPOTS = bench.spots(SUN, 1)
VECTOR = ("sun_x", "sun_y", "sun_z")


def test_rows_with_the_light_behind_are_kept_where_asked_for() -> None:
    made = spot_table(SPOTS, np.where(ANGLES > 30.0, 120.0, ANGLES))
    settings = guess(made)
    front, every = (readings_of(made, settings, behind=behind) for behind in (False, True))
    assert front.dropped == {BEHIND: len(ANGLES) - len(front)}
    assert len(every) == len(ANGLES)
    assert (every.sun[:, 2] > 0).sum() == len(front)


def test_a_file_without_readings_of_known_names_is_refused() -> None:
    with pytest.raises(TableError, match="no columns of readings recognised among spin, note;"):
        guess(table(("spin", "note", *VECTOR), SPOTS, SUN))


@pytest.mark.parametrize(("share", "listed"), [(0.2, True), (0.4, False)])
def test_at_most_a_quarter_of_the_poses_are_called_wrong(share: float, listed: bool) -> None:
    rng = np.random.default_rng(4)
    wrong = rng.choice(len(SUN), int(share * len(SUN)), replace=False)
    sun = SUN.copy()
    sun[wrong] += rng.normal(0.0, 0.3, (len(wrong), 3))
    sun /= np.linalg.norm(sun, axis=1)[:, None]
    found = wrong_poses(SPOTS, sun)
    if listed:
        assert found[wrong].mean() > 0.8
    else:
        assert not found.any()
