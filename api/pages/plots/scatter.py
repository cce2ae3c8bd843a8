"""Architectures as points: error over field or effort, bounds and the Pareto front."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from api.pages.numbers import degrees, wide
from api.pages.plots.axes import BOTTOM, HEIGHT, LEFT, RIGHT, TOP, WIDTH, Scale, frame, scale, svg

Box = tuple[float, float, float, float]

_POINT = Markup(
    '<a href="{at}"><title>{said}</title>{stem}<circle class="dot {kind}" cx="{x}" cy="{y}" r="5"/>'
    "</a>"
)
_STEM = Markup(
    '<path class="stem" d="M{x} {y}V{low}"/><path class="tick-bound" d="M{a} {low}H{b}"/>'
)
_LABEL = Markup('<text class="label" x="{}" y="{}" text-anchor="{}">{}</text>')
_LETTER = 6.2  # mean width of a letter of a label


@dataclass(frozen=True)
class Point:
    """An architecture.

    Attributes
    ----------
    name : as labelled
    address : where a press leads
    across, error_deg : its place
    bound_deg : the limit of its error; None where it has none
    is_built : whether a study or product realises it
    """

    name: str
    address: str
    across: float
    error_deg: float
    bound_deg: float | None
    is_built: bool = True


@dataclass(frozen=True)
class Scatter:
    """Points over a pair of axes.

    Attributes
    ----------
    up : which error, in words
    more_is_better : whether a larger value across is better, as a field is and an effort is not
    left_out : names of measured architectures that have no value across
    """

    points: Sequence[Point]
    up: str
    across: str
    more_is_better: bool
    unit: str = ""
    left_out: Sequence[str] = ()

    @property
    def front(self) -> list[Point]:
        """Points that no other beats in both, from the least error on."""
        ranked = sorted(self.points, key=lambda p: (p.error_deg, self._worth(p)))
        kept: list[Point] = []
        for point in ranked:
            if not kept or self._worth(point) < self._worth(kept[-1]):
                kept.append(point)
        return kept

    def _worth(self, point: Point) -> float:
        return -point.across if self.more_is_better else point.across

    def __html__(self) -> str:
        """Return the SVG."""
        ups = [y for p in self.points for y in (p.error_deg, p.bound_deg) if y]
        up = scale(ups, HEIGHT - BOTTOM, TOP, logarithmic=True)
        log = not self.more_is_better
        across = scale(
            (p.across for p in self.points), LEFT, WIDTH - RIGHT, logarithmic=log, from_zero=False
        )
        front = self.front
        parts = [frame(across, up, self.across, f"{self.up}, °"), self._line(front, across, up)]
        places = {p.name: (across.at(p.across), up.at(p.error_deg)) for p in self.points}
        parts += [
            self._point(point, places[point.name], up, front=point in front)
            for point in sorted(self.points, key=lambda p: p in front)
        ]
        parts += _labels(front, [p for p in self.points if p not in front], places)
        label = (
            f"{self.up.capitalize()} of {len(self.points)} architectures against {self.across}; "
            "the list has the same numbers"
        )
        return str(svg(Markup("").join(parts), label, "plot scatter", role="group"))

    def _line(self, front: Sequence[Point], across: Scale, up: Scale) -> Markup:
        steps = [(across.at(p.across), up.at(p.error_deg)) for p in front]
        if not steps:
            return Markup("")
        path = f"M{steps[0][0]} {steps[0][1]}" + "".join(f"V{y}H{x}" for x, y in steps[1:])
        return Markup('<path class="front" d="{}"/>').format(path)

    def _point(self, point: Point, place: tuple[float, float], up: Scale, *, front: bool) -> Markup:
        x, y = place
        stem = Markup("")
        if point.bound_deg:
            stem = _STEM.format(x=x, y=y, low=up.at(point.bound_deg), a=x - 3, b=x + 3)
        bound = f", bound {degrees(point.bound_deg)}" if point.bound_deg else ""
        value = wide(point.across) if self.unit == "°" else f"{point.across:g} {self.unit}"
        unbuilt = "" if point.is_built else ", never built"
        said = f"{point.name}: {self.up} {degrees(point.error_deg)}{bound}, {value}{unbuilt}"
        kind = f"{'pareto' if front else 'other'}{'' if point.is_built else ' unbuilt'}"
        return _POINT.format(at=point.address, said=said, stem=stem, kind=kind, x=x, y=y)


def _labels(
    first: Sequence[Point], then: Sequence[Point], places: dict[str, tuple[float, float]]
) -> list[Markup]:
    """Return names beside points, as many as find room; those of the front first."""
    taken: list[Box] = [(x - 6, y - 6, x + 6, y + 6) for x, y in places.values()]
    drawn = []
    for point in [*first, *then]:
        x, y = places[point.name]
        long = _LETTER * len(point.name)
        for dx, dy, anchor in (
            (9, 4, "start"),
            (-9, 4, "end"),
            (0, -9, "middle"),
            (0, 17, "middle"),
        ):
            left = x + dx - {"start": 0.0, "end": long, "middle": long / 2}[anchor]
            box = (left, y + dy - 10, left + long, y + dy + 2)
            if box[0] < LEFT or box[2] > WIDTH - 2 or box[1] < 0 or box[3] > HEIGHT - BOTTOM:
                continue
            if not any(_overlap(box, other) for other in taken):
                taken.append(box)
                drawn.append(_LABEL.format(round(x + dx, 1), round(y + dy, 1), anchor, point.name))
                break
    return drawn


def _overlap(a: Box, b: Box) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
