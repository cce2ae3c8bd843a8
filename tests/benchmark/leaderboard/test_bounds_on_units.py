"""Scores that come near to a bound, on units that no board is made of."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from benchmark.contract import Cell
from benchmark.leaderboard import bounds_on_units
from benchmark.leaderboard.bounds_on_units import nearest_to_bounds, ratio_to_bound, try_bounds
from benchmark.plan.parts import Parts, installed_parts
from benchmark.results.csv_tables import Row
from benchmark.results.store import PUBLISHED, Store

NAME = "pd-maskless-cube"


def row(
    rms: float, *, bound: float | None = 1.0, unit: float | None = None, share: float = 1.0
) -> Row:
    return {
        "rms_deg": rms, "bound_deg": bound, "bound_unit_deg": unit, "availability": share,
    }  # fmt: skip


def test_the_nearest_of_each_board_condition_and_bound_is_tried() -> None:
    cell = Cell("d", "nominal", "e", "a")
    nearer, seldom = replace(cell, model="b"), replace(cell, model="c")
    scores = {
        cell: row(1.02, unit=1.01),
        nearer: row(1.01),
        seldom: row(0.5, share=0.9),
        replace(nearer, unit=1): row(0.7),
        replace(cell, condition="high-noise"): row(1.06),
    }
    assert nearest_to_bounds(scores) == {nearer: ["bound_deg"], cell: ["bound_unit_deg"]}


def test_an_efficient_estimator_reaches_the_bound_and_a_better_one_is_below() -> None:
    """Of 30 errors that are chi with 800 degrees of freedom over the bound the square has 1/20."""
    cell = Cell("d", "nominal", "e", "m")
    errors = np.sqrt(np.random.default_rng(4).chisquare(800, size=30) / 800)
    found = ratio_to_bound(cell, "bound_deg", row(1.3), errors.tolist())
    assert found.ratio == pytest.approx(math.sqrt(np.mean(errors**2)))
    assert found.standard_error == pytest.approx(0.05 / math.sqrt(30) / 2, rel=0.4)
    assert (found.standard, found.units, found.is_below) == (1.3, 30, False)
    assert ratio_to_bound(cell, "bound_deg", row(1.3), (0.97 * errors).tolist()).is_below


@pytest.mark.slow
def test_a_board_is_tried_on_units_that_it_is_not_made_of() -> None:
    known = installed_parts()
    parts = Parts({NAME: known.presets[NAME]}, known.extractors, known.models)
    published = Store(PUBLISHED)
    tried = try_bounds(published, 2, parts=parts)
    chosen = nearest_to_bounds(
        {cell: score for cell, score in published.scores().items() if cell.dataset == NAME}
    )
    assert {cell: [one.bound for one in ratios] for cell, ratios in tried.items()} == chosen
    for one in (one for ratios in tried.values() for one in ratios):
        assert one.units == 2
        assert one.ratio != one.standard
        assert 0.8 < one.ratio < 1.5


@pytest.mark.parametrize("arguments", [["--units", "1"], ["--workers", "0"], ["nowhere"]])
def test_what_cannot_be_tried_is_refused(
    arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        bounds_on_units.main(arguments)
    assert arguments[-1] in capsys.readouterr().err
    with pytest.raises(ValueError, match="at least 2 units, got 1"):
        try_bounds(Store(PUBLISHED), 1)
