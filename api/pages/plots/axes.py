"""Scales of a chart's axes, and the frame they are drawn in."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from markupsafe import Markup

from api.pages.numbers import number

WIDTH, HEIGHT = 460, 300
LEFT, RIGHT, TOP, BOTTOM = 68, 12, 12, 44


@dataclass(frozen=True)
class Scale:
    """Where values lie between two pixels.

    Attributes
    ----------
    minimum, maximum : ends in the values' unit
    start, end : their pixels
    logarithmic : whether equal ratios are equally long
    """

    minimum: float
    maximum: float
    start: float
    end: float
    logarithmic: bool = False

    def at(self, value: float) -> float:
        """Return the pixel of a value."""
        if self.logarithmic:
            share = math.log(value / self.minimum) / math.log(self.maximum / self.minimum)
        else:
            share = (value - self.minimum) / (self.maximum - self.minimum)
        return round(self.start + share * (self.end - self.start), 1)

    def ticks(self) -> list[float]:
        """Return round values within the ends: some three to seven."""
        if not self.logarithmic:
            return _even(self.minimum, self.maximum)
        first, last = math.floor(math.log10(self.minimum)), math.ceil(math.log10(self.maximum))
        for steps in ((1,), (1, 3), (1, 2, 5)):
            every = [s * 10.0**power for power in range(first, last + 1) for s in steps]
            inside = [v for v in every if self.minimum * 0.999 <= v <= self.maximum * 1.001]
            if len(inside) > 2:
                return inside[:: math.ceil(len(inside) / 7)]
        return _even(self.minimum, self.maximum)  # less than a decade: even steps tell more


def scale(
    values: Iterable[float],
    start: float,
    end: float,
    *,
    logarithmic: bool = False,
    from_zero: bool = True,
) -> Scale:
    """Return a scale that holds all values with some room; those a logarithm lacks are left out.

    Zero is held where it is near, unless `from_zero` is false.
    """
    kept = [v for v in values if math.isfinite(v) and (v > 0 or not logarithmic)]
    least, most = min(kept, default=1.0), max(kept, default=2.0)
    if logarithmic:
        room = max((most / least) ** 0.06, 1.12)
        return Scale(least / room, most * room, start, end, logarithmic=True)
    room = 0.05 * (most - least) or 0.5
    return Scale(
        0.0 if from_zero and 0 <= least < most / 2 else least - room, most + room, start, end
    )


def _even(least: float, most: float) -> list[float]:
    rough = (most - least) / 5
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(s * power for s in (1, 2, 5, 10) if s * power >= rough)
    first = math.ceil(least / step)
    return [round(k * step, 10) for k in range(first, math.floor(most / step) + 1)]


def tick_text(value: float) -> str:
    """Return a round value as short as it is."""
    return f"{value:g}" if 1e-4 <= abs(value) < 1e5 or value == 0 else number(value, 1)


def frame(across: Scale, up: Scale, across_name: str, up_name: str) -> Markup:
    """Return grid, ticks and names of both axes."""
    right, bottom = WIDTH - RIGHT, HEIGHT - BOTTOM
    parts = []
    for value in across.ticks():
        x = across.at(value)
        parts.append(f'<path class="grid" d="M{x} {TOP}V{bottom}"/>')
        parts.append(f'<text class="tick" x="{x}" y="{bottom + 16}" text-anchor="middle">'
                     f"{tick_text(value)}</text>")  # fmt: skip
    for value in up.ticks():
        y = up.at(value)
        parts.append(f'<path class="grid" d="M{LEFT} {y}H{right}"/>')
        parts.append(f'<text class="tick" x="{LEFT - 6}" y="{y + 4}" text-anchor="end">'
                     f"{tick_text(value)}</text>")  # fmt: skip
    middle = (LEFT + right) / 2
    names = Markup(
        '<path class="axis" d="M{left} {top}V{bottom}H{right}"/>'
        '<text class="name" x="{middle}" y="{low}" text-anchor="middle">{across}</text>'
        '<text class="name" transform="translate(13 {half}) rotate(-90)" text-anchor="middle">'
        "{up}</text>"
    ).format(
        left=LEFT, top=TOP, bottom=bottom, right=right, middle=middle, low=HEIGHT - 8,
        half=(TOP + bottom) / 2, across=across_name, up=up_name,
    )  # fmt: skip
    grid = Markup("".join(parts))  # noqa: S704 - numbers and words of ours
    return grid + names


def svg(content: Markup, label: str, kind: str = "plot", role: str = "img") -> Markup:
    """Return a chart: what is drawn, and what it says to who cannot see it."""
    return Markup(
        '<svg class="{kind}" viewBox="0 0 {width} {height}" role="{role}" aria-label="{label}">'
        "{content}</svg>"
    ).format(kind=kind, role=role, width=WIDTH, height=HEIGHT, label=label, content=content)
