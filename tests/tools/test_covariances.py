"""How stated covariances are judged: right ones, wrong ones, too few to tell, none."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from algorithms.measurement import Measurement
from tools.bench import covariances
from tools.bench.covariances import (
    CovarianceResult,
    extractors,
    measure,
    print_table,
    sets,
    verdicts,
)

ROW = CovarianceResult("shapes", "disc", "mirror", 1.04, 2000, 2000)


def test_what_is_judged_is_the_distance_from_one_where_enough_answers_tell():
    rows = [ROW, replace(ROW, squares=0.85), replace(ROW, squares=1.4, stated=300)]
    assert [verdict.value for verdict in verdicts(rows)] == pytest.approx([0.04, 0.15])
    assert [verdict.holds for verdict in verdicts(rows)] == [True, False]


@pytest.mark.slow
@pytest.mark.parametrize("stretch", [1.0, 2.0])
def test_squares_are_those_of_the_errors_in_units_of_what_is_stated(monkeypatch, stretch):
    """Errors drawn from a covariance, and from four times it, which oblique axes do not hide."""
    chosen = next(one for one in sets() if one.name == "disc")
    stated = np.array([[0.5, 0.3], [0.3, 0.4]])

    class Method:
        @staticmethod
        def measure(frames):
            centres = chosen.draw(5, len(frames)).centres
            drawn = (
                np.random.default_rng(6).normal(size=(len(frames), 2))
                @ np.linalg.cholesky(stretch**2 * stated).T
            )
            features = centres + drawn
            features[0] = np.nan
            covariance = np.tile(stated, (len(frames), 1, 1))
            covariance[:2] = np.nan
            return Measurement(features, covariance, np.zeros(len(frames), dtype=np.int64))

    monkeypatch.setattr(covariances, "extractors", lambda _: {"drawn": Method()})
    (row,) = measure(chosen, 5, 400)
    assert (row.answered, row.stated) == (399, 398)
    assert row.squares == pytest.approx(stretch**2, rel=0.15)


def test_methods_that_state_a_covariance_are_measured_on_spots_and_grids(capsys):
    """The two of single spots and that of many; who states none is named below the table."""
    rows = [
        row
        for chosen in sets()
        if chosen.name in {"gaussian", "2x2 clean"}
        for row in measure(chosen, 5, 20)
    ]
    methods = {row.method for row in rows if row.stated}
    assert {"mirror", "gaussian-fit", "weighted-spots"} <= methods
    print_table([*rows, replace(ROW, method="mute", squares=math.nan, stated=0)])
    printed = capsys.readouterr().out
    assert all(method in printed for method in methods)
    assert "states no covariance: " in printed
    assert "mute" in printed.rsplit("states no covariance: ", maxsplit=1)[1]


def test_frames_without_the_sun_have_no_errors_to_measure():
    assert all(getattr(chosen, "sun", True) for chosen in sets())
    names = {name for chosen in sets() for name in extractors(chosen)}
    assert "mirror" in names
    assert "weighted-spots" in names
