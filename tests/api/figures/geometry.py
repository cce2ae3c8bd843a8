"""Boxes of what stands in an SVG, by the metrics of a real font: an oracle beside the layouts.

DejaVu Sans is the widest font of the page's list, and comes with Matplotlib.
"""

from __future__ import annotations

import itertools
import math
import re
from dataclasses import dataclass
from functools import cache
from xml.etree import ElementTree as ET

from matplotlib import font_manager
from matplotlib.ft2font import FT2Font, LoadFlags

from api.figures.svg import Drawing

SVG = "{http://www.w3.org/2000/svg}"
TOUCHING = 0.25  # px: coordinates are rounded to a tenth
ASCENT, DESCENT = 0.928, 0.236

Point = tuple[float, float]


@dataclass(frozen=True)
class Shape:
    """A text or a rectangle: what it says or its class, and its corners in turn."""

    kind: str
    said: str
    classes: frozenset[str]
    corners: tuple[Point, ...]


@cache
def font(bold: bool) -> FT2Font:
    weight = "bold" if bold else "normal"
    found = font_manager.findfont(font_manager.FontProperties(family="DejaVu Sans", weight=weight))
    return FT2Font(found)


@cache
def advance(letter: str, bold: bool) -> float:
    face = font(bold)
    return face.load_char(ord(letter), LoadFlags.NO_SCALE).horiAdvance / face.units_per_EM


def width_of(text: str, size: float, bold: bool) -> float:
    return size * sum(advance(letter, bold) for letter in text)


def shapes(drawing: Drawing) -> list[Shape]:
    """Texts and rectangles of a drawing."""
    root = ET.fromstring(drawing.document("t", "d", ""))
    found = []
    for element in root.iter():
        if element.tag == f"{SVG}rect":
            x, y, w, h = (float(element.get(name, "0")) for name in ("x", "y", "width", "height"))
            corners = ((x, y), (x + w, y), (x + w, y + h), (x, y + h))
            found.append(Shape("rect", element.get("class", ""), classes(element), corners))
        elif element.tag == f"{SVG}text":
            found += text_shapes(element)
    return found


def classes(element: ET.Element) -> frozenset[str]:
    return frozenset(element.get("class", "").split())


def text_shapes(element: ET.Element) -> list[Shape]:
    """One shape a line of a text."""
    lines = [span for span in element.findall(f"{SVG}tspan") if span.get("x")]
    return [text_shape(line, element) for line in lines or [element]]


def text_shape(line: ET.Element, text: ET.Element) -> Shape:
    said = "".join(line.itertext())
    size = float(text.get("font-size", "0"))
    assert size > 0, said
    width = width_of(said, size, text.get("font-weight") is not None)
    x, y = float(line.get("x", "")), float(line.get("y", ""))
    left = x - {"middle": width / 2, "end": width}.get(text.get("text-anchor", ""), 0.0)
    top, bottom = y - ASCENT * size, y + DESCENT * size
    corners = ((left, top), (left + width, top), (left + width, bottom), (left, bottom))
    turn = re.fullmatch(r"rotate\((\S+) (\S+) (\S+)\)", text.get("transform", ""))
    if turn:
        angle, *about = (float(part) for part in turn.groups())
        corners = tuple(rotated(corner, (about[0], about[1]), angle) for corner in corners)
    return Shape("text", said, classes(text), corners)


def rotated(point: Point, about: Point, degrees: float) -> Point:
    cosine, sine = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    x, y = point[0] - about[0], point[1] - about[1]
    return about[0] + x * cosine - y * sine, about[1] + x * sine + y * cosine


def overlap(a: Shape, b: Shape) -> bool:
    """Whether two convex shapes share more than an edge (separating axes)."""
    for axis in (0, 1):  # most pairs are far apart
        mine, others = ([corner[axis] for corner in s.corners] for s in (a, b))
        if max(mine) <= min(others) or max(others) <= min(mine):
            return False
    for shape in (a, b):
        for (x0, y0), (x1, y1) in itertools.pairwise((*shape.corners, shape.corners[0])):
            length = math.hypot(x1 - x0, y1 - y0)
            if length == 0:
                continue
            normal = ((y0 - y1) / length, (x1 - x0) / length)
            mine, others = ([x * normal[0] + y * normal[1] for x, y in s.corners] for s in (a, b))
            if min(max(mine), max(others)) - max(min(mine), min(others)) <= TOUCHING:
                return False
    return True


def overlaps(drawing: Drawing) -> list[tuple[str, str]]:
    """Pairs that overlap: texts with texts, rectangles with rectangles, texts with rectangles.

    A cell of a matrix holds its own number, which is no overlap.
    """
    found = shapes(drawing)
    return [
        (a.said, b.said)
        for a, b in itertools.combinations(found, 2)
        if not (a.kind != b.kind and "cell" in a.classes | b.classes) and overlap(a, b)
    ]


def outside(drawing: Drawing) -> list[str]:
    """What reaches over the edge of the drawing."""
    return [
        shape.said
        for shape in shapes(drawing)
        if any(
            x < -TOUCHING
            or y < -TOUCHING
            or x > drawing.width + TOUCHING
            or y > drawing.height + TOUCHING
            for x, y in shape.corners
        )
    ]
