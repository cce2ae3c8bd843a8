"""The picture of the error budgets shows the numbers of the record."""

import numpy as np
import pytest

from benchmark.error_budget import plots, record
from benchmark.error_budget.sentences import PARTS, bound_of, contributions, verdict
from benchmark.results.store import PUBLISHED


@pytest.fixture(scope="module")
def rows():
    return list(record.RECORD.read(PUBLISHED).values())


def test_every_leader_stands_at_its_error_bound_and_largest_part(rows):
    (axes,) = plots.figure(rows).axes
    marks = [list(zip(*line.get_data(), strict=True)) for line in axes.lines]
    points = {(float(x), float(y)) for mark in marks for x, y in mark if np.isfinite(x)}
    texts = [text.get_text() for text in axes.texts]
    assert [label.get_text() for label in axes.get_yticklabels()] == [r["dataset"] for r in rows]
    least = axes.get_xlim()[0]
    for at, (row, text) in enumerate(zip(rows, texts, strict=True)):
        found = verdict(row)
        wanted = [row["rms_deg"], bound_of(row), *contributions(row).values()]
        assert {(error, at) for error in wanted if error >= least} <= points
        assert (text == PARTS[found.leading_part]) == (not found.is_near_bound)


def test_a_largest_part_far_below_the_bound_has_no_mark(rows):
    """But its name or its ratio to the bound, like any other."""
    row = {**rows[0], "bound_deg": 1.0, "bound_unit_deg": None, "rms_deg": 1.1}
    tiny = {**row, **{name: 1e-3 for name in row if name.endswith("_deg") and row[name]}}
    tiny |= {"bound_deg": 1.0, "bound_unit_deg": None, "rms_deg": 1.1}
    (axes,) = plots.figure([tiny]).axes
    marks = [x for line in axes.lines for x in np.asarray(line.get_xdata(), float)]
    assert min(x for x in marks if np.isfinite(x)) == 1.0
    assert "1.1 times the bound" in {text.get_text() for text in axes.texts}


def test_nothing_measured_is_said(rows):
    assert plots.figure([]).texts[-1].get_text() == "nothing is stored"


@pytest.mark.slow
def test_the_file_is_the_same_every_time(rows):
    assert plots.picture(rows) == plots.picture(rows)
