"""Arcs of a sunburst, and which of them have room for a label.

A label stands inside of its own arc or nowhere: along the radius, or across it. So no two labels
can meet; what is too thin is named by the legend alone.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

from api.figures.lettering import line_height, text_width, wrap

_AIR = 2.0  # px between a label and the edge of its arc


@dataclass(frozen=True)
class Arc:
    """A sector of a ring. Angles in radians, clockwise from the top; radii in px."""

    start: float
    end: float
    inner: float
    outer: float

    @property
    def middle(self) -> float:
        """Angle of its middle."""
        return (self.start + self.end) / 2


@dataclass(frozen=True)
class ArcLabel:
    """A label in an arc: its centre relative to the sunburst's, and its turn in degrees."""

    x: float
    y: float
    turned: float
    lines: tuple[str, ...]


def arcs(counts: Sequence[float], start: float, end: float, ring: tuple[float, float]) -> list[Arc]:
    """Return neighbouring arcs from `start` to `end`, as wide as their counts."""
    total = sum(counts)
    edges = [start + (end - start) * sum(counts[:at]) / total for at in range(len(counts))] + [end]
    return [Arc(first, last, *ring) for first, last in itertools.pairwise(edges)]


def arc_path(arc: Arc, centre: tuple[float, float]) -> str:
    """Return the path data of an arc; a whole ring is drawn in two halves."""
    if arc.end - arc.start >= 2 * math.pi - 1e-9:
        return "".join(
            _sector(Arc(arc.start + turn, arc.start + turn + math.pi, arc.inner, arc.outer), centre)
            for turn in (0.0, math.pi)
        )
    return _sector(arc, centre)


def arc_label(arc: Arc, spellings: Sequence[str], size: float) -> ArcLabel | None:
    """Return the first of the spellings that has room in an arc; None where none has."""
    along = math.degrees(arc.middle) - 90
    for text in spellings:
        folded = wrap(text, _widest(text.split(), size), size, most=4)
        middling = wrap(text, _widest((text,), size) * 0.6, size)
        for lines in dict.fromkeys(((text,), middling, folded)):
            if "…" in "".join(lines):
                continue
            width = _widest(lines, size) + 2 * _AIR
            height = len(lines) * line_height(size) + 2 * _AIR
            ways = ((height, width, along), (width, height, along + 90))
            # The one that is read with the head less bent first.
            for across, deep, turned in sorted(ways, key=lambda way: abs(_upright(way[2]))):
                radius = _radius(arc, across, deep)
                if radius is not None:
                    x, y = radius * math.sin(arc.middle), -radius * math.cos(arc.middle)
                    return ArcLabel(x, y, _upright(turned), lines)
    return None


def _radius(arc: Arc, across: float, along: float) -> float | None:
    """Return the radius at which a box, `across` the radius by `along` it, fits; None: at none.

    The middle of the ring if it does there, else as far out as the ring goes, where it is wider.
    """
    outermost = math.sqrt(max(arc.outer**2 - (across / 2) ** 2, 0.0)) - along / 2
    for radius in ((arc.inner + arc.outer) / 2, outermost):
        near = radius - along / 2
        if near < arc.inner or radius > outermost:
            continue
        if (
            arc.end - arc.start >= math.pi
            or near * math.tan((arc.end - arc.start) / 2) >= across / 2
        ):
            return radius
    return None


def _upright(degrees: float) -> float:
    """Return a turn by which text is never upside down."""
    turned = (degrees + 180) % 360 - 180
    return turned - 180 if turned > 90 else turned + 180 if turned <= -90 else turned


def _widest(lines: Sequence[str], size: float) -> float:
    return max((text_width(line, size) for line in lines), default=0.0)


def _sector(arc: Arc, centre: tuple[float, float]) -> str:
    large = int(arc.end - arc.start > math.pi)

    def point(angle: float, radius: float) -> str:
        x = centre[0] + radius * math.sin(angle)
        return f"{x:.2f} {centre[1] - radius * math.cos(angle):.2f}"

    return (
        f"M{point(arc.start, arc.outer)}"
        f"A{arc.outer:.2f} {arc.outer:.2f} 0 {large} 1 {point(arc.end, arc.outer)}"
        f"L{point(arc.end, arc.inner)}"
        f"A{arc.inner:.2f} {arc.inner:.2f} 0 {large} 0 {point(arc.start, arc.inner)}Z"
    )
