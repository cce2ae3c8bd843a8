"""Documents: what a question is answered with, whoever shows it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from api.schema.table import Model, columns_of, csv_of, flat
from api.service.pagination import Page, order, page

Row = Mapping[str, Any]


@dataclass(frozen=True)
class Document:
    """A document that can be a table too.

    Attributes
    ----------
    document : the JSON object
    columns : of the table, as `api.schema.table.columns_of` names them
    rows : gives the rows of the table
    links : values of the Link header
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


def listing(
    rows: Sequence[Row],
    path: str,
    query: Any,
    model: Model,
    table: Callable[[Sequence[Row]], Sequence[Row]] | None = None,
    **more: Any,
) -> Document:
    """Return the page of rows that a query asks for, in its order and with its columns.

    Parameters
    ----------
    rows : all of the list
    path : of the list, to which a cursor is bound
    query : says which page, in what order and with which columns
    model, more : as `list_document`
    table : makes the rows of the CSV of the items; these themselves where left out
    """
    shown = page(order(rows, getattr(query, "sort", None)), path, query)
    items = shown.items
    return list_document(shown, items, model, table and table(items), query=query, **more)


def list_document(
    shown: Page[Any],
    items: Sequence[Row],
    model: Model,
    table: Sequence[Row] | None = None,
    *,
    query: Any,
    **more: Any,
) -> Document:
    """Return a page of a list as a document, narrowed to the columns that a query names.

    Parameters
    ----------
    shown : the page
    items : of the JSON
    model : of a row; its columns are those of the table
    table : rows of the CSV; the items where left out
    query : its `fields`, where it has any, are the columns kept in items and table
    more : members of the document beside the items
    """
    columns, rows = columns_of(model), items if table is None else table
    if fields := getattr(query, "fields", ()):
        columns = tuple(name for name in columns if name in fields)
        items = rows = [flat(row, columns) for row in rows]
    document = {"items": items, "total": shown.total, "next": shown.next, **more}
    return Document(document, columns, lambda: rows, (shown.link,) if shown.link else ())
