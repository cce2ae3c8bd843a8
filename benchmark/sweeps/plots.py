"""Pictures of error against noise, feature size and phase: a panel a method, with its bound."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from benchmark.panels import (
    BLUE,
    FAINT,
    INK,
    VERMILION,
    Layout,
    annotate,
    bound_style,
    dots,
    panel_figure,
    rule,
)
from benchmark.plot_style import svg
from benchmark.sweeps.plan import SERIES
from benchmark.synthetic_features.series import SWEEPS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

Row = Mapping[str, Any]

#: Sweeps that are drawn; a phase is no ratio, so its axis is linear.
DRAWN = ("noise", "size", "phase")
_LINEAR = frozenset({"phase"})

_LAYOUT = Layout(
    width=214,
    height=172,
    left=46,
    right=10,
    top=36,
    bottom=30,
    head=58,
    foot=20,
    explained=-9,
    legend=33,
)
_ERROR, _BOUND = BLUE, VERMILION
_WIDTH = 1.6


@dataclass(frozen=True)
class _Panel:
    name: str
    series: str
    about: str
    unit: str
    places: tuple[float, ...]
    errors: tuple[float | None, ...]
    bounds: tuple[float | None, ...]
    complete: tuple[bool, ...]


def picture(rows: Sequence[Row], sweep: str) -> str:
    """Draw one sweep of every method as SVG: error (line and dots) and bound (dashed) by panel.

    Dots are hollow where less than 90 % are found; an error of zero has no place on the axis.
    ValueError for a sweep that is not drawn.
    """
    about = f"Error against {SWEEPS[sweep]} of every method, with its bound"
    return svg(lambda: figure(rows, sweep), about)


def figure(rows: Sequence[Row], sweep: str) -> Figure:
    """Draw the same as a figure of Matplotlib."""
    if sweep not in DRAWN:
        raise ValueError(f"sweep must be one of {', '.join(DRAWN)}; got {sweep!r}")
    panels = _panels(rows, sweep)

    def fill(axes: Axes, panel: _Panel) -> None:
        alike = [other for other in panels if other.series == panel.series]
        values = [v for other in alike for v in (*other.errors, *other.bounds) if v]
        _fill(axes, panel, sweep, _decades(values))

    return panel_figure(
        _LAYOUT,
        panels,
        fill,
        title=f"Error against {SWEEPS[sweep]}",
        explained=f"across: {SWEEPS[sweep]}; upwards: rms error of one coordinate, in the unit "
        "named",
        legend=_legend(),
        handle=2.4,
    )


def _panels(rows: Sequence[Row], sweep: str) -> list[_Panel]:
    found: dict[tuple[str, str, str], list[Row]] = {}
    for row in rows:
        if row["sweep"] == sweep and row["value"] is not None:
            key = (row["series"], row["extractor"], row["extractor_taxonomy"])
            found.setdefault(key, []).append(row)
    order = [*SERIES]
    panels = []
    for (series, extractor, taxonomy), group in sorted(
        found.items(), key=lambda item: (order.index(item[0][0]), item[0][1])
    ):
        points = sorted(group, key=lambda row: row["value"])
        panels.append(
            _Panel(
                extractor,
                series,
                series if taxonomy == "None" else f"{taxonomy}, {series}",
                points[0]["unit"],
                tuple(row["value"] for row in points),
                tuple(row["rms"] for row in points),
                tuple(row["bound"] for row in points),
                tuple((row["found_fraction"] or 0.0) >= 0.9 for row in points),
            )
        )
    return panels


def _fill(axes: Axes, panel: _Panel, sweep: str, decades: tuple[int, int]) -> None:
    annotate(axes, panel.name, (0, 19), size=11.5, weight="bold", color=INK)
    annotate(axes, f"{panel.about} ({panel.unit})", (0, 7), size=10, color=FAINT)
    low, high = decades
    axes.set_yscale("log")
    axes.set_ylim(10.0**low, 10.0**high)
    exponents = range(low, high + 1, 1 if high - low < 5 else 2)
    axes.set_yticks([10.0**e for e in exponents], [_power(e) for e in exponents])
    first, last = min(panel.places), max(panel.places)
    if sweep in _LINEAR:
        room = (last - first) * 0.04
        axes.set_xlim(first - room, last + room)
    else:
        axes.set_xscale("log")
        axes.set_xlim(first / 1.12, last * 1.12)
    places = _ticks(panel.places, sweep)
    axes.set_xticks(places, [f"{place:g}" for place in places])
    rule(axes, [10.0**e for e in range(low, high + 1)])
    _curve(axes, panel.places, panel.bounds, **bound_style(_BOUND, _WIDTH))
    if not any(panel.errors):
        axes.text(
            0.5,
            0.5,
            "nothing found",
            transform=axes.transAxes,
            size=10,
            color=FAINT,
            ha="center",
            va="center",
        )
    _curve(axes, panel.places, panel.errors, color=_ERROR, linewidth=_WIDTH)
    for whole in (True, False):
        chosen = [
            error if complete is whole else None
            for error, complete in zip(panel.errors, panel.complete, strict=True)
        ]
        _curve(axes, panel.places, chosen, **_dots(whole=whole), linewidth=_WIDTH)


def _curve(
    axes: Axes, places: Sequence[float], values: Sequence[float | None], **style: Any
) -> None:
    points = [(place, v) for place, v in zip(places, values, strict=True) if v]
    if points:
        axes.plot(*zip(*points, strict=True), clip_on=False, **style)


def _dots(*, whole: bool) -> dict[str, Any]:
    return dots(_ERROR, 5.2, edge=1.0, hollow=not whole)


def _legend() -> list[Line2D]:
    from matplotlib.lines import Line2D  # noqa: PLC0415 - a second that only pictures need

    error = {**_dots(whole=True), "linestyle": "-", "color": _ERROR, "linewidth": _WIDTH}
    return [
        Line2D([], [], label="rms error of one coordinate", **error),
        Line2D([], [], label="less than 90 % found", **_dots(whole=False)),
        Line2D([], [], label="Cramer-Rao bound", **bound_style(_BOUND, _WIDTH)),
    ]


def _decades(values: Sequence[float]) -> tuple[int, int]:
    """Return exponents of the whole powers of ten around positive values."""
    if not values:
        return -1, 0
    low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
    return low, max(high, low + 1)


def _ticks(places: Sequence[float], sweep: str) -> list[float]:
    if sweep == "noise":
        return [place for place in (5.0, 20.0, 100.0, 500.0) if min(places) <= place <= max(places)]
    return list(places)[::2] if len(places) > 5 else list(places)


def _power(exponent: int) -> str:
    digits = str(exponent).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"10{digits}"
