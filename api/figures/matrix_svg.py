"""A matrix as SVG: shaded cells with their numbers, dashed ones where there is nothing."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from api.figures import svg
from api.figures.figure import Entry
from api.figures.legend import legend
from api.figures.lettering import line_height, shorten, text_width
from api.figures.svg import BODY, SMALL, Drawing

ROW = 26.0
NARROWEST, WIDEST = 25.0, 84.0  # columns, px
GAP = 2.0  # between cells
SHADES = 5
GAP_BELOW_LEGEND = 10.0
DOT = 4.0
_AIR = 6.0
_SIGNS = {"impossible": "×", "unknown": "?"}


@dataclass(frozen=True)
class Cell:
    """How many studies have both values, the pair's state, and whether it is measured here."""

    count: int
    title: str
    href: str | None
    state: str
    is_measured: bool


@dataclass(frozen=True)
class Line:
    """A row or a column: its value, label and number of studies."""

    value: str
    label: str
    count: int
    title: str


def draw_matrix(
    rows: Sequence[Line],
    columns: Sequence[Line],
    cells: Mapping[tuple[str, str], Cell],
    heads: tuple[str, str],
    entries: Sequence[Entry],
    *,
    width: float,
) -> Drawing:
    """Return a drawing of `width` px, in several panels where columns have no room side by side.

    Parameters
    ----------
    rows, columns : in their order
    cells : by values of row and column
    heads : headings of rows and of columns
    entries : legend of the states
    """
    size = BODY if width > 900 else SMALL
    left = min(
        max(
            [text_width(row.label, size) for row in rows] + [text_width(heads[0], size, bold=True)]
        ),
        width * 0.42,
    )
    total = max(text_width("studies", size), text_width("000", size)) + 2 * _AIR
    room = width - left - _AIR - total
    most = max(1, int(room // NARROWEST))
    panels = math.ceil(len(columns) / most)
    each = math.ceil(len(columns) / panels)
    step = min(room / each, WIDEST)
    highest = max((cell.count for cell in cells.values()), default=0)
    frame = _Frame(left, left + _AIR, step, size, highest, heads)
    first, y = legend(entries, 0.0, width)
    y += GAP_BELOW_LEGEND
    body = [first]
    for panel in range(panels):
        shown = columns[panel * each : (panel + 1) * each]
        drawn, y = _panel(rows, shown, cells, frame, y)
        body.append(drawn)
        y += 24
    return Drawing(width, y - 20, "".join(body))


@dataclass(frozen=True)
class _Frame:
    """Where labels end and cells start, width of a column, letters, highest count, headings."""

    labels: float
    cells: float
    step: float
    size: float
    most: int
    heads: tuple[str, str]


def _panel(
    rows: Sequence[Line],
    columns: Sequence[Line],
    cells: Mapping[tuple[str, str], Cell],
    frame: _Frame,
    top: float,
) -> tuple[str, float]:
    """Return a panel from height `top` on, and the height below it."""
    size = frame.size
    end = frame.cells + frame.step * len(columns)
    half = line_height(size) / 2
    parts = [svg.text(frame.cells, top + half, frame.heads[1], "heading", size=size, bold=True)]
    longest = max(text_width(line.label, size) for line in columns)
    flat = longest <= frame.step - 4
    ground = top + 2 * half + 4 + (2 * half if flat else longest + 2)
    first = shorten(frame.heads[0], frame.labels, size, bold=True)
    parts.append(svg.text(0, ground - half, first, "heading", size=size, bold=True))
    for at, line in enumerate(columns):
        x = frame.cells + frame.step * (at + 0.5)
        class_ = "label" if line.count else "quiet"
        if flat:
            label = svg.text(x, ground - half, line.label, class_, size=size, anchor="middle")
        else:
            label = svg.text(x, ground - 2, line.label, class_, size=size, turned=-90)
        parts.append(svg.mark(line.title, None, label))
    parts.append(svg.text(end + _AIR, ground - half, "studies", "quiet", size=size))
    y = ground + 4
    for row in rows:
        middle = y + ROW / 2
        label = svg.text(
            frame.labels,
            middle,
            shorten(row.label, frame.labels, size),
            "label" if row.count else "quiet",
            size=size,
            anchor="end",
        )
        parts.append(svg.mark(row.title, None, label))
        for at, column in enumerate(columns):
            cell = cells.get((row.value, column.value))
            if cell is not None:
                parts.append(_cell(cell, frame.cells + frame.step * at, y, frame))
        parts.append(svg.text(end + _AIR, middle, str(row.count), "quiet", size=size))
        y += ROW
    below = svg.text(frame.labels, y + half + 2, "studies", "quiet", size=size, anchor="end")
    counts = [
        svg.text(
            frame.cells + frame.step * (at + 0.5),
            y + half + 2,
            str(column.count),
            "quiet",
            size=size,
            anchor="middle",
        )
        for at, column in enumerate(columns)
    ]
    return "".join([*parts, below, *counts]), y + 2 * half + 4


def _cell(cell: Cell, x: float, y: float, frame: _Frame) -> str:
    place = (x + GAP / 2, y + GAP / 2, frame.step - GAP, ROW - GAP)
    middle = (x + frame.step / 2, y + ROW / 2)
    shapes = []
    if cell.count:
        share = (cell.count - 1) / max(frame.most - 1, 1)
        shade = min(SHADES, 1 + int(SHADES * share**0.75))
        shapes.append(svg.rectangle(*place, f"cell h{shade}", rx=2))
        number = str(cell.count)
        shapes.append(svg.text(*middle, number, f"on{shade}", size=frame.size, anchor="middle"))
    else:
        shapes.append(svg.rectangle(*place, f"cell {cell.state}", rx=2))
        if cell.state in _SIGNS:
            sign = _SIGNS[cell.state]
            shapes.append(svg.text(*middle, sign, "quiet", size=frame.size, anchor="middle"))
    if cell.is_measured:
        at = (
            x + frame.step - GAP / 2 - DOT,
            y + GAP / 2,
        )  # the corner: numbers of two digits are wide
        shapes.append(
            svg.rectangle(*at, DOT, DOT, f"dot d{shade if cell.count else 0}", rx=DOT / 2)
        )
    return svg.mark(cell.title, cell.href, *shapes)
