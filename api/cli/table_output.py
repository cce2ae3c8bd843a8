"""Printing rows: a table for people, JSON and CSV for programs."""

from __future__ import annotations

import json
import math
import os
import sys
from collections.abc import Collection, Mapping, Sequence
from enum import StrEnum
from typing import Annotated, Any

import typer

from api.cells import cell, plain_value
from api.cli import spreadsheets
from api.cli.layout import Column, laid_out, wrap
from api.schema.table import csv_of

Row = Mapping[str, Any]


#: Characters of a line where nothing says how many there are.
COLUMNS = 80
NARROWEST = 20
#: Prose in longer lines is hard to read.
PROSE = 100


class Format(StrEnum):
    """How rows are printed."""

    TABLE = "table"
    JSON = "json"
    CSV = "csv"


FormatOption = Annotated[Format, typer.Option("--format", help="Output format.")]


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
    columns : of the table and the CSV, in order; JSON has all members. Those that say which row it
        is come first
    form : how; a table leaves out columns that are empty in every row
    document : what JSON prints in place of the list of rows
    title : above the table
    """
    if form is Format.JSON:
        emit_json(list(rows) if document is None else document)
    elif form is Format.CSV:
        emit_csv(csv_of(columns, rows))
    else:
        if title is not None:
            say(title)
        shown = [name for name in columns if not rows or any(_show(row.get(name)) for row in rows)]
        typer.echo(table(rows, shown, line_width(), bold=_style()))


def table(
    rows: Sequence[Row],
    columns: Sequence[str],
    width: int,
    indent: str = "",
    *,
    right: Collection[str] = (),
    rule: bool = True,
    bold: bool = False,
) -> str:
    """Return rows as lines of at most `width` characters: see `api.cli.layout`.

    Parameters
    ----------
    rows, columns : as `emit`
    width, indent : of every line
    right : columns whose text is a number
    rule : below the heading
    bold : the heading
    """
    made = laid_out([_column(rows, name, name in right) for name in columns], width, indent)
    heading = [typer.style(line, bold=True) for line in made.heading] if bold else made.heading
    ruled = [indent + "-" * (made.width - len(indent))] if rule else []
    return "\n".join([*heading, *ruled, *made.rows])


def emit_json(document: Any) -> None:
    """Print a document as JSON; NaN and infinities, which JSON lacks, as null."""
    write(json.dumps(plain_value(document), indent=2, ensure_ascii=False) + "\n")


def emit_csv(text: str) -> None:
    """Print CSV, for a spreadsheet where `--safe` asks for that."""
    write(spreadsheets.as_asked(text))


def say(words: str, then: str = "") -> None:
    """Print a sentence to stdout, wrapped; `then` stands before its second and further lines."""
    typer.echo("\n".join(prose(words, line_width(), then)))


def prose(words: str, width: int, then: str = "", first: str = "") -> list[str]:
    """Return a sentence in lines, no longer than are read with ease.

    Parameters
    ----------
    words : of the sentence
    width : of a line
    then : before the second and further lines
    first : before the first, as long as `then`
    """
    lines = wrap(words, min(width, PROSE) - len(then))
    return [f"{then if place else first}{line}" for place, line in enumerate(lines)]


def line_width() -> int:
    """Return the characters of a line: $COLUMNS, else the terminal's, else 80.

    Where stdout goes to a pager, the terminal is found by stderr or stdin.
    """
    given = os.environ.get("COLUMNS", "")
    if given.isdecimal() and int(given) > 0:
        return max(NARROWEST, int(given))
    for stream in (sys.stdout, sys.stderr, sys.stdin):
        try:
            columns = os.get_terminal_size(stream.fileno()).columns
        except (OSError, ValueError, AttributeError):
            continue  # no terminal, or closed
        if columns > 0:
            return max(NARROWEST, columns)
    return COLUMNS


def write(text: str) -> None:
    """Print what programs read: UTF-8 with line feeds, whatever the terminal's encoding is."""
    sys.stdout.flush()
    sys.stdout.buffer.write(text.encode())
    sys.stdout.buffer.flush()


def _style() -> bool:
    return sys.stdout.isatty() and not os.environ.get("NO_COLOR")


def _column(rows: Sequence[Row], name: str, right: bool) -> Column:
    values = [row.get(name) for row in rows]
    numeric = right or any(map(_numeric, values))
    return Column(name.replace("_", " "), [_show(value) for value in values], numeric)


def _numeric(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _show(value: Any) -> str:
    if isinstance(value, float) and math.isfinite(value):
        return f"{value:.4g}"
    return cell(value).replace("; ", ", ")
