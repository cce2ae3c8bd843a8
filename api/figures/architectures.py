"""Architectures as points: error over field or effort, with bounds and the Pareto front."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from api.figures.figure import Figure
from api.figures.specification import AXIS, CATEGORIES, HOVER, TEXT, axis, mark, specification

NAME = "architectures"
_FRONT, _BOUND = CATEGORIES[0], CATEGORIES[1]


@dataclass(frozen=True)
class Point:
    """An architecture.

    Attributes
    ----------
    name : as labelled
    address : where a press leads
    across, error_deg : its place
    bound_deg : the limit of its error; None where it has none
    is_built : whether a study or product realises it
    """

    name: str
    address: str
    across: float
    error_deg: float
    bound_deg: float | None
    is_built: bool = True


def pareto_front(points: Sequence[Point], *, more_is_better: bool) -> list[Point]:
    """Return the points that no other beats in both, from the least error on."""
    sign = -1 if more_is_better else 1
    kept: list[Point] = []
    for point in sorted(points, key=lambda p: (p.error_deg, sign * p.across)):
        if not kept or sign * point.across < sign * kept[-1].across:
            kept.append(point)
    return kept


def architectures_figure(
    points: Sequence[Point], up: str, across: str, unit: str, *, more_is_better: bool
) -> Figure:
    """Return points over a pair of axes, those of the front joined and named.

    Parameters
    ----------
    up : which error, in words
    across, unit : what it is drawn against
    more_is_better : whether a larger value across is better, as a field is and an effort is not
    """
    front = pareto_front(points, more_is_better=more_is_better)
    others = [point for point in points if point not in front]
    line = {
        "type": "scatter",
        "mode": "lines",
        "x": [point.across for point in front],
        "y": [point.error_deg for point in front],
        "line": {"color": AXIS, "width": 1.5, "dash": "dot", "shape": "vh"},
        "hoverinfo": "skip",
        "showlegend": False,
    }
    bounded = [point for point in points if point.bound_deg]
    bounds = {
        "type": "scatter",
        "mode": "markers",
        "name": "bound",
        "x": [point.across for point in bounded],
        "y": [point.bound_deg for point in bounded],
        "marker": {"symbol": "line-ew-open", "size": 9, "color": _BOUND},
        "hoverinfo": "skip",
    }
    columns = ("architecture", "across", "error_deg", "bound_deg", "built", "front")
    rows = [
        dict(
            zip(
                columns,
                (p.name, p.across, p.error_deg, p.bound_deg, p.is_built, p in front),
                strict=True,
            )
        )
        for p in points
    ]
    title = f"{up.capitalize()} of {len(points)} architectures against {across}"
    best = front[0] if front else None
    return Figure(
        name=NAME,
        title=title,
        caption=title,
        text=(
            f"{title}.",
            f"Pareto front: {', '.join(point.name for point in front)}.",
            *([f"Lowest: {best.name}, {best.error_deg:.3g}°."] if best else []),
        ),
        columns=columns,
        rows=tuple(rows),
        plotly=specification(
            [
                line,
                bounds,
                _points("others", others, up, unit, AXIS),
                _points("Pareto front", front, up, unit, _FRONT),
            ]
            if points
            else [],
            height=480,
            picture=760,
            margin={"l": 8, "r": 60, "t": 36, "b": 8},
            xaxis=axis(across, **({} if more_is_better else {"type": "log"})),
            yaxis=axis(f"{up}, °", type="log"),
        ),
    )


def _points(name: str, points: Sequence[Point], up: str, unit: str, tone: str) -> dict[str, Any]:
    """Return points as a trace, those of the front with their names; hollow was never built."""
    gaps = [point.error_deg - (point.bound_deg or point.error_deg) for point in points]
    return {
        "type": "scatter",
        "mode": "markers" if tone == AXIS else "markers+text",
        "name": name,
        "x": [point.across for point in points],
        "y": [point.error_deg for point in points],
        "text": [point.name for point in points],
        "cliponaxis": False,
        "textposition": "top center",
        "textfont": {"color": TEXT, "size": 11},
        "marker": {
            "color": tone,
            "size": 10,
            "symbol": ["circle" if point.is_built else "circle-open" for point in points],
        },
        "error_y": {
            "type": "data",
            "array": [0.0 for _ in points],
            "arrayminus": gaps,
            "symmetric": False,
            "color": AXIS,
            "thickness": 0.7,
            "width": 0,
        },
        "customdata": [
            mark(
                f"{p.name}: {up} {p.error_deg:.3g}°, "
                + (f"bound {p.bound_deg:.3g}°, " if p.bound_deg else "")
                + f"{p.across:g}{'' if unit == '°' else ' '}{unit}"
                + ("" if p.is_built else ", never built"),
                p.address,
            )
            for p in points
        ],
        "hovertemplate": HOVER,
    }
