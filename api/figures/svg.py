"""Writing SVG: a canvas of marks that have a title and, mostly, an address behind them.

Colours are classes of `api/static/styles/figures.css`, which stands in the page and in a drawing of
its own alike; sizes of letters are attributes, so that nothing in a style sheet makes labels meet.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import Literal

from api.figures.lettering import ASCENT, LINE, line_height, wrap

Anchor = Literal["start", "middle", "end"]

BODY = 13.0
"""Font size of labels, px."""
SMALL = 12.0
"""Font size where room is short, px."""

_MIDDLE = ASCENT - LINE / 2  # from the middle of a line down to its baseline


def number(value: float) -> str:
    """Return a coordinate with a tenth of a pixel."""
    return f"{value:.1f}".removesuffix(".0")


def attributes(**values: str | float | None) -> str:
    """Return attributes as they stand in a tag; an underscore is a hyphen, None is left out."""
    return "".join(
        f' {name.rstrip("_").replace("_", "-")}="'
        f'{escape(value) if isinstance(value, str) else number(value)}"'
        for name, value in values.items()
        if value is not None
    )


def rectangle(
    x: float, y: float, width: float, height: float, class_: str, *, rx: float | None = None
) -> str:
    """Return a rectangle."""
    placed = attributes(x=x, y=y, width=width, height=height, rx=rx)
    return f"<rect{attributes(class_=class_)}{placed}/>"


def path(d: str, class_: str) -> str:
    """Return a path."""
    return f"<path{attributes(class_=class_, d=d)}/>"


def line(x0: float, y0: float, x1: float, y1: float, class_: str) -> str:
    """Return a straight line."""
    return f"<line{attributes(class_=class_, x1=x0, y1=y0, x2=x1, y2=y1)}/>"


def text(
    x: float,
    y: float,
    lines: str | Sequence[str],
    class_: str = "label",
    *,
    size: float = BODY,
    anchor: Anchor = "start",
    bold: bool = False,
    turned: float | None = None,
    tail: str = "",
) -> str:
    """Return lines of text whose block is centred on height `y`.

    `turned` is an angle in degrees, clockwise, about (x, y); `tail` is an end of the last line that
    is set more quietly.
    """
    rows = (lines,) if isinstance(lines, str) else tuple(lines)
    step = line_height(size)
    top = y - step * (len(rows) - 1) / 2 + _MIDDLE * size
    spun = None if turned is None else f"rotate({number(turned)} {number(x)} {number(y)})"
    shared = attributes(
        class_=class_,
        font_size=size,
        font_weight="600" if bold else None,
        text_anchor=None if anchor == "start" else anchor,
        transform=spun,
    )
    written = [_quiet_tail(row, tail if at == len(rows) - 1 else "") for at, row in enumerate(rows)]
    if len(rows) == 1:
        return f"<text{shared}{attributes(x=x, y=top)}>{written[0]}</text>"
    spans = "".join(
        f"<tspan{attributes(x=x, y=top + step * at)}>{row}</tspan>"
        for at, row in enumerate(written)
    )
    return f"<text{shared}>{spans}</text>"


def fit(sentence: str, width: float, size: float = BODY) -> tuple[str, ...]:
    """Return a sentence in the lines that it takes at a width."""
    return wrap(sentence, width, size, most=8)


def _quiet_tail(row: str, tail: str) -> str:
    if not tail or not row.endswith(tail):
        return escape(row)
    return f'{escape(row[: -len(tail)])}<tspan class="quiet">{escape(tail)}</tspan>'


def mark(title: str, href: str | None, *shapes: str, reached: bool = True) -> str:
    """Return shapes under one title, which link to `href` where there is one.

    `reached` says whether the tab key stops here: marks by the hundred are also in the table.
    """
    inside = f"<title>{escape(title)}</title>{''.join(shapes)}"
    if href is None:
        return f'<g class="mark">{inside}</g>'
    skipped = "" if reached else ' tabindex="-1"'
    return f'<a class="mark"{attributes(href=href)}{skipped}>{inside}</a>'


@dataclass(frozen=True)
class Drawing:
    """A drawing in pixels, at the width for which it was laid out."""

    width: float
    height: float
    body: str

    def element(self, label: str, class_: str = "") -> str:
        """Return the `svg` element as it stands in a page; `label` names it to who cannot see."""
        named = attributes(class_=f"drawing {class_}".strip(), aria_label=label)
        return f'<svg role="group"{named}{self._box()}>{self.body}</svg>'

    def document(self, title: str, description: str, style: str) -> str:
        """Return an SVG document of its own, with its style sheet."""
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" class="drawing"{self._box()}>'
            f"<title>{escape(title)}</title><desc>{escape(description)}</desc>"
            f"<style>{style}</style>{self.body}</svg>\n"
        )

    def _box(self) -> str:
        size = attributes(width=self.width, height=self.height)
        return f'{size} viewBox="0 0 {number(self.width)} {number(self.height)}"'
