"""A figure: what it tells as a table and in words, and how it is drawn at a width."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from api.figures.svg import Drawing
from registry.flows import LeftOut

WIDTHS: Mapping[str, float] = {"wide": 1100.0, "medium": 680.0, "narrow": 322.0}
"""Widths in px that figures are laid out for; the page's style sheet shows the one that fits."""

Row = Mapping[str, Any]


@dataclass(frozen=True)
class Entry:
    """A line of a legend: its colour, and what it stands for."""

    colour: str
    text: str


@dataclass(frozen=True)
class Figure:
    """One figure of the survey, or the matrix, of some studies.

    Attributes
    ----------
    name : in its address
    title, caption : as they are read
    text : what the figure shows, in sentences, for who does not see it
    studies : number of those that meet the filters
    left_out : studies that a part of the figure cannot show, by level
    columns : of the table, fixed
    rows : of the table; `studies` of a row are the keys behind its mark
    draw : width in px -> drawing
    options : what was asked besides filters
    counts : of the matrix: state -> number of pairs
    """

    name: str
    title: str
    caption: str
    text: tuple[str, ...]
    studies: int
    left_out: tuple[LeftOut, ...]
    columns: tuple[str, ...]
    rows: tuple[Row, ...]
    draw: Callable[[float], Drawing]
    options: Mapping[str, str] = field(default_factory=dict)
    counts: Mapping[str, int] = field(default_factory=dict)

    @cached_property
    def drawings(self) -> Mapping[str, Drawing]:
        """The figure at every width."""
        return {name: self.draw(width) for name, width in WIDTHS.items()}

    @property
    def description(self) -> str:
        """The text, as one."""
        return " ".join(self.text)

    def to_dict(self) -> dict[str, Any]:
        """As in the HTTP answer."""
        return {
            "figure": self.name,
            "title": self.title,
            "caption": self.caption,
            "text": list(self.text),
            "studies": self.studies,
            "options": dict(self.options),
            "counts": dict(self.counts),
            "left_out": [left.to_dict() for left in self.left_out],
            "columns": list(self.columns),
            "rows": [dict(row) for row in self.rows],
        }


def in_words(left_out: Sequence[LeftOut], names: Mapping[str, str]) -> str:
    """Return a sentence on the studies that state nothing at a level; "" where all do."""
    if not left_out:
        return ""
    parts = [f"{names[left.level].lower()}: {len(left.studies)}" for left in left_out]
    return f"Studies with an unknown value are not drawn ({'; '.join(parts)})."
