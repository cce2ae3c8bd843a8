"""One plot a claim: the lines of its experiment, the spread over its trials shaded."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from benchmark.claims.experiment import Sketch
from benchmark.claims.outcomes import ClaimOutcome, Curve
from benchmark.claims.rules import Claim
from benchmark.plot_style import svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Told apart by every kind of colour vision (Okabe and Ito), and by their dashes and marks.
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000")
_DASHES = ("-", "--", "-.", ":", (0, (5, 1)), (0, (3, 1, 1, 1)), (0, (1, 1)))
_MARKS = "os^Dv*P"
_SIZE_IN = (5.6, 3.4)


def file_of(claim: str) -> str:
    """Return the path of a claim's picture in `docs`."""
    return f"claims/{claim}.svg"


def picture(claim: Claim, outcome: ClaimOutcome, sketch: Sketch) -> str:
    """Draw the lines of an outcome as SVG: median over the trials, and their extremes shaded."""
    return svg(lambda: figure(claim, outcome, sketch), f"{claim.id}: {claim.statement}")


def figure(claim: Claim, outcome: ClaimOutcome, sketch: Sketch) -> Figure:
    """Draw the same as a figure of Matplotlib."""
    from matplotlib.figure import Figure  # noqa: PLC0415 - a second that only pictures need

    drawn = Figure(figsize=_SIZE_IN, layout="constrained")
    axes = drawn.subplots()
    words = _words(outcome)
    for number, (name, line) in enumerate(outcome.lines.items()):
        _line(axes, name, line, words, number % len(_COLOURS))
    axes.set_xlabel(claim.x_label)
    axes.set_ylabel(claim.y_label)
    if words:
        axes.set_xticks(range(len(words)), words)
        axes.set_xlim(-0.5, len(words) - 0.5)
    elif sketch.log_x:
        axes.set_xscale("log")
    if sketch.log_up and _positive(outcome):
        axes.set_yscale("log")
    axes.grid(color="#e3e7eb", which="major")
    axes.spines[["top", "right"]].set_visible(False)
    if len(outcome.lines) > 1:
        drawn.legend(loc="outside upper left", ncols=2, frameon=False, fontsize="small")
    return drawn


def _line(axes: Axes, name: str, line: Curve, words: tuple[str, ...], number: int) -> None:
    x: Any = [words.index(str(place)) for place in line.x] if words else line.x
    colour = _COLOURS[number]
    shown: dict[str, Any] = {"color": colour, "marker": _MARKS[number], "markersize": 4.0}
    if words:  # words have no order to join points by
        low, high = (np.abs(np.subtract(line.median, one)) for one in (line.low, line.high))
        shift = 0.08 * (number - 1)
        places = np.asarray(x) + shift
        axes.errorbar(places, line.median, (low, high), label=name, linestyle="none", **shown)
        return
    axes.plot(x, line.median, label=name, linestyle=_DASHES[number], **shown)
    axes.fill_between(x, line.low, line.high, color=colour, alpha=0.15, linewidth=0)


def _words(outcome: ClaimOutcome) -> tuple[str, ...]:
    """Return the places in the order they come, where they are words."""
    places = [place for line in outcome.lines.values() for place in line.x]
    if not any(isinstance(place, str) for place in places):
        return ()
    return tuple(dict.fromkeys(str(place) for place in places))


def _positive(outcome: ClaimOutcome) -> bool:
    values = [v for line in outcome.lines.values() for v in line.low if not math.isnan(v)]
    return bool(values) and min(values) > 0
