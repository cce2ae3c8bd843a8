"""Pictures of experiments show the numbers of their rows."""

import math

import numpy as np
import pytest

from benchmark.claims import plots as claim_plots
from benchmark.claims.experiment import Sketch
from benchmark.claims.outcomes import ClaimOutcome, Curve
from benchmark.error_budget import plots as budget_plots
from benchmark.error_budget.sentences import bound_of, contributions, verdict
from benchmark.learning_curves import plots as curve_plots
from benchmark.results.store import PUBLISHED
from benchmark.running.experiment import recorded_experiments
from benchmark.sweeps import plots as sweep_plots


def rows_of(name):
    return recorded_experiments()[name](PUBLISHED).rows()


def drawn_at(axes, at):
    """Abscissae of all single points at one height."""
    return sorted(
        x
        for line in axes.lines
        if line.get_linestyle() == "None"
        for x, y in zip(line.get_xdata(), line.get_ydata(), strict=True)
        if y == at and line.get_transform() == axes.transData
    )


def test_an_error_budget_has_error_bound_and_every_part_that_is_not_far_below():
    rows = rows_of("error_budget")[:12]
    (axes,) = budget_plots.figure(rows).axes
    least = axes.get_xlim()[0]
    assert least == pytest.approx(min(map(bound_of, rows)) / 10.0)
    assert axes.get_xlim()[1] == pytest.approx(1.5 * max(row["rms_deg"] for row in rows))
    for at, row in enumerate(rows):
        parts = [part for part in contributions(row).values() if part >= least]
        assert drawn_at(axes, at) == sorted([*parts, row["rms_deg"], bound_of(row)])
        (words,) = [text.get_text() for text in axes.texts if text.xy == (1, at)]
        assert ("the bound" in words) == verdict(row).is_near_bound
    assert [label.get_text() for label in axes.get_yticklabels()] == [r["dataset"] for r in rows]


def test_a_learning_curve_goes_through_the_middle_of_its_draws():
    every = rows_of("learning_curves")
    names = list(dict.fromkeys(row["dataset"] for row in every))[:4]
    rows = [row for row in every if row["dataset"] in names]
    panels = curve_plots.figure(rows).axes[: len(names)]
    for name, axes in zip(names, panels, strict=True):
        leaders = [row for row in rows if row["dataset"] == name]
        high = axes.get_ylim()[1]
        shown = {
            (x, y)
            for line in axes.lines
            for x, y in zip(line.get_xdata(), line.get_ydata(), strict=True)
        }
        for row in leaders:
            points = [(p["poses"], p["middle_deg"]) for p in row["points"] if p["middle_deg"]]
            near = {point for point in points if point[1] <= 3.0 * high}
            assert len(near) < 2 or near <= shown, (name, row["model"])
        # the axis reaches from the bound or the floors to all that lies near
        ends = [
            row["points"][-1]["middle_deg"] for row in leaders if row["points"][-1]["middle_deg"]
        ]
        assert axes.get_ylim()[0] < min(ends) < axes.get_ylim()[1]
        largest = max(p["largest_deg"] for r in leaders for p in r["points"] if p["middle_deg"])
        assert high <= max(2.0 * largest, 3.0 * axes.get_ylim()[0]) * (1.0 + 1e-9)


@pytest.mark.parametrize("sweep", sweep_plots.DRAWN)
def test_a_sweep_has_a_panel_for_each_method_with_error_and_bound(sweep):
    rows = [row for row in rows_of("sweeps") if row["sweep"] == sweep and row["value"] is not None]
    keys = list(dict.fromkeys((row["series"], row["extractor"]) for row in rows))[:6]
    rows = [row for row in rows if (row["series"], row["extractor"]) in keys]
    panels = {}
    for axes in sweep_plots.figure(rows, sweep).axes:
        texts = [text.get_text() for text in axes.texts]
        if texts:
            series = next(k for k in keys if k[1] == texts[0] and k[0] in texts[1])
            panels[series] = axes
    assert set(panels) == set(keys)
    for key, axes in panels.items():
        own = [row for row in rows if (row["series"], row["extractor"]) == key]
        shown = {
            (x, y)
            for line in axes.lines
            for x, y in zip(line.get_xdata(), line.get_ydata(), strict=True)
        }
        wanted = {(r["value"], r[name]) for r in own for name in ("rms", "bound") if r[name]}
        assert wanted <= shown
        of_series = [r for r in rows if r["series"] == key[0]]
        heights = [r[name] for r in of_series for name in ("rms", "bound") if r[name]]
        assert axes.get_ylim() == pytest.approx((min(heights) / 2.0, 2.0 * max(heights)))


def test_a_claim_of_words_has_its_medians_and_spreads_beside_each_other():
    class Said:
        id, statement, x_label, y_label = "c1", "one is finer", "method", "deg"

    lines = {
        "one": Curve(("a", "b"), (2.0, 3.0), (1.0, 2.5), (4.0, 3.5)),
        "two": Curve(("b", "c"), (5.0, 7.0), (4.5, 6.0), (6.0, 9.0)),
    }
    outcome = ClaimOutcome("c1", {}, {}, lines)
    (axes,) = claim_plots.figure(Said, outcome, Sketch()).axes
    assert [label.get_text() for label in axes.get_xticklabels()] == ["a", "b", "c"]
    assert axes.get_xlim() == (-0.5, 2.5)
    for number, (name, line) in enumerate(lines.items()):
        bars = axes.containers[number]
        assert bars.get_label() == name
        x, y = bars.lines[0].get_data()
        np.testing.assert_allclose(np.round(x), ["abc".index(place) for place in line.x])
        np.testing.assert_array_equal(y, line.median)
        (segments,) = (collection.get_segments() for collection in bars.lines[2])
        spans = [sorted(segment[:, 1]) for segment in segments]
        np.testing.assert_allclose(spans, list(zip(line.low, line.high, strict=True)))
    assert not math.isclose(*(c.lines[0].get_xdata()[0] % 1.0 for c in axes.containers))
