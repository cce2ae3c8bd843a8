"""A text file as rows of cells: separator, decimal sign, header, units and comments found."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from calibrate.forms.decoding import decoded
from calibrate.forms.layout import (
    SAMPLED,
    Layout,
    is_comment,
    layout_of,
    separator_of,
    without_mark,
)
from calibrate.forms.refused import TableError
from calibrate.settings import FileSettings

_SEPARATORS = (";", "\t", ",", "|", " ")
_WORDS = {",": "commas", ";": "semicolons", "\t": "tabs", "|": "bars", " ": "blanks"}
_ENDS = re.compile(r"\r\n|\n|\r")


@dataclass(frozen=True)
class Cells:
    """Cells of a table, before any is a number.

    Attributes
    ----------
    frame : DataFrame of str
        A column a place; names are `names`.
    names : tuple of str
        Of the columns; empty strings where the header has none, no name at all without a header.
    units : tuple of str
        A cell a column, where the file has a row of units.
    rows : ndarray of int, shape (n,)
        Number of each row in the file, the first is 1.
    decimal : str
        ``"."`` or ``","``.
    header_row : int
        Row of the names, 0 for none.
    notes : tuple of str
        How the file was read.
    """

    frame: pd.DataFrame
    names: tuple[str, ...]
    units: tuple[str, ...]
    rows: NDArray[np.int64]
    decimal: str
    header_row: int
    notes: tuple[str, ...]


def cells_of_text(data: bytes, source: str, stated: FileSettings, most_rows: int) -> Cells:
    """Return the cells of a text file.

    Parameters
    ----------
    data : bytes
        Of the file.
    source : str
        Its name, for messages.
    stated : FileSettings
        What the reader says of it; the rest is found.
    most_rows : int
        Rows of data that are taken at most.

    Raises
    ------
    TableError
        If rows have different numbers of cells, or it is no text.
    """
    text, encoding = decoded(data, source, stated.encoding)
    lines = _ENDS.split(text)
    comment = np.array([is_comment(line) for line in lines], dtype=np.bool_)
    blank = np.array([not line.strip() for line in lines], dtype=np.bool_)
    top = [line for line, skip in zip(lines[:SAMPLED], comment | blank, strict=False) if not skip]
    separator = stated.separator or separator_of(
        top, [(sign, _split(top, sign, source)) for sign in _SEPARATORS]
    )
    shown = [without_mark(line) if is_comment(line) else line for line in lines[:SAMPLED]]
    layout = layout_of(
        _split(shown, separator, source), comment[:SAMPLED].tolist(), stated.header_row
    )
    places = np.arange(len(lines))
    kept = (places >= layout.data) & ~comment & ~blank
    rows = places[kept] + 1
    if len(rows) > most_rows:
        raise TableError(f"{source}: expected at most {most_rows} rows; got more")
    body = [lines[at] for at in rows - 1]
    frame, layout = _frame(body, rows, layout, separator, source)
    decimal = stated.decimal or ("," if separator != "," and _decimal_commas(body) else ".")
    between = int(comment.sum()) - int(layout.header is not None and comment[layout.header])
    notes = _notes(encoding, separator, decimal, layout, between)
    return Cells(
        frame, layout.names, layout.unit_cells, rows, decimal, layout.header_row, tuple(notes)
    )


def _split(lines: Sequence[str], separator: str, source: str) -> list[list[str]]:
    if separator == " ":
        return [line.split() for line in lines]
    rows = []
    for at, line in enumerate(lines):
        try:
            rows.append(next(csv.reader([line], delimiter=separator, skipinitialspace=True), []))
        except csv.Error as error:
            raise TableError(f"{source}, row {at + 1}: expected cells ({error})") from None
    return rows


def _frame(
    body: Sequence[str], rows: NDArray[np.int64], layout: Layout, separator: str, source: str
) -> tuple[pd.DataFrame, Layout]:
    """Return the data's cells, and the layout with as many names as there are columns."""
    split = _split(body[:SAMPLED], separator, source)
    widths = [len(row) for row in split]
    usual = max(set(widths), key=widths.count) if widths else len(layout.names)
    names = layout.names
    if names and usual == len(names) + 1:
        ends = all(not row[-1].strip() for row in split if len(row) == usual)
        names = (*names, "") if ends else ("", *names)
    elif names and usual == len(names) - 1 and not names[-1]:
        names = names[:-1]
    width = len(names) or usual
    _require_even(body, rows, width, separator, source)
    blanks = separator == " "
    frame = (
        pd.read_csv(
            io.StringIO("\n".join(body)),
            sep=r"\s+" if blanks else separator,
            header=None,
            names=list(range(width)),
            index_col=False,
            dtype=str,
            keep_default_na=False,
            na_filter=False,
            skipinitialspace=True,
            skip_blank_lines=False,
        )
        if body
        else pd.DataFrame({at: pd.Series([], dtype=str) for at in range(width)})
    )
    if len(frame) != len(body):
        raise TableError(f"{source}: expected a row a line; a quoted cell goes over several")
    return frame, Layout(layout.header, layout.units, layout.data, names, layout.unit_cells)


def _require_even(
    body: Sequence[str], rows: NDArray[np.int64], width: int, separator: str, source: str
) -> None:
    """Raise TableError naming the first row with another number of cells."""
    for row, line in zip(rows, body, strict=True):
        if separator == " ":
            count = len(line.split())
        elif '"' in line:
            count = len(_split([line], separator, source)[0])
        else:
            count = line.count(separator) + 1
        if count != width:
            raise TableError(f"{source}, row {row}: expected {width} cells; got {count}")


def _decimal_commas(body: Sequence[str]) -> bool:
    sample = "".join(body[:SAMPLED])
    return sample.count(",") > sample.count(".")


def _notes(encoding: str, separator: str, decimal: str, layout: Layout, comments: int) -> list[str]:
    word = _WORDS.get(separator, repr(separator))
    said = [f"text in {encoding.upper()}, cells separated by {word}"]
    if decimal == ",":
        said.append("numbers have decimal commas")
    said += layout.notes()
    if comments:
        said.append(f"{comments} comment line{'s' if comments > 1 else ''} left out")
    return said
