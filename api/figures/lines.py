"""Lines of one quantity over another, with bands and their bound, as a figure."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from api.figures.figure import Figure
from api.figures.specification import CATEGORIES, HOVER, axis, faint, mark, specification

_BAND = 0.16  # how much a band hides
_BOUND = CATEGORIES[1]


@dataclass(frozen=True)
class Line:
    """A line of a chart.

    Attributes
    ----------
    name : in the legend
    points : (across, up); up is None or NaN where there is nothing
    band : (across, low, high) around it, if any
    is_bound : whether it is a limit, which is dashed
    """

    name: str
    points: Sequence[tuple[float, float | None]]
    band: Sequence[tuple[float, float | None, float | None]] = ()
    is_bound: bool = False


def line_figure(
    name: str, title: str, lines: Sequence[Line], across: str, up: str, *, log_across: bool = False
) -> Figure:
    """Return lines over one pair of axes, with a row of the table for each place.

    Parameters
    ----------
    name : in its address, one of a page
    title : what is shown against what
    lines : those that have a point
    across, up : names of the axes
    log_across : whether the axis is logarithmic where it can be; the other one always is
    """
    drawn = [line for line in lines if any(_finite(y) is not None for _, y in line.points)]
    values = [_finite(y) for line in drawn for _, y in line.points]
    values += [_finite(end) for line in drawn for _, *ends in line.band for end in ends]
    places = sorted({x for line in drawn for x, _ in line.points})
    data: list[dict[str, Any]] = []
    others = itertools.cycle(one for one in CATEGORIES if one != _BOUND)
    for line in drawn:
        data += _traces(line, _BOUND if line.is_bound else next(others))
    tables = [{x: _finite(y) for x, y in line.points} for line in drawn]
    columns = (across, *(line.name for line in drawn))
    rows = [{across: x, **{o.name: of.get(x) for o, of in zip(drawn, tables, strict=True)}}
            for x in places]  # fmt: skip
    is_log = all(value > 0 for value in values if value is not None)
    return Figure(
        name=name,
        title=title,
        caption=title,
        text=(f"{title}.", *(_said(line) for line in drawn)),
        columns=columns,
        rows=tuple(rows),
        plotly=specification(
            data,
            height=360,
            picture=560,
            xaxis=_axis(across, is_log=log_across and all(x > 0 for x in places)),
            yaxis=_axis(up, is_log=is_log),
        ),
    )


def _axis(title: str, *, is_log: bool) -> dict[str, Any]:
    return axis(title, **({"type": "log"} if is_log else {}))


def _traces(line: Line, tone: str) -> list[dict[str, Any]]:
    """Return a line and its band; what is not known leaves a gap in both."""
    bands: list[dict[str, Any]] = []
    for run in _runs(line.band):
        edge = [(x, high) for x, _, high in run] + [(x, low) for x, low, _ in reversed(run)]
        bands.append(
            {
                "type": "scatter",
                "mode": "none",
                "x": [x for x, _ in edge],
                "y": [y for _, y in edge],
                "fill": "toself",
                "fillcolor": faint(tone, _BAND),
                "hoverinfo": "skip",
                "showlegend": False,
            }
        )
    points = [(x, _finite(y)) for x, y in line.points]
    main = {
        "type": "scatter",
        "mode": "lines" if line.is_bound else "lines+markers",
        "name": line.name,
        "x": [x for x, _ in points],
        "y": [y for _, y in points],
        "line": {"color": tone, "width": 2, "dash": "dash" if line.is_bound else "solid"},
        "marker": {"color": tone, "size": 6},
        "customdata": [
            None if y is None else mark(f"{line.name}: {x:.4g}, {y:.3g}") for x, y in points
        ],
        "hovertemplate": HOVER,
    }
    return [*bands, main]


def _runs(
    band: Sequence[tuple[float, float | None, float | None]],
) -> list[list[tuple[float, float, float]]]:
    """Return a band in runs without a gap."""
    runs: list[list[tuple[float, float, float]]] = [[]]
    for x, below, above in band:
        low, high = _finite(below), _finite(above)
        if low is None or high is None:
            runs.append([])
        else:
            runs[-1].append((x, low, high))
    return [run for run in runs if run]


def _said(line: Line) -> str:
    known = [(x, y) for x, value in line.points if (y := _finite(value)) is not None]
    (first, start), (last, end) = known[0], known[-1]
    if len(known) == 1:
        return f"{line.name}: {start:.3g} at {first:.4g}."
    return f"{line.name}: {start:.3g} at {first:.4g} to {end:.3g} at {last:.4g}."


def _finite(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else value
