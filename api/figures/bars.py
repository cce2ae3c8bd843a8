"""Stacked bars as SVG: upright where there is room for their labels, else lying."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from api.figures import svg
from api.figures.lettering import line_height, text_width, wrap
from api.figures.svg import BODY, SMALL

UPRIGHT = 200.0  # height of the highest bar, px
THICKNESS = 16.0  # of a lying bar
_LABEL_GAP = 8.0


@dataclass(frozen=True)
class Part:
    """A part of a bar: its count and colour, what it says, where it leads."""

    count: int
    colour: str
    title: str
    href: str


@dataclass(frozen=True)
class Bar:
    """A bar: its label, a shorter one if there is, and its parts."""

    label: str
    short: str
    parts: tuple[Part, ...]

    @property
    def count(self) -> int:
        """What its parts add up to."""
        return sum(part.count for part in self.parts)


def upright_bars(bars: Sequence[Bar], top: float, width: float) -> tuple[str, float] | None:
    """Return upright bars from height `top` on and the height below them; None without room."""
    size = BODY if width > 900 else SMALL
    step = width / max(len(bars), 1)
    labels = [bar.label for bar in bars]
    if max((text_width(label, size) for label in labels), default=0.0) > step - 4:
        labels = [bar.short for bar in bars]
    if max((text_width(label, size) for label in labels), default=0.0) > step - 2:
        return None
    high = max((bar.count for bar in bars), default=0) or 1
    ground = top + line_height(size) + UPRIGHT
    thick = min(step * 0.68, 34.0)
    shapes = [svg.line(0, ground, width, ground, "axis")]
    letters = []
    for at, bar in enumerate(bars):
        middle = step * (at + 0.5)
        y = ground
        for part in bar.parts:
            height = UPRIGHT * part.count / high
            y -= height
            shape = svg.rectangle(middle - thick / 2, y, thick, height, f"bar {part.colour}")
            shapes.append(svg.mark(part.title, part.href, shape))
        half = line_height(size) / 2
        if bar.count:
            count = svg.text(middle, y - half, str(bar.count), "label", size=size, anchor="middle")
            letters.append(count)
        letters.append(
            svg.text(middle, ground + 4 + half, labels[at], "quiet", size=size, anchor="middle")
        )
    return "".join(shapes + letters), ground + 4 + line_height(size)


def horizontal_bars(bars: Sequence[Bar], top: float, width: float) -> tuple[str, float]:
    """Return lying bars from height `top` on, and the height below them.

    Labels stand left of the bars, or above them where they would take half of the width.
    """
    size = BODY if width > 900 else SMALL
    high = max((bar.count for bar in bars), default=0) or 1
    number_room = text_width(str(high), size) + _LABEL_GAP
    widest = max((text_width(bar.label, size) for bar in bars), default=0.0)
    above = widest > width / 2
    left = 0.0 if above else widest + _LABEL_GAP
    scale = (width - left - number_room) / high
    shapes, letters = [], []
    y = top
    for bar in bars:
        if above:
            lines = wrap(bar.label, width, size, most=3)
            letters.append(svg.text(0, y + len(lines) * line_height(size) / 2, lines, size=size))
            y += len(lines) * line_height(size) + 1
        step = THICKNESS + (8 if above else 5)
        middle = y + THICKNESS / 2
        if not above:
            letters.append(svg.text(widest, middle, bar.label, size=size, anchor="end"))
        x = left
        for part in bar.parts:
            long = scale * part.count
            shape = svg.rectangle(x, y, long, THICKNESS, f"bar {part.colour}")
            shapes.append(svg.mark(part.title, part.href, shape))
            x += long
        letters.append(svg.text(x + _LABEL_GAP / 2, middle, str(bar.count), "quiet", size=size))
        y += step
    return "".join(shapes + letters), y
