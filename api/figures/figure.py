"""A figure: what it tells as a table and in words, and how Plotly draws it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from registry.flows import LeftOut

if TYPE_CHECKING:
    import plotly.graph_objects as go

Row = Mapping[str, Any]


@dataclass(frozen=True)
class Figure:
    """One figure. It needs a name, title, caption, text, columns, rows and `plotly`.

    A page shows it by `View(..., figures=(figure,))` of a `PageRouter.page(..., figures=True)` and
    in its template `{{ parts.live_figure(figure, base, query) }}`: first as a picture
    (`api.figures.picture`), then live (`api/static/live.js`).

    Attributes
    ----------
    name : in its address
    title, caption : as they are read
    text : what the figure shows, in sentences, for who does not see it
    columns : of the table, fixed
    rows : of the table; `studies` of a row, where it has them, are the keys behind its mark
    plotly : `data` and `layout`, as `api.figures.specification.specification` makes them; its
        numbers are those of the rows, and `customdata` of a mark is made by `mark`
    studies : number of those that meet the filters
    left_out : studies that a part of the figure cannot show, by level
    options : what was asked besides filters
    counts : of the matrix: state -> number of pairs
    """

    name: str
    title: str
    caption: str
    text: tuple[str, ...]
    columns: tuple[str, ...]
    rows: tuple[Row, ...]
    plotly: Mapping[str, Any]
    studies: int = 0
    left_out: tuple[LeftOut, ...] = ()
    options: Mapping[str, str] = field(default_factory=dict)
    counts: Mapping[str, int] = field(default_factory=dict)

    @property
    def description(self) -> str:
        """The text, as one."""
        return " ".join(self.text)

    def plotly_figure(self) -> go.Figure:
        """Return it as a figure of Plotly's, to restyle or save."""
        import plotly.graph_objects as go  # noqa: PLC0415 - a second to load, for who asks alone

        return go.Figure(self.plotly).update_layout(title_text=self.title, margin_t=70)

    def show(self, renderer: str | None = None) -> None:
        """Show it in a notebook or a browser; `renderer` is one of `plotly.io.renderers`."""
        self.plotly_figure().show(renderer)

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
