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


@pytest.mark.slow
def test_the_file_is_the_same_every_time(rows):
    assert plots.picture(rows) == plots.picture(rows)
