"""Parallel coordinates as SVG: axes upright side by side, or lying below each other if narrow."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from api.figures import svg
from api.figures.figure import Entry
from api.figures.legend import legend
from api.figures.lettering import line_height, text_width
from api.figures.svg import BODY, SMALL, Drawing, number

HEIGHT = 430.0  # of upright axes, px
BETWEEN = 150.0  # lying axes, px
UNKNOWN = "not known"
FOOT = 0.16  # of an axis of numbers, below the lowest: what is not known
_SLOT = 0.72  # share of a name's slot over which its lines are spread
_LABEL_GAP = 8.0
_TURN = -45.0  # degrees of labels of lying axes

Value = float | str | None


@dataclass(frozen=True)
class Tick:
    """A value of an axis and what is written there."""

    value: float | str
    label: str


@dataclass(frozen=True)
class Axis:
    """An axis: its ticks from the lowest place to the highest."""

    name: str
    title: str
    ticks: tuple[Tick, ...]
    named: bool = False
    logarithmic: bool = False

    def place(self, value: Value) -> float:
        """Return the place of a value, 0 to 1; what is not known stands at 0."""
        if value is None or not self.ticks:
            return 0.5 / (len(self.ticks) + 1) if self.named else FOOT / 2
        if self.named:
            at = [tick.value for tick in self.ticks].index(value)
            return (at + 1.5) / (len(self.ticks) + 1)
        low, high = (self._scaled(self.ticks[end].value) for end in (0, -1))
        share = (self._scaled(value) - low) / (high - low) if high != low else 0.5
        return FOOT + (1 - FOOT) * min(max(share, 0.0), 1.0)

    def _scaled(self, value: float | str) -> float:
        return math.log10(float(value)) if self.logarithmic else float(value)


@dataclass(frozen=True)
class Polyline:
    """A line: its value on each axis; dashed where one of them is less certain."""

    values: tuple[Value, ...]
    colour: str
    title: str
    href: str
    is_dashed: bool = False


def draw_coordinates(
    axes: Sequence[Axis], lines: Sequence[Polyline], entries: Sequence[Entry], width: float
) -> Drawing:
    """Return a drawing of `width` px: legend, lines, and axes with their labels in front."""
    if not lines:
        return Drawing(width, 40, svg.text(0, 20, "No study meets the filters.", "quiet"))
    shapes, top = legend(entries, 0, width)
    places = _places(axes, lines)
    drawn = (_upright if width > 500 else _lying)(axes, places, lines, top + 8, width)
    return Drawing(width, drawn[1], shapes + drawn[0])


def _places(axes: Sequence[Axis], lines: Sequence[Polyline]) -> list[list[float]]:
    """Return the place of each line on each axis: those of one name side by side.

    Within a name lines keep the order in which they come from the axis before, so that they do
    not cross there.
    """
    found: list[list[float]] = []
    for at, axis in enumerate(axes):
        exact = [axis.place(line.values[at]) for line in lines]
        before = found[-1] if found else [0.0] * len(lines)
        together: dict[float, list[int]] = {}
        for index, place in enumerate(exact):
            together.setdefault(place, []).append(index)
        room = _SLOT / (len(axis.ticks) + 1) if axis.named else 0.0
        spread = list(exact)
        for place, members in together.items():
            wide = FOOT * _SLOT if not axis.named and place == FOOT / 2 else room
            members.sort(key=lambda index: (before[index], index))
            for rank, index in enumerate(members):
                spread[index] = place + wide * ((rank + 0.5) / len(members) - 0.5)
        found.append(spread)
    return found


def _labels(axis: Axis) -> list[tuple[float, str]]:
    """Return what is written along an axis: place and words."""
    written = [(axis.place(tick.value), tick.label) for tick in axis.ticks]
    return [(axis.place(None), UNKNOWN), *written]


def _upright(
    axes: Sequence[Axis],
    places: Sequence[Sequence[float]],
    lines: Sequence[Polyline],
    top: float,
    width: float,
) -> tuple[str, float]:
    size = BODY if width > 900 else SMALL
    widths = [max(text_width(label, size) for _, label in _labels(axis)) for axis in axes]
    left = widths[0] + _LABEL_GAP
    right = width - widths[-1] - _LABEL_GAP
    step = (right - left) / (len(axes) - 1)
    first = top + 2 * line_height(size)
    foot = first + HEIGHT

    def point(at: int, index: int) -> tuple[float, float]:
        return left + step * at, foot - HEIGHT * places[at][index]

    shapes = [_line(line, [point(at, i) for at in range(len(axes))]) for i, line in _order(lines)]
    letters = []
    for at, axis in enumerate(axes):
        x = left + step * at
        letters.append(svg.line(x, first, x, foot, "axis"))
        titled = text_width(axis.title, size, bold=True)
        middle = min(max(x, titled / 2), width - titled / 2)
        height = top + line_height(size) / 2
        letters.append(
            svg.text(middle, height, axis.title, "heading", size=size, anchor="middle", bold=True)
        )
        for place, label in _labels(axis):
            class_ = "label quiet" if label == UNKNOWN else "label"
            beside = x - _LABEL_GAP if at == 0 else x + _LABEL_GAP
            anchor: svg.Anchor = "end" if at == 0 else "start"
            letters.append(
                svg.text(beside, foot - HEIGHT * place, label, class_, size=size, anchor=anchor)
            )
    return "".join(shapes + letters), foot + line_height(size)


def _lying(
    axes: Sequence[Axis],
    places: Sequence[Sequence[float]],
    lines: Sequence[Polyline],
    top: float,
    width: float,
) -> tuple[str, float]:
    size = SMALL
    slope = math.cos(math.radians(_TURN))
    longest = max(text_width(label, size) for axis in axes for _, label in _labels(axis))
    # A turned label reaches as far to the left of its place as below it.
    left = longest * slope
    long = width - left - line_height(size)
    first = top + 2 * line_height(size)

    def point(at: int, index: int) -> tuple[float, float]:
        return left + long * places[at][index], first + BETWEEN * at

    shapes = [_line(line, [point(at, i) for at in range(len(axes))]) for i, line in _order(lines)]
    letters = []
    for at, axis in enumerate(axes):
        y = first + BETWEEN * at
        letters.append(svg.line(left, y, left + long, y, "axis"))
        letters.append(
            svg.text(0, y - line_height(size), axis.title, "heading", size=size, bold=True)
        )
        for place, label in _labels(axis):
            class_ = "label quiet" if label == UNKNOWN else "label"
            x = left + long * place
            letters.append(
                svg.text(x, y + 10, label, class_, size=size, anchor="end", turned=_TURN)
            )
    return "".join(shapes + letters), first + BETWEEN * (len(axes) - 1) + 24 + left


def _order(lines: Sequence[Polyline]) -> list[tuple[int, Polyline]]:
    """Return the lines with their indices, the grey ones first: others lie over them."""
    return sorted(enumerate(lines), key=lambda pair: (pair[1].colour != "c0", pair[0]))


def _line(line: Polyline, points: Sequence[tuple[float, float]]) -> str:
    d = "M" + "L".join(f"{number(x)} {number(y)}" for x, y in points)
    return svg.mark(
        line.title,
        line.href,
        svg.path(d, f"line {line.colour}{' dashed' if line.is_dashed else ''}"),
        reached=False,
    )
