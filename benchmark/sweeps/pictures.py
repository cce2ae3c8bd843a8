"""Pictures of error against noise, feature size and phase: a panel a method, with its bound.

Plain SVG written here, so that the same rows give the same bytes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any
from xml.sax.saxutils import escape

from benchmark.reference.series import SWEEPS
from benchmark.sweeps.plan import SERIES

Row = Mapping[str, Any]

#: Sweeps that are drawn; a phase is no ratio, so its axis is linear.
DRAWN = ("noise", "size", "phase")
_LINEAR = frozenset({"phase"})

_COLUMNS = 5
_WIDTH, _HEIGHT = 214, 168
_LEFT, _RIGHT, _TOP, _BOTTOM = 46, 10, 34, 30
_MARGIN, _HEAD = 12, 58
_ERROR, _BOUND, _INK, _FAINT, _GRID = "#0b5fa5", "#b3541e", "#1a1d21", "#5c6570", "#e3e7eb"


@dataclass(frozen=True)
class _Panel:
    name: str
    series: str
    about: str
    unit: str
    places: tuple[float, ...]
    errors: tuple[float | None, ...]
    bounds: tuple[float | None, ...]
    complete: tuple[bool, ...]


@dataclass(frozen=True)
class _Axis:
    """Maps values to pixels, logarithmically or not."""

    low: float
    high: float
    start: float
    stop: float
    logarithmic: bool = True

    def at(self, value: float) -> float:
        one, other, v = self.low, self.high, value
        if self.logarithmic:
            one, other, v = math.log10(one), math.log10(other), math.log10(v)
        return self.start + (v - one) / (other - one) * (self.stop - self.start)


def picture(rows: Sequence[Row], sweep: str) -> str:
    """Draw one sweep of every method: error (line and dots) and bound (dashed) by panel.

    Dots are hollow where less than 90 % are found; an error of zero has no place on the axis.
    ValueError for a sweep that is not drawn.
    """
    if sweep not in DRAWN:
        raise ValueError(f"sweep must be one of {', '.join(DRAWN)}; got {sweep!r}")
    panels = _panels(rows, sweep)
    lines = max(1, math.ceil(len(panels) / _COLUMNS))
    width = 2 * _MARGIN + _COLUMNS * _WIDTH
    height = _HEAD + lines * _HEIGHT + _MARGIN
    opening = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
        f'viewBox="0 0 {width} {height}" font-family="system-ui, sans-serif" role="img" '
        f'aria-label="Error against {escape(SWEEPS[sweep])} of every method, with its bound">'
    )
    parts = [
        opening,
        f'<rect width="{width}" height="{height}" fill="#ffffff"/>',
        _text((_MARGIN, 22), f"Error against {SWEEPS[sweep]}", 15, weight=600),
        *_legend(_MARGIN, 42),
    ]
    for number, panel in enumerate(panels):
        x = _MARGIN + number % _COLUMNS * _WIDTH
        y = _HEAD + number // _COLUMNS * _HEIGHT
        alike = [other for other in panels if other.series == panel.series]
        values = [v for other in alike for v in (*other.errors, *other.bounds) if v]
        parts += _drawn(panel, (x, y), sweep, _decades(values))
    if not panels:
        parts.append(_text((_MARGIN, 70), "nothing is stored", 11, colour=_FAINT))
    return "\n".join([*parts, "</svg>"]) + "\n"


def _panels(rows: Sequence[Row], sweep: str) -> list[_Panel]:
    found: dict[tuple[str, str, str], list[Row]] = {}
    for row in rows:
        if row["sweep"] == sweep and row["value"] is not None:
            key = (row["series"], row["extractor"], row["extractor_taxonomy"])
            found.setdefault(key, []).append(row)
    order = [*SERIES]
    panels = []
    for (series, extractor, taxonomy), group in sorted(
        found.items(), key=lambda item: (order.index(item[0][0]), item[0][1])
    ):
        points = sorted(group, key=lambda row: row["value"])
        panels.append(
            _Panel(
                extractor,
                series,
                series if taxonomy == "None" else f"{taxonomy}, {series}",
                points[0]["unit"],
                tuple(row["value"] for row in points),
                tuple(row["rms"] for row in points),
                tuple(row["bound"] for row in points),
                tuple((row["found_fraction"] or 0.0) >= 0.9 for row in points),
            )
        )
    return panels


def _drawn(
    panel: _Panel, corner: tuple[float, float], sweep: str, decades: tuple[float, float]
) -> list[str]:
    (x, y), (low, high) = corner, decades
    right, bottom = x + _WIDTH - _RIGHT, y + _HEIGHT - _BOTTOM
    linear = sweep in _LINEAR
    room = (max(panel.places) - min(panel.places)) * 0.04 if linear else 0.0
    across = _Axis(
        min(panel.places) - room if linear else min(panel.places) / 1.12,
        max(panel.places) + room if linear else max(panel.places) * 1.12,
        x + _LEFT,
        right,
        not linear,
    )
    up = _Axis(low, high, bottom, y + _TOP)
    parts = [
        _text((x + _LEFT, y + 13), panel.name, 11.5, weight=600),
        _text((x + _LEFT, y + 26), f"{panel.about} ({panel.unit})", 10, colour=_FAINT),
    ]
    exponents = range(round(math.log10(low)), round(math.log10(high)) + 1)
    step = 1 if len(exponents) <= 5 else 2
    for exponent in exponents:
        at = up.at(10.0**exponent)
        parts.append(_line((x + _LEFT, at), (right, at), _GRID))
        if (exponent - exponents[0]) % step == 0:
            parts.append(
                _text((x + _LEFT - 5, at + 3.5), _power(exponent), 9.5, _FAINT, anchor="end")
            )
    for place in _ticks(panel.places, sweep):
        at = across.at(place)
        parts.append(_line((at, bottom), (at, bottom + 3), _FAINT))
        parts.append(_text((at, bottom + 14), f"{place:g}", 9.5, _FAINT, anchor="middle"))
    parts.append(_line((x + _LEFT, bottom), (right, bottom), _FAINT))
    parts += _curve(
        panel.places, panel.bounds, across, up, f'stroke="{_BOUND}" stroke-dasharray="5 3"'
    )
    if not any(panel.errors):
        middle = ((x + _LEFT + right) / 2.0, (y + _TOP + bottom) / 2.0)
        parts.append(_text(middle, "nothing found", 10, _FAINT, anchor="middle"))
    parts += _curve(panel.places, panel.errors, across, up, f'stroke="{_ERROR}"')
    for place, error, whole in zip(panel.places, panel.errors, panel.complete, strict=True):
        if error:
            fill = _ERROR if whole else "#ffffff"
            parts.append(
                f'<circle cx="{across.at(place):.1f}" cy="{up.at(error):.1f}" r="2.6" '
                f'fill="{fill}" stroke="{_ERROR}"/>'
            )
    return parts


def _curve(
    places: Sequence[float], values: Sequence[float | None], across: _Axis, up: _Axis, style: str
) -> list[str]:
    points = " ".join(
        f"{across.at(place):.1f},{up.at(value):.1f}"
        for place, value in zip(places, values, strict=True)
        if value
    )
    return (
        [f'<polyline points="{points}" fill="none" stroke-width="1.6" {style}/>'] if points else []
    )


def _decades(values: Sequence[float]) -> tuple[float, float]:
    """Return whole powers of ten around positive values."""
    if not values:
        return 0.1, 1.0
    low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
    return 10.0**low, 10.0 ** max(high, low + 1)


def _ticks(places: Sequence[float], sweep: str) -> list[float]:
    if sweep == "noise":
        return [place for place in (5.0, 20.0, 100.0, 500.0) if min(places) <= place <= max(places)]
    return list(places)[::2] if len(places) > 5 else list(places)


def _legend(x: float, y: float) -> list[str]:
    return [
        _line((x, y - 4), (x + 26, y - 4), _ERROR, 'stroke-width="1.6"'),
        f'<circle cx="{x + 13}" cy="{y - 4}" r="2.6" fill="{_ERROR}" stroke="{_ERROR}"/>',
        _text((x + 32, y), "rms error of one coordinate", 11, _FAINT),
        f'<circle cx="{x + 205}" cy="{y - 4}" r="2.6" fill="#ffffff" stroke="{_ERROR}"/>',
        _text((x + 213, y), "less than 90 % found", 11, _FAINT),
        _line(
            (x + 345, y - 4), (x + 371, y - 4), _BOUND, 'stroke-width="1.6" stroke-dasharray="5 3"'
        ),
        _text((x + 377, y), "Cramer-Rao bound", 11, _FAINT),
    ]


def _power(exponent: int) -> str:
    digits = str(exponent).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"10{digits}"


def _line(
    one: tuple[float, float], other: tuple[float, float], colour: str, style: str = ""
) -> str:
    (x1, y1), (x2, y2) = one, other
    return (
        f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{colour}" {style}/>'
    )


def _text(
    place: tuple[float, float],
    words: str,
    size: float,
    colour: str = _INK,
    *,
    anchor: str = "start",
    weight: int = 400,
) -> str:
    x, y = place
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size:g}" font-weight="{weight}" '
        f'fill="{colour}" text-anchor="{anchor}">{escape(words)}</text>'
    )
