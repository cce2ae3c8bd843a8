"""Printing rows: a table for people, JSON and CSV for programs."""

from __future__ import annotations

import csv
import io
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

Row = Mapping[str, Any]


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
        stream = io.StringIO(newline="")
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows([[cell(row.get(name)) for name in columns] for row in rows])
        sys.stdout.write(stream.getvalue())
    else:
        table = Table(title=title, title_justify="left", box=SIMPLE_HEAD, pad_edge=False)
        for name in columns:
            numeric = any(_numeric(row.get(name)) for row in rows)
            # Words may wrap; a number broken over two lines is another number.
            table.add_column(
                name.replace("_", " "), justify="right" if numeric else "left", no_wrap=numeric
            )
        for row in rows:
            table.add_row(*(Text(_shown(row.get(name))) for name in columns))
        console().print(table)


def emit_json(document: Any) -> None:
    """Print a document as JSON; NaN and infinities, which JSON lacks, as null."""
    sys.stdout.write(json.dumps(plain(document), indent=2, ensure_ascii=False) + "\n")


def plain(value: Any) -> Any:
    """Return a value made of what JSON knows: sets sorted, numbers that are not finite None."""
    if isinstance(value, Mapping):
        return {str(name): plain(member) for name, member in value.items()}
    if isinstance(value, set | frozenset):
        return sorted(plain(member) for member in value)
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [plain(member) for member in value]
    if isinstance(value, bool | int | str) or value is None:
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    raise TypeError(f"expected text, numbers, lists and mappings; got {type(value).__name__}")


def cell(value: Any) -> str:
    """Return a value as the text of a CSV cell: lists joined by "; ", nothing found empty."""
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Mapping):
        return json.dumps(plain(value), ensure_ascii=False)
    if isinstance(value, Sequence | frozenset | set) and not isinstance(value, str):
        return "; ".join(cell(member) for member in plain(value))
    return str(value)


def console(*, stderr: bool = False) -> Console:
    """Make a console on stdout or stderr; piped output is not cut to a terminal's width."""
    found = Console(stderr=stderr, highlight=False, soft_wrap=False)
    return found if found.is_terminal else Console(stderr=stderr, highlight=False, width=160)


def _numeric(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _shown(value: Any) -> str:
    if isinstance(value, float) and math.isfinite(value):
        return f"{value:.4g}"
    return cell(value).replace("; ", ", ")
