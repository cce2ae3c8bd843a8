"""Small drawings of sensors: a mask above a detector, light through its openings."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

from markupsafe import Markup

from api.pages.terms import display_text, term_name

Point = tuple[float, float]
Shape = Sequence[Point]

WIDTH, HEIGHT = 120, 92
MASK, DETECTOR = 26.0, 70.0  # heights on the page of the two planes' middles
#: How far light moves on its way down: the Sun stands aside.
ASIDE: Point = (0.22, 0.12)


def _box(x: float, y: float, width: float, height: float) -> Shape:
    a, b = width / 2, height / 2
    return ((x - a, y - b), (x + a, y - b), (x + a, y + b), (x - a, y + b))


def _round(x: float, y: float, radius: float) -> Shape:
    corners = ((1, 0), (0.71, 0.71), (0, 1), (-0.71, 0.71), (-1, 0), (-0.71, -0.71), (0, -1),
               (0.71, -0.71))  # fmt: skip
    return tuple((x + radius * a, y + radius * b) for a, b in corners)


def _strip(start: Point, end: Point, width: float = 0.07) -> Shape:
    (x0, y0), (x1, y1) = start, end
    return ((x0 - width, y0), (x0 + width, y0), (x1 + width, y1), (x1 - width, y1))


#: Openings of each mask in its plane, from -1 to 1 along x and y.
OPENINGS: dict[str, Sequence[Shape]] = {
    "Single-Ap.": [_round(0, 0, 0.28)],
    "Multi-Ap.": [_round(x, y, 0.15) for x, y in product((-0.55, 0, 0.55), repeat=2)],
    "Slit": [_box(0, 0, 0.18, 1.5)],
    "L-Slit": [_box(-0.45, 0, 0.16, 1.4), _box(0.1, 0.62, 0.95, 0.16)],
    "N-Slit": [
        _strip((-0.6, -0.7), (-0.6, 0.7)),
        _strip((-0.4, 0.7), (0.4, -0.7)),
        _strip((0.6, -0.7), (0.6, 0.7)),
    ],
    "V-Slit": [_strip((-0.65, 0.7), (-0.12, -0.7)), _strip((0.65, 0.7), (0.12, -0.7))],
    "Multi-Slit": [_box(x, 0, 0.12, 1.5) for x in (-0.6, -0.2, 0.2, 0.6)],
    "Encoded": [
        _box(x, y, 0.2, 0.2)
        for x, y in (
            (-0.6, -0.6),
            (-0.2, -0.6),
            (0.5, -0.6),
            (-0.6, -0.1),
            (0.2, -0.1),
            (0.6, 0.2),
            (-0.3, 0.3),
            (-0.6, 0.65),
            (0.1, 0.65),
            (0.55, 0.7),
        )
    ],
}
#: Lines that part a detector into elements: number of columns and of rows.
ELEMENTS = {
    "CMOS": (8, 8),
    "CCD": (8, 8),
    "Event": (6, 6),
    "PDA": (10, 1),
    "QPD": (2, 2),
    "PVA": (3, 2),
}
FLAT = {"PDA": 0.24}  # share of the plane that a detector is high


def _place(point: Point, height: float) -> str:
    x, y = point
    return f"{WIDTH / 2 + 34 * x - 13 * y:.1f} {height + 13 * y:.1f}"


def _path(shape: Shape, height: float, kind: str) -> str:
    return f'<path class="{kind}" d="M{"L".join(_place(p, height) for p in shape)}Z"/>'


def _elements(detector: str) -> str:
    columns, rows = ELEMENTS.get(detector, (1, 1))
    half = FLAT.get(detector, 1.0)
    lines = [
        (((x, -half), (x, half))) for x in (-1 + 2 * k / columns for k in range(1, columns))
    ] + [(((-1, y), (1, y))) for y in (half * (2 * k / rows - 1) for k in range(1, rows))]
    drawn = "".join(f"M{_place(a, DETECTOR)}L{_place(b, DETECTOR)}" for a, b in lines)
    plane = _path(_box(0, 0, 2, 2 * half), DETECTOR, "detector")
    return plane + (f'<path class="element" d="{drawn}"/>' if drawn else "")


def _move(shape: Shape) -> Shape:
    return tuple((x + ASIDE[0], y + ASIDE[1]) for x, y in shape)


def _middle(shape: Shape) -> Point:
    return (sum(x for x, _ in shape) / len(shape), sum(y for _, y in shape) / len(shape))


def _ray(start: Point, end: Point, high: float, low: float) -> str:
    return f'<path class="ray" d="M{_place(start, high)}L{_place(end, low)}"/>'


def _with_mask(mask: str) -> tuple[str, str]:
    """Return what is drawn on the detector's plane, and what above it."""
    openings = OPENINGS[mask]
    light = "".join(_path(_move(shape), DETECTOR, "light") for shape in openings)
    if mask in {"Slit", "Multi-Slit", "L-Slit", "N-Slit", "V-Slit"}:
        rays = [(_middle(shape), _middle(_move(shape))) for shape in openings[:2]]
    else:
        rays = [(_middle(s), _middle(_move(s))) for s in openings[:: max(1, len(openings) // 3)]]
    down = "".join(_ray(a, b, MASK, DETECTOR) for a, b in rays)
    plate = _path(_box(0, 0, 2, 2), MASK, "plate")
    holes = "".join(_path(shape, MASK, "hole") for shape in openings)
    return light + down, plate + holes


def _lens() -> tuple[str, str]:
    spot = _path(_move(_round(0, 0, 0.12)), DETECTOR, "light")
    rays = "".join(_ray((x, 0), ASIDE, MASK, DETECTOR) for x in (-0.7, 0.0, 0.7))
    glass = f'<ellipse class="lens" cx="{WIDTH / 2}" cy="{MASK}" rx="32" ry="10"/>'
    return spot + rays, glass


def _open() -> tuple[str, str]:
    rays = "".join(
        _ray((x - 0.35, -0.6), (x, 0.1), MASK - 12, DETECTOR) for x in (-0.6, -0.1, 0.4, 0.9)
    )
    return rays, ""


def sensor(detector: str, mask: str) -> Markup:
    """Return a drawing of a detector behind a mask; values of the taxonomy."""
    if mask == "Lens":
        below, above = _lens()
    elif mask in OPENINGS:
        below, above = _with_mask(mask)
    else:
        below, above = _open()
    faces = ""
    if mask == "Maskless" and detector not in {"CMOS", "CCD", "Event", "PDA"}:
        # Elements on the faces of a body, each lit by how it is turned to the Sun.
        faces = (
            '<path class="detector" d="M40 54L60 42L60 72L40 84Z"/>'
            '<path class="detector lit" d="M60 42L84 52L84 82L60 72Z"/>'
            '<path class="detector lit" d="M40 54L62 63L84 52L60 42Z"/>'
        )
    under = display_text(term_name(mask, "mask"), "mask").lower()
    said = f"{term_name(detector, 'detector')}, {under}"
    ground = faces or _elements(detector)
    return Markup(
        '<svg class="sensor" viewBox="0 0 {} {}" role="img" aria-label="{}">{}</svg>'
    ).format(WIDTH, HEIGHT, f"Drawing: {said}", Markup(ground + below + above))  # noqa: S704 - ours
