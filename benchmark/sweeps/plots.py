"""Pictures of error against noise, feature size and phase: a panel a method, with its bound."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from benchmark.plot_style import svg
from benchmark.sweeps.plan import SERIES
from benchmark.synthetic_features.series import SWEEPS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Row = Mapping[str, Any]

#: Sweeps that are drawn; a phase is no ratio, so its axis is linear.
DRAWN = ("noise", "size", "phase")
_LINEAR = frozenset({"phase"})

_COLUMNS = 5
#: Points: a panel with its names and ticks, the same around its axes, and the whole picture's rim.
_WIDTH, _HEIGHT = 214, 172
_LEFT, _RIGHT, _TOP, _BOTTOM = 46, 10, 36, 30
_MARGIN, _HEAD, _FOOT = 12, 58, 20
#: Two that every kind of colour vision tells apart (Okabe and Ito), and dark to light greys.
_ERROR, _BOUND, _INK, _FAINT, _GRID = "#0072b2", "#d55e00", "#1a1d21", "#5c6570", "#e3e7eb"


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
    from matplotlib.figure import Figure  # noqa: PLC0415 - a second that only pictures need

    if sweep not in DRAWN:
        raise ValueError(f"sweep must be one of {', '.join(DRAWN)}; got {sweep!r}")
    panels = _panels(rows, sweep)
    width = 2 * _MARGIN + _COLUMNS * _WIDTH
    height = _HEAD + max(1, math.ceil(len(panels) / _COLUMNS)) * _HEIGHT + _FOOT
    drawn = Figure(figsize=(width / 72, height / 72), dpi=72, facecolor="white")
    place: dict[str, Any] = {"ha": "left", "va": "baseline"}
    title, left = f"Error against {SWEEPS[sweep]}", _MARGIN / width
    drawn.text(left, 1 - 22 / height, title, size=15, weight="bold", color=_INK, **place)
    said = f"across: {SWEEPS[sweep]}; upwards: rms error of one coordinate, in the unit named"
    drawn.text(left, 9 / height, said, size=10, color=_FAINT, **place)
    _legend(drawn, (left, 1 - 33 / height))
    for number, panel in enumerate(panels):
        column, line = number % _COLUMNS, number // _COLUMNS
        axes = drawn.add_axes(
            (
                (_MARGIN + column * _WIDTH + _LEFT) / width,
                1 - (_HEAD + (line + 1) * _HEIGHT - _BOTTOM) / height,
                (_WIDTH - _LEFT - _RIGHT) / width,
                (_HEIGHT - _TOP - _BOTTOM) / height,
            )
        )
        alike = [other for other in panels if other.series == panel.series]
        values = [v for other in alike for v in (*other.errors, *other.bounds) if v]
        _fill(axes, panel, sweep, _decades(values))
    if not panels:
        drawn.text(left, 1 - 70 / height, "nothing is stored", size=11, color=_FAINT, **place)
    return drawn


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
    name: dict[str, Any] = {
        "xycoords": "axes fraction",
        "textcoords": "offset points",
        "ha": "left",
    }
    axes.annotate(panel.name, (0, 1), (0, 19), size=11.5, weight="bold", color=_INK, **name)
    axes.annotate(f"{panel.about} ({panel.unit})", (0, 1), (0, 7), size=10, color=_FAINT, **name)
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
    axes.minorticks_off()
    axes.tick_params(labelsize=9.5, labelcolor=_FAINT, color=_FAINT, length=3)
    axes.tick_params(axis="y", left=False)
    # all rules as one broken line: a grid's would be half of the file
    heights = [value for e in range(low, high + 1) for value in (10.0**e, 10.0**e, math.nan)]
    ends = [0.0, 1.0, math.nan] * (high - low + 1)
    across = axes.get_yaxis_transform()
    axes.plot(ends, heights, transform=across, color=_GRID, linewidth=1, zorder=0.5)
    axes.spines[["left", "right", "top"]].set_visible(False)
    axes.spines["bottom"].set_color(_FAINT)
    axes.patch.set_visible(False)
    _curve(axes, panel.places, panel.bounds, color=_BOUND, linestyle=(0, (3, 2)))
    if not any(panel.errors):
        axes.text(
            0.5,
            0.5,
            "nothing found",
            transform=axes.transAxes,
            size=10,
            color=_FAINT,
            ha="center",
            va="center",
        )
    _curve(axes, panel.places, panel.errors, color=_ERROR)
    for whole in (True, False):
        chosen = [
            error if complete is whole else None
            for error, complete in zip(panel.errors, panel.complete, strict=True)
        ]
        _curve(axes, panel.places, chosen, **_dots(whole=whole))


def _curve(
    axes: Axes, places: Sequence[float], values: Sequence[float | None], **style: Any
) -> None:
    points = [(place, v) for place, v in zip(places, values, strict=True) if v]
    if points:
        axes.plot(*zip(*points, strict=True), linewidth=1.6, clip_on=False, **style)


def _dots(*, whole: bool) -> dict[str, Any]:
    return {
        "linestyle": "none",
        "marker": "o",
        "markersize": 5.2,
        "markeredgewidth": 1.0,
        "markeredgecolor": _ERROR,
        "markerfacecolor": _ERROR if whole else "white",
    }


def _legend(drawn: Figure, corner: tuple[float, float]) -> None:
    from matplotlib.lines import Line2D  # noqa: PLC0415 - see `figure`

    error: dict[str, Any] = {
        **_dots(whole=True),
        "linestyle": "-",
        "color": _ERROR,
        "linewidth": 1.6,
    }
    bound: dict[str, Any] = {"color": _BOUND, "linestyle": (0, (3, 2)), "linewidth": 1.6}
    entries = [
        Line2D([], [], label="rms error of one coordinate", **error),
        Line2D([], [], label="less than 90 % found", **_dots(whole=False)),
        Line2D([], [], label="Cramer-Rao bound", **bound),
    ]
    drawn.legend(
        handles=entries,
        loc="upper left",
        bbox_to_anchor=corner,
        ncols=len(entries),
        fontsize=11,
        labelcolor=_FAINT,
        frameon=False,
        borderpad=0,
        borderaxespad=0,
        handlelength=2.4,
        columnspacing=2.0,
    )


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
