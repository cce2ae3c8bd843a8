"""A sunburst as SVG: three rings, and a legend that names every arc in full."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from api.figures import svg
from api.figures.lettering import line_height, text_width, wrap
from api.figures.sunburst_layout import arc_label, arc_path, arcs
from api.figures.svg import BODY, SMALL, Drawing

RINGS = (0.08, 0.5, 0.62, 1.0)  # radii over the outermost
ROW = 18.0  # of the legend, px
SWATCH = 10.0
EMPTY = "No study meets the filters."


@dataclass(frozen=True)
class Sector:
    """An arc of a ring, with those outside of it in `inside`: as in a tree."""

    label: str
    name: str
    count: int
    size: float
    colour: int
    title: str
    href: str
    inside: tuple[Sector, ...] = ()


@dataclass(frozen=True)
class _Disc:
    """Where the rings stand, what is drawn of them, and the labels in front."""

    centre: tuple[float, float]
    radius: float
    shapes: list[str]
    letters: list[str]


@dataclass(frozen=True)
class _Entry:
    """A line of the legend: of a category, or of a model inside."""

    sector: Sector
    head: bool
    also: str


def draw_sunburst(sectors: Sequence[Sector], width: float) -> Drawing:
    """Return a drawing of `width` px: the legend beside the rings, or below where it is narrow."""
    if not sectors:
        return Drawing(width, 40, svg.text(0, 20, EMPTY, "quiet"))
    entries = [entry for sector in sectors for entry in _entries(sector)]
    wide = width > 900
    radius = min(330.0, width / 2 - 2) if wide else min(280.0, width / 2 - 2)
    left = radius + 2 if wide else width / 2
    columns = 1 if wide or width < 500 else 2
    disc = _Disc((left, radius + 2), radius, [], [])
    _ring(sectors, 0, (0.0, 2 * math.pi), disc)
    at = (2 * radius + 40, 4.0) if wide else (0.0, 2 * radius + 20)
    column_width = (width - at[0]) / columns
    written = [_lines(entry, column_width - 12) for entry in entries]
    heights = [ROW + line_height(SMALL) * (len(lines) - 1) for lines in written]
    tall = sum(heights) / columns
    column, down, lowest = 0, 0.0, 0.0
    for entry, lines, high in zip(entries, written, heights, strict=True):
        if down >= tall and column < columns - 1:
            column, down = column + 1, 0.0
        place = (at[0] + column_width * column, at[1] + down + high / 2)
        disc.letters.append(_entry(entry, place, lines))
        down += high
        lowest = max(lowest, down)
    height = max(2 * radius + 4, at[1] + lowest + 4)
    return Drawing(width, height, "".join(disc.shapes + disc.letters))


def _ring(sectors: Sequence[Sector], depth: int, turn: tuple[float, float], disc: _Disc) -> None:
    """Draw the arcs of sectors between two angles, and of what they hold."""
    ring = (RINGS[depth] * disc.radius, RINGS[depth + 1] * disc.radius)
    size = BODY if disc.radius > 250 else SMALL
    counts = [sector.size for sector in sectors]
    for sector, arc in zip(sectors, arcs(counts, *turn, ring), strict=True):
        shape = svg.path(arc_path(arc, disc.centre), f"arc ring{depth} c{sector.colour}")
        disc.shapes.append(svg.mark(sector.title, sector.href, shape))
        placed = arc_label(arc, _spellings(sector, depth), size)
        if placed is not None:
            disc.letters.append(
                svg.text(
                    disc.centre[0] + placed.x,
                    disc.centre[1] + placed.y,
                    placed.lines,
                    "label inside",
                    size=size,
                    anchor="middle",
                    turned=placed.turned,
                )
            )
        if sector.inside:
            _ring(sector.inside, depth + 1, (arc.start, arc.end), disc)


def _spellings(sector: Sector, depth: int) -> tuple[str, ...]:
    if depth == 1:
        return (sector.label,)
    # The whole name, then what is left of it in a thin arc; the legend has it all.
    short = sector.label.replace("calibration ", "")
    return tuple(
        dict.fromkeys((f"{sector.label} {sector.count}", sector.label, f"{short} {sector.count}"))
    )


def _entries(sector: Sector) -> list[_Entry]:
    """Return the legend's lines of a category: itself, then its models."""
    found = [_Entry(sector, True, "")]
    for ring in sector.inside:
        also = ", in operation" if ring.label == "online" else ""
        found += [_Entry(model, False, also) for model in ring.inside]
    return found


def _lines(entry: _Entry, width: float) -> tuple[str, ...]:
    """Return the lines that an entry of the legend takes, with its number."""
    sector, head = entry.sector, entry.head
    tail = f" {sector.count}"
    said = sector.label
    if sector.name.casefold() != sector.label.casefold():
        said = f"{said} – {sector.name}"
    room = width - SWATCH - 6 - text_width(tail, SMALL, bold=head)
    *lines, last = wrap(said + entry.also, room, SMALL, 3, bold=head)
    return (*lines, last + tail)


def _entry(entry: _Entry, at: tuple[float, float], lines: tuple[str, ...]) -> str:
    """Return an entry of the legend, its middle at `at`."""
    sector, head = entry.sector, entry.head
    start = at[0] + SWATCH + 6
    tail = f" {sector.count}"
    shapes = [svg.text(start, at[1], lines, size=SMALL, bold=head, tail=tail)]
    if head:
        place = (at[0], at[1] - SWATCH / 2, SWATCH, SWATCH)
        shapes.insert(0, svg.rectangle(*place, f"swatch c{sector.colour}"))
    return svg.mark(sector.title, sector.href, *shapes, reached=False)
