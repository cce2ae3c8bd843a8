"""Documents: what a question is answered with, whoever shows it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from api.schema.table import csv_of, flat
from api.service.pagination import Page

Row = Mapping[str, Any]


@dataclass(frozen=True)
class Document:
    """A document that can be a table too.

    Attributes
    ----------
    columns : of the table, as `api.schema.table.columns_of` names them
    cited : studies that can be had as references; None where there are none, or columns were chosen
    saved_as : name of a file of references, without suffix
    plotly : the figure of a document that is one, `data` and `layout`
    """

    document: Mapping[str, Any]
    columns: Sequence[str] = ()
    rows: Callable[[], Sequence[Row]] = list
    links: Sequence[str] = ()
    cited: Sequence[Row] | None = None
    saved_as: str = "studies"
    plotly: Mapping[str, Any] | None = None

    def table(self) -> str:
        """Return the CSV."""
        return csv_of(self.columns, self.rows())


def list_document(
    shown: Page[Any],
    items: Sequence[Row],
    columns: Sequence[str],
    rows: Callable[[], Sequence[Row]] | None = None,
    *,
    fields: Collection[str] = (),
    **more: Any,
) -> Document:
    """Return a page of a list as a document.

    Parameters
    ----------
    rows : gives the rows of the CSV; the items where left out
    fields : columns to which rows and items are narrowed; none of them where empty
    more : members of the document beside the items
    """
    table = rows or (lambda: items)
    if fields:
        columns = tuple(name for name in columns if name in fields)
        items = [flat(row, columns) for row in table()]
        table = lambda: items  # noqa: E731
    document = {"items": items, "total": shown.total, "next": shown.next, **more}
    return Document(document, columns, table, (shown.link,) if shown.link else ())
