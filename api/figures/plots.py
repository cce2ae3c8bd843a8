"""Traces over axes, drawn by Matplotlib: scatter, bar and heatmap of a Plotly specification.

Of each only what figures here use.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize, to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from api.figures.specification import AXIS, LINE, SURFACE, TEXT, colour

Trace = Mapping[str, Any]
TYPES = {"scatter", "bar", "heatmap"}
_MARKERS = {"circle": "o", "square": "s", "diamond": "D", "x": "X", "line-ns": "|", "line-ew": "_"}
_DASHES = {"solid": "-", "dash": "--", "dot": ":"}
_STEPS = {"linear": "default", "hv": "steps-post", "vh": "steps-pre"}


def paint(of: str) -> Any:
    """Return a colour of a specification as Matplotlib takes it."""
    parts = re.findall(r"[\d.]+", of) if of.startswith("rgb") else []
    if not parts:
        return of
    return tuple(float(part) / (255 if at < 3 else 1) for at, part in enumerate(parts))


def draw(figure: Figure, plotly: Mapping[str, Any]) -> None:
    """Draw every trace over its axes; axes lie as their domains say."""
    data, layout = plotly["data"], plotly["layout"]
    figure.set_layout_engine("constrained")
    pairs = list(dict.fromkeys((t.get("xaxis", "x"), t.get("yaxis", "y")) for t in data))
    domains = [[tuple(_axis(layout, a).get("domain", (0, 1))) for a in pair] for pair in pairs]
    columns = sorted({x for x, _ in domains})
    rows = sorted({y for _, y in domains}, reverse=True)
    grid = figure.add_gridspec(
        len(rows),
        len(columns),
        width_ratios=[high - low for low, high in columns],
        height_ratios=[high - low for low, high in rows],
    )
    legends: dict[str, tuple[Axes, dict[str, Any]]] = {}
    for pair, (x, y) in zip(pairs, domains, strict=True):
        axes = figure.add_subplot(grid[rows.index(y), columns.index(x)])
        axes.patch.set_visible(False)
        over = _Over(axes, [t for t in data if (t.get("xaxis", "x"), t.get("yaxis", "y")) == pair])
        over.prepare(*(_axis(layout, a) for a in pair))
        for at, trace in enumerate(over.traces):
            handle = over.trace(trace, colour(at))
            if trace.get("name") and trace.get("showlegend", True) and handle is not None:
                _, known = legends.setdefault(trace.get("legend", "legend"), (axes, {}))
                known.setdefault(trace["name"], handle)
        over.notes(layout, pair)
        over.finish()
    for axes, known in legends.values():
        if len(known) > 1 and layout.get("showlegend", True):
            above = 1.0 if axes.xaxis.get_ticks_position() != "top" else 1.12
            letters = layout["meta"]["picture"] // 7 - 5 * len(known)
            side_by_side = max(1, min(len(known), letters // max(map(len, known))))
            axes.legend(known.values(), known.keys(), ncols=side_by_side, frameon=False,
                        loc="lower left", bbox_to_anchor=(0, above), borderaxespad=0.2,
                        fontsize=11)  # fmt: skip


def _axis(layout: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    found: Mapping[str, Any] = layout.get(f"{name[0]}axis{name[1:]}", {})
    return found


class _Over:
    """Traces over one pair of axes."""

    def __init__(self, axes: Axes, traces: Sequence[Trace]) -> None:
        self.axes = axes
        self.traces = traces
        self.names: dict[str, list[Any]] = {}
        self.x: Mapping[str, Any] = {}
        self.y: Mapping[str, Any] = {}
        self.ends: dict[tuple[str, float], float] = {}

    def prepare(self, x: Mapping[str, Any], y: Mapping[str, Any]) -> None:
        """Set scales; values of an axis of categories get places from 0 on."""
        self.x, self.y = x, y
        for letter, axis in (("x", x), ("y", y)):
            met = [value for t in self.traces for value in t.get(letter) or ()]
            if axis.get("type") == "category" or any(isinstance(one, str) for one in met):
                self.names[letter] = list(dict.fromkeys([*axis.get("categoryarray", ()), *met]))
            elif axis.get("type") == "log":
                self.axes.set(**{f"{letter}scale": "log"})

    def at(self, letter: str, values: Sequence[Any]) -> np.ndarray:
        """Return the places of values; NaN where there is none."""
        if letter in self.names:
            place = {value: at for at, value in enumerate(self.names[letter])}
            return np.array([np.nan if v is None else place[v] for v in values], dtype=float)
        return np.array([np.nan if value is None else value for value in values], dtype=float)

    def trace(self, trace: Trace, usual: str) -> Any:
        """Draw a trace; return what a legend shows of it."""
        if trace["type"] == "heatmap":
            return self.heat(trace)
        return self.bar(trace, usual) if trace["type"] == "bar" else self.scatter(trace, usual)

    def scatter(self, trace: Trace, usual: str) -> Any:
        """Draw lines, marks, bands and intervals."""
        x, y = self.at("x", trace["x"]), self.at("y", trace["y"])
        mode, line = trace.get("mode", "lines+markers"), trace.get("line", {})
        tone = paint(line.get("color", usual))
        handle: Any = None
        if trace.get("fill") == "toself":
            fill = paint(trace.get("fillcolor", usual))
            handle, *_ = self.axes.fill(x, y, facecolor=fill, linewidth=0)
        if "lines" in mode and line.get("width", 2):
            handle, *_ = self.axes.plot(
                x, y, _DASHES[line.get("dash", "solid")], color=tone,
                linewidth=line.get("width", 2), alpha=trace.get("opacity"),
                drawstyle=_STEPS[line.get("shape", "linear")],
            )  # fmt: skip
        if "markers" in mode:
            handle = self._intervals(trace, x, y, self._marks(trace, x, y, usual))
        if "text" in mode:
            for one, place in zip(trace["text"], zip(x, y, strict=True), strict=True):
                self.axes.annotate(one, place, (0, 6), textcoords="offset points", ha="center",
                                   va="bottom", fontsize=10)  # fmt: skip
        return handle

    def _marks(self, trace: Trace, x: np.ndarray, y: np.ndarray, usual: str) -> Any:
        marker = trace.get("marker", {})
        size, tone = marker.get("size", 8), paint(marker.get("color", usual))
        given = marker.get("symbol", "circle")
        symbols = given if isinstance(given, list) else [given] * len(x)
        handle = None
        for symbol in dict.fromkeys(symbols):
            chosen = [one == symbol for one in symbols]
            hollow = symbol.endswith("-open")
            (drawn,) = self.axes.plot(
                x[chosen], y[chosen], _MARKERS[symbol.removesuffix("-open")], color=tone,
                markersize=size, alpha=1.0, linestyle="none",
                markerfacecolor="none" if hollow else tone,
                markeredgecolor=tone if hollow or symbol.startswith("line") else SURFACE,
                markeredgewidth=1.4 if hollow or symbol.startswith("line") else 0.6,
            )  # fmt: skip
            handle = handle or drawn
        return handle

    def _intervals(self, trace: Trace, x: np.ndarray, y: np.ndarray, handle: Any) -> Any:
        for letter in "xy":
            given = trace.get(f"error_{letter}")
            if given:
                up, down = self.at("", given["array"]), self.at("", given["arrayminus"])
                tone = given.get("color") or (handle.get_color() if handle else TEXT)
                self.axes.errorbar(
                    x, y, fmt="none", ecolor=paint(tone), elinewidth=given.get("thickness", 1.2),
                    **{f"{letter}err": np.nan_to_num(np.array([down, up]))},
                )  # fmt: skip
        return handle

    def bar(self, trace: Trace, usual: str) -> Any:
        """Draw bars, each upon those before at its place."""
        lying = trace.get("orientation") == "h"
        place = self.at("y" if lying else "x", trace["y" if lying else "x"])
        length = self.at("", trace["x" if lying else "y"])
        start = [self.ends.get(("bar", at), 0.0) for at in place]
        self.ends |= {("bar", p): s + n for p, s, n in zip(place, start, length, strict=True)}
        tone = paint(trace.get("marker", {}).get("color", usual))
        style: Any = {"color": tone, "edgecolor": SURFACE, "linewidth": 0.8}
        if lying:
            return self.axes.barh(place, length, left=start, **style)
        return self.axes.bar(place, length, bottom=start, **style)

    def heat(self, trace: Trace) -> None:
        """Draw cells; one without a value stays empty, with its text."""
        z = np.array([[np.nan if v is None else v for v in row] for row in trace["z"]], dtype=float)
        norm = Normalize(trace["zmin"], trace["zmax"])
        across, down = self.at("x", trace["x"]), self.at("y", trace["y"])
        size = min(12.0, 5200 / max(len(across), 1) / 10)
        for row, y in enumerate(down):
            for column, x in enumerate(across):
                value = z[row, column]
                face: Any = "none"
                if np.isfinite(value):
                    # a shade of the scale itself, which a dark page has its own colour of
                    nearest = min(trace["colorscale"], key=lambda s: abs(s[0] - norm(value)))
                    face = nearest[1]
                edge: Any = {"edgecolor": SURFACE if face != "none" else LINE, "linewidth": 1.0}
                self.axes.add_patch(
                    Rectangle((x - 0.47, y - 0.46), 0.94, 0.92, facecolor=face, **edge)
                )
                if text := trace["text"][row][column]:
                    dark = face != "none" and sum(to_rgb(face)) < 1.5
                    self.axes.text(x, y, text, ha="center", va="center", fontsize=size,
                                   color=SURFACE if dark else TEXT)  # fmt: skip
        self.axes.set(xlim=(across.min() - 0.5, across.max() + 0.5),
                      ylim=(down.min() - 0.5, down.max() + 0.5))  # fmt: skip

    def notes(self, layout: Mapping[str, Any], pair: tuple[str, str]) -> None:
        """Draw lines and texts that the layout places by these axes' values."""
        for shape in layout.get("shapes", ()) if pair == ("x", "y") else ():
            x, y = ([shape[f"{letter}0"], shape[f"{letter}1"]] for letter in "xy")
            line = shape["line"]
            self.axes.plot(x, y, zorder=0.5, color=line["color"], linewidth=line["width"])
        for note in layout.get("annotations", ()):
            if (note["xref"], note["yref"]) == pair:
                offset = (note.get("xshift", 0), note.get("yshift", 0))
                self.axes.annotate(
                    note["text"], (note["x"], note["y"]), offset, va="center", fontsize=11,
                    ha=note.get("xanchor", "center"), textcoords="offset points", color=TEXT,
                    annotation_clip=False,
                )  # fmt: skip

    def finish(self) -> None:
        """Write the axes: titles, ticks, grid, ends."""
        self.axes.set_axisbelow(True)
        self.axes.spines[["top", "right"]].set_visible(False)
        self.axes.spines[["left", "bottom"]].set(color=AXIS)
        for letter, axis in (("x", self.x), ("y", self.y)):
            self._ticks(letter, axis)
            self._ends(letter, axis)
        if self.x.get("side") == "top":
            self.axes.xaxis.tick_top()
            self.axes.xaxis.set_label_position("top")
        if turned := self.x.get("tickangle"):
            side = "left" if turned < 0 and self.x.get("side") == "top" else "right"
            for label in self.axes.get_xticklabels():
                label.set(ha=side, rotation=-turned, rotation_mode="anchor")
        if any(trace["type"] == "heatmap" for trace in self.traces):
            self.axes.spines[:].set_visible(False)

    def _ticks(self, letter: str, axis: Mapping[str, Any]) -> None:
        of, names = getattr(self.axes, f"{letter}axis"), self.names.get(letter)
        if "tickvals" in axis:
            of.set_ticks(self.at(letter, axis["tickvals"]), labels=axis.get("ticktext"))
        elif names is not None:
            of.set_ticks(range(len(names)), labels=names)
        elif axis.get("type") == "log":
            low, high = of.get_view_interval()
            of.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < 300 * low else (1.0,)))
        if names is None and "ticktext" not in axis:
            of.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        of.set_minor_locator(NullLocator())
        of.set_label_text(axis.get("title", {}).get("text", ""))
        if axis.get("showgrid", names is None):
            of.grid(visible=True, color=LINE, linewidth=0.8)
        of.set_tick_params(color=AXIS, labelcolor=TEXT, length=0 if names else 3)
        if axis.get("visible") is False:
            of.set_visible(False)
            self.axes.spines["left" if letter == "y" else "bottom"].set_visible(False)

    def _ends(self, letter: str, axis: Mapping[str, Any]) -> None:
        if "range" in axis:
            self.axes.set(**{f"{letter}lim": axis["range"]})
        if axis.get("autorange") == "reversed":
            getattr(self.axes, f"{letter}axis").set_inverted(True)
