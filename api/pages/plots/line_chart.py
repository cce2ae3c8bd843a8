"""Lines of one quantity over another, with bands and their bound."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from api.pages.numbers import number
from api.pages.plots.axes import BOTTOM, HEIGHT, LEFT, RIGHT, TOP, WIDTH, frame, scale, svg

_DOT = Markup('<circle class="dot {}" cx="{}" cy="{}" r="3.5"><title>{}</title></circle>')
SHADES = 6  # of lines, in the style sheet


@dataclass(frozen=True)
class Line:
    """A line of a chart.

    Attributes
    ----------
    name : in the legend
    points : (across, up); up is None where there is nothing, also where NaN was given
    band : (across, low, high) around it, if any
    is_bound : whether it is a limit, which is dashed
    """

    name: str
    points: Sequence[tuple[float, float | None]]
    band: Sequence[tuple[float, float | None, float | None]] = ()
    is_bound: bool = False

    def __post_init__(self) -> None:
        points = [(x, _finite(y)) for x, y in self.points]
        object.__setattr__(self, "points", points)
        band = [(x, _finite(low), _finite(high)) for x, low, high in self.band]
        whole = [(x, *((a, b) if None not in {a, b} else (None, None))) for x, a, b in band]
        object.__setattr__(self, "band", whole)

    def at(self, across: float) -> float | None:
        """Return its value at a place; None where it has none."""
        return next((y for x, y in self.points if x == across), None)


@dataclass(frozen=True)
class LineChart:
    """Lines over one pair of axes; an axis is logarithmic where it is said."""

    lines: Sequence[Line]
    across: str
    up: str
    label: str
    log_across: bool = False
    log_up: bool = True

    def __html__(self) -> str:
        """Return the SVG."""
        bands = [(x, y) for line in self.lines for x, low, high in line.band for y in (low, high)]
        given = [point for line in self.lines for point in line.points] + bands
        places = [(x, y) for x, y in given if y is not None]
        log_up = self.log_up and all(y > 0 for _, y in places)
        log_across = self.log_across and all(x > 0 for x, _ in places)
        across = scale((x for x, _ in places), LEFT, WIDTH - RIGHT, logarithmic=log_across)
        up = scale((y for _, y in places), HEIGHT - BOTTOM, TOP, logarithmic=log_up)
        parts = [frame(across, up, self.across, self.up)]
        number_of = 0
        for line in self.lines:
            kind = "limit" if line.is_bound else f"line{number_of % SHADES}"
            number_of += not line.is_bound
            lows = _runs([(x, low) for x, low, _ in line.band])
            highs = _runs([(x, high) for x, _, high in line.band])
            for low, high in zip(lows, highs, strict=True):
                edge = [f"{across.at(x)} {up.at(y)}" for x, y in (*high, *reversed(low))]
                parts.append(
                    Markup('<path class="band {}" d="M{}Z"/>').format(kind, "L".join(edge))
                )
            for run in _runs(line.points):
                path = "L".join(f"{across.at(x)} {up.at(y)}" for x, y in run)
                parts.append(Markup('<path class="line {}" d="M{}"/>').format(kind, path))
            if line.is_bound:
                continue
            for x, y in line.points:
                if y is not None:
                    said = f"{line.name}: {number(x)}, {number(y)}"
                    parts.append(_DOT.format(kind, across.at(x), up.at(y), said))
        return str(svg(Markup("").join(parts), self.label))

    @property
    def legend(self) -> list[tuple[str, str]]:
        """Class and name of each line."""
        shades = iter(f"line{k % SHADES}" for k in range(len(self.lines)))
        return [("limit" if x.is_bound else next(shades), x.name) for x in self.lines]

    @property
    def places(self) -> list[float]:
        """Every place that a line has a point at, in order."""
        return sorted({x for line in self.lines for x, _ in line.points})

    @property
    def has_points(self) -> bool:
        """Whether there is anything to draw."""
        return any(y is not None for line in self.lines for _, y in line.points)


def _finite(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else value


def _runs(points: Sequence[tuple[float, float | None]]) -> list[list[tuple[float, float]]]:
    """Return the points in runs without a gap."""
    runs: list[list[tuple[float, float]]] = [[]]
    for x, y in points:
        if y is None:
            runs.append([])
        else:
            runs[-1].append((x, y))
    return [run for run in runs if run]
