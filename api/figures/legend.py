"""A legend of colours: swatches with their meaning, line by line as there is room."""

from __future__ import annotations

from collections.abc import Sequence

from api.figures import svg
from api.figures.figure import Entry
from api.figures.lettering import line_height, text_width, wrap
from api.figures.svg import SMALL

SWATCH = 10.0
ROW = 20.0
_AFTER = 6.0  # between a swatch and its text
_BETWEEN = 18.0  # between entries


def legend(entries: Sequence[Entry], top: float, width: float) -> tuple[str, float]:
    """Return the legend from the height `top` on, and the height below it, px."""
    shapes = []
    x, y, low = 0.0, top, top
    room = width - SWATCH - _AFTER
    for entry in entries:
        lines = wrap(entry.text, room, SMALL, most=3)
        taken = SWATCH + _AFTER + max(text_width(line, SMALL) for line in lines)
        if x and x + taken > width:
            x, y = 0.0, low
        height = ROW + (len(lines) - 1) * line_height(SMALL)
        swatch = (x, y + (ROW - SWATCH) / 2, SWATCH, SWATCH)
        shapes.append(
            svg.rectangle(*swatch, f"swatch {entry.colour}")
            + svg.text(x + SWATCH + _AFTER, y + height / 2, lines, size=SMALL)
        )
        x += taken + _BETWEEN
        low = max(low, y + height)
    return "".join(shapes), low
