"""What a bench did otherwise is found in its file, and nothing is found where it did not."""

from __future__ import annotations

import numpy as np
import pytest
from bench import (
    CENTRE,
    HEADER,
    balances,
    electrodes,
    grid,
    quadrants,
    spots,
    sun_of,
    write,
)

from calibrate.conventions.finding import change_of
from calibrate.conventions.findings import findings
from calibrate.readings import readings_of
from calibrate.roles import guess
from calibrate.table import read_table

ANGLES = grid()
SUN = sun_of(ANGLES)
SPOTS = spots(SUN, 1)
X, Y, Z = SUN.T
BETA_INNER = np.degrees(np.column_stack([np.arctan2(Y, Z), np.arcsin(X)]))
AZIMUTH = np.degrees(np.column_stack([np.arctan2(Y, X), np.arcsin(Z)]))
TURNED = CENTRE + (SPOTS - CENTRE) @ np.array([[0.0, 1.0], [-1.0, 0.0]])

CASES = {
    "swapped": (HEADER, SPOTS[:, ::-1], ANGLES, {"apply": ("swap-xy",)}),
    "mirrored x": (HEADER, (SPOTS - CENTRE) * [-1, 1] + CENTRE, ANGLES, {"apply": ("mirror-x",)}),
    "mirrored y": (HEADER, (SPOTS - CENTRE) * [1, -1] + CENTRE, ANGLES, {"apply": ("mirror-y",)}),
    "inverted": (HEADER, 2 * CENTRE - SPOTS, ANGLES, {"apply": ("rotate-180",)}),
    "turned": (HEADER, TURNED, ANGLES, {"apply": ("rotate-270",)}),
    "radians": (
        ["x_px", "y_px", "theta_x", "theta_y"],
        SPOTS,
        np.radians(ANGLES),
        {"direction": {"unit": "rad"}},
    ),
    "other gimbal": (HEADER, SPOTS, BETA_INNER, {"direction": {"form": "beta-inner"}}),
    "a row late": (HEADER, np.roll(SPOTS, 1, axis=0), ANGLES, {"rows": {"shift": 1}}),
    "two rows early": (HEADER, np.roll(SPOTS, -2, axis=0), ANGLES, {"rows": {"shift": -2}}),
}


def found_in(path):
    table = read_table(path)
    settings = guess(table)
    return findings(readings_of(table, settings), settings), settings, table


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(name, marks=() if name in {"other gimbal", "a row late"} else pytest.mark.slow)
        for name in CASES
    ],
)
def test_a_changed_convention_is_found_and_its_change_mends_the_file(case, tmp_path):
    header, features, angles, change = CASES[case]
    found, settings, table = found_in(write(tmp_path / "bench.csv", header, features, angles))
    first = found[0]
    assert first.certain
    assert first.change == change
    changed = change_of(settings, first)
    left = findings(readings_of(table, changed), changed)
    assert [one.about for one in left if one.certain] == []


@pytest.mark.parametrize("names", [HEADER, ["x_px", "y_px", "azimuth_deg", "elevation_deg"]])
def test_nothing_is_found_where_a_file_keeps_what_its_names_say(names, tmp_path):
    angles = ANGLES if names == HEADER else AZIMUTH
    found, _, _ = found_in(write(tmp_path / "bench.csv", names, SPOTS, angles))
    assert found == []


def test_a_run_of_the_other_sign_is_named(tmp_path):
    flipped = SPOTS.copy()
    run = np.repeat([0, 1, 2], [200, 200, len(SPOTS) - 400])
    flipped[run == 1, 0] = 2 * CENTRE - flipped[run == 1, 0]
    order = np.random.default_rng(4).permutation(len(SPOTS))  # so that runs cover the same field
    path = write(tmp_path / "bench.csv", [*HEADER, "run"], *_ordered(flipped, run, order))
    found, _, _ = found_in(path)
    assert any(one.about == "runs" and "run 1" in one.found for one in found)


def _ordered(features, run, order):
    # the poses of each run are drawn from all over the grid
    angles, clean = ANGLES[order], SPOTS[order]
    mirrored = clean * [-1, 1] + [2 * CENTRE, 0]
    return np.where((run == 1)[:, None], mirrored, clean), angles, run.astype(float)


NARROW = sun_of(grid(21, 30.0))
WIDE = sun_of(grid(21, 55.0))
FOUR = ["q1", "q2", "q3", "q4"]
PAIRS = ["x_plus", "x_minus", "y_plus", "y_minus"]
QUADRANTS, ELECTRODES = quadrants(NARROW, 1), electrodes(WIDE, 1)


@pytest.mark.parametrize(
    ("names", "readings", "angles", "said"),
    [
        (FOUR, QUADRANTS[:, [1, 0, 3, 2]], grid(21, 30.0), "after mirror-x"),
        (FOUR, QUADRANTS, np.radians(grid(21, 30.0)), "seem to be radians"),
        (FOUR, QUADRANTS[:, [0, 2, 1, 3]], grid(21, 30.0), "in the order q1, q3, q2, q4"),
        (PAIRS, ELECTRODES[:, [1, 0, 3, 2]], grid(21, 55.0), "after rotate-180"),
        (
            ["balance_x", "balance_y"],
            balances(WIDE, 1)[:, ::-1],
            grid(21, 55.0),
            "after swap-xy",
        ),
    ],
    ids=["mirrored", "radians", "quadrant order", "inverted", "swapped"],
)
def test_conventions_of_other_sensors_are_found(names, readings, angles, said, tmp_path):
    path = write(tmp_path / "bench.csv", [*names, "theta_x_deg", "theta_y_deg"], readings, angles)
    found, _, _ = found_in(path)
    assert [said in one.found for one in found if one.certain] == [True]


@pytest.mark.parametrize(
    ("names", "readings", "half"), [(FOUR, QUADRANTS, 30.0), (PAIRS, ELECTRODES, 55.0)]
)
def test_nothing_is_found_of_sound_light(names, readings, half, tmp_path):
    header = [*names, "theta_x_deg", "theta_y_deg"]
    found, _, _ = found_in(write(tmp_path / "bench.csv", header, readings, grid(21, half)))
    assert [one for one in found if one.certain] == []
