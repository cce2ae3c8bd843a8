"""The verdict on masks, on rows that were made up."""

from __future__ import annotations

from typing import Any

import pytest
from matplotlib.figure import Figure

from benchmark.directions.segmented import segmented
from benchmark.segmentation.frames import FAULTS, UNANSWERABLE
from benchmark.segmentation.plots import _board
from benchmark.segmentation.worth import member, pooled, worths

UNITS = [0, 1, 2, 3, 4, 5, 7, 9]


def method(name: str, found: list[int], answered: list[int] | None = None) -> dict[str, Any]:
    return {
        "method": name,
        "learned": name.startswith("U-Net"),
        "answered": answered or found,
        "found": found,
        "error_deg": [0.01] * 8,
        "overlap": 0.5,
    }


def row(classical: int, learned: list[int], answered: int = 0, name: str = "any") -> dict[str, Any]:
    """Return a board on which all faults are alike, of 100 frames a unit."""
    faults = []
    for fault in FAULTS:
        none = fault in UNANSWERABLE
        bare = method("mirror", [0] * 8 if none else [classical] * 8)
        masked = method("U-Net, mirror", [0] * 8 if none else learned)
        if none:
            masked["answered"] = [answered] * 8
        faults.append({"fault": fault, "methods": [bare, masked]})
    frames = [100] * 8
    return {"dataset": name, "leader": "mirror", "units": UNITS, "frames": frames, "faults": faults}


STEADY = [80, 81, 80, 79, 80, 82, 80, 78]


@pytest.mark.parametrize(
    ("rows", "verdict"),
    [
        ([], "not tried"),
        ([row(60, STEADY)], "pays"),
        ([row(95, STEADY)], "open"),  # thresholds do not fail
        ([row(90, STEADY)], "does not pay"),
        ([row(78, STEADY)], "open"),  # by less than the margin
        ([row(60, [80, 95, 80, 40, 80, 90, 60, 50])], "open"),  # within the scatter of units
        ([row(60, STEADY), row(90, STEADY)], "depends on the data set"),
        ([row(60, STEADY, answered=1)], "open"),  # 5 of 500 frames without a Sun are answered
    ],
)
def test_the_rule_counts_gains_beyond_margin_and_scatter_where_thresholds_fail(
    rows, verdict
) -> None:
    assert segmented(rows).verdict == verdict


def test_wrong_answers_are_taken_off_and_members_are_chosen_on_even_units() -> None:
    careful, eager = method("a", [50] * 8), method("b", [60] * 8, [90] * 8)
    late = method("c", [10, 100, 10, 100, 10, 100, 100, 100])
    whole = {**row(0, STEADY), "faults": []}
    fault = {"fault": "dirt", "methods": [careful, eager, late]}
    assert worths(whole, eager, scoring=True) == pytest.approx([0.3] * 5)
    assert member(whole, fault, learned=False)["method"] == "a"
    (_, found, _) = pooled(whole, fault)
    assert (found["frames"], found["right"], found["wrong"]) == (500, 300, 150)


def test_wins_of_a_board_that_answers_two_suns_are_named_as_not_counted() -> None:
    text = segmented([row(60, STEADY, 5, "open-minded"), row(60, STEADY)]).text
    assert "6 do not count" in text
    assert "open-minded" in text


def test_bars_are_shares_of_right_answers_up_and_of_wrong_ones_down() -> None:
    board = row(60, STEADY)
    axes = Figure().subplots()
    _board(axes, board)
    heights = [round(bar.get_height(), 6) for bar in axes.patches]
    assert len(heights) == 4 * len(FAULTS)
    per_fault = list(zip(*[iter(heights)] * 4, strict=True))
    for fault, (bare, bare_wrong, masked, masked_wrong) in zip(FAULTS, per_fault, strict=True):
        right = (0.0, 0.0) if fault in UNANSWERABLE else (0.6, sum(STEADY) / 800)
        assert (bare, masked) == pytest.approx(right)
        assert (bare_wrong, masked_wrong) == (0.0, 0.0)
