"""Printing rows: a table for people, JSON and CSV for programs."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Mapping, Sequence
from enum import StrEnum
from typing import Annotated, Any

import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from api.cells import cell, plain
from survey_data.csv_writing import csv_text

Row = Mapping[str, Any]


#: Characters of a line that goes to a file or a pipe: room for the widest table.
WIDE = 240


class Format(StrEnum):
    """How rows are printed."""

    TABLE = "table"
    JSON = "json"
    CSV = "csv"


FormatOption = Annotated[Format, typer.Option("--format", help="How to print.")]


def emit(
    rows: Sequence[Row],
    columns: Sequence[str],
    form: Format,
    *,
    document: Any = None,
    title: str | None = None,
) -> None:
    """Print rows to stdout.

    Parameters
    ----------
    rows : one mapping a row
    columns : of the table and the CSV, in order; JSON has all members
    form : how
    document : what JSON prints in place of the list of rows
    title : above the table
    """
    if form is Format.JSON:
        emit_json(list(rows) if document is None else document)
    elif form is Format.CSV:
        cells = [[cell(row.get(name)) for name in columns] for row in rows]
        sys.stdout.write(csv_text(columns, cells))
    else:
        table = Table(title=title, title_justify="left", box=SIMPLE_HEAD, pad_edge=False)
        for name in columns:
            numeric = any(_numeric(row.get(name)) for row in rows)
            # Words may wrap, and are never cut; a number over two lines is another number.
            table.add_column(
                name.replace("_", " "),
                justify="right" if numeric else "left",
                no_wrap=numeric,
                overflow="fold",
            )
        for row in rows:
            table.add_row(*(Text(_shown(row.get(name))) for name in columns))
        console().print(table)


def emit_json(document: Any) -> None:
    """Print a document as JSON; NaN and infinities, which JSON lacks, as null."""
    sys.stdout.write(json.dumps(plain(document), indent=2, ensure_ascii=False) + "\n")


def console(*, stderr: bool = False) -> Console:
    """Make a console on stdout or stderr; piped output is not cut to a terminal's width."""
    found = Console(stderr=stderr, highlight=False, soft_wrap=False)
    return found if found.is_terminal else Console(stderr=stderr, highlight=False, width=WIDE)


def _numeric(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _shown(value: Any) -> str:
    if isinstance(value, float) and math.isfinite(value):
        return f"{value:.4g}"
    return cell(value).replace("; ", ", ")
