"""The verdict follows from errors, noise, halves, patterns and gaps; next poses fill the gaps."""

from __future__ import annotations

import re

import bench
import numpy as np
import pytest
from samples import samples

from algorithms.angles import separation_deg
from calibrate.halves import Halves
from calibrate.verdict import Pattern, _pattern, judge, next_poses, patterns_in

NONE = np.empty((0, 3))
SMOOTH = (Pattern("the direction: a smooth pattern over the field", 0.6, 1e-9),)
ANGLES = bench.grid(21, 40.0)
SUN = bench.sun_of(ANGLES)


@pytest.mark.parametrize(
    ("left_out_and_fitted", "split", "patterns", "gap", "said"),
    [
        ((0.1, 0.1), Halves(1.0, 0.5), (), 2.0, "good: .* noise is 0.1 deg"),
        ((0.3, 0.1), Halves(1.0, 0.5), (), 2.0, "poses missing: .* 0.3 deg, those fitted 0.1 deg"),
        ((0.1, 0.1), Halves(1.0, 0.5), (), 7.0, "poses missing: .* are 7 steps from any pose"),
        ((0.1, 0.1), Halves(3.0, 1e-6), (), 2.0, "model misfit: .* differ 3 times as much"),
        ((0.1, 0.1), Halves(3.0, 0.01), (), 2.0, "good: .* noise is"),
        ((0.2, 0.2), Halves(1.0, 0.5), SMOOTH, 2.0, "model misfit: .* 0.2 deg .* a smooth pattern"),
    ],
)
def test_the_word_follows_from_the_numbers(
    left_out_and_fitted: tuple[float, float],
    split: Halves,
    patterns: tuple[Pattern, ...],
    gap: float,
    said: str,
) -> None:
    found = judge(*left_out_and_fitted, 0.1, 0.0, split, patterns, NONE, gap)
    assert re.match(said, f"{found.word}: {found.reason}")


def normal(count: int) -> np.ndarray:
    return np.random.default_rng(3).normal(0.0, 1e-3, (count, 3))


def test_a_pattern_counts_beyond_what_chance_explains() -> None:
    """One column of a straight line explains 1 of 10 degrees of freedom of errors at random."""
    line = np.linspace(-1.0, 1.0, 11)
    whole = _pattern("a line", line[:, None], np.column_stack([line, -2.0 * line]))
    assert whole is not None
    assert whole.share == pytest.approx(0.9)
    bent = line**2  # orthogonal to the line: it explains nothing
    none = _pattern("a line", line[:, None], np.column_stack([bent, bent]))
    assert none is not None
    assert none.share == 0.0


def test_a_run_with_an_offset_of_its_own_is_the_pattern() -> None:
    run = np.arange(len(SUN)) % 3  # every run takes poses all over the field
    off = normal(len(SUN)) + np.where((run == 1)[:, None], [4e-3, 0.0, 0.0], 0.0)
    found = patterns_in(off, samples(SUN, SUN, run=run))
    assert [one.name for one in found] == ["the run: an offset of its own in some"]
    assert found[0].share > 0.5


def test_the_next_pose_lies_in_the_hole_of_the_field() -> None:
    hole = bench.sun_of(np.array([[15.0, -10.0]]))
    poses = SUN[separation_deg(SUN, np.broadcast_to(hole, SUN.shape)) > 12.0]
    found, gap = next_poses(poses)
    assert separation_deg(found[:1], hole)[0] < 3.0
    assert 12.0 / 4.0 <= gap <= 12.0 / 3.0  # poses are 3 to 4 deg apart
