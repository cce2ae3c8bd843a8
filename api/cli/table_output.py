"""Printing rows: a table for people, JSON and CSV for programs."""

from __future__ import annotations

import io
import json
import math
import os
import sys
import textwrap
from collections.abc import Collection, Mapping, Sequence
from enum import StrEnum
from typing import Annotated, Any

import typer

from api.cells import cell, plain_value
from api.cli import spreadsheets
from api.schema.former_names import with_former_names
from api.schema.table import csv_of
from api.service.documents import Document

Row = Mapping[str, Any]


GAP = 2  # between columns
READABLE = 24  # characters of a column below which a longer text is hard to read
NARROWEST = 20  # characters of a line
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


def emit_answer(
    answer: Document,
    form: Format,
    shown: Sequence[str],
    *,
    rows: Sequence[Row] | None = None,
    title: str | None = None,
) -> None:
    """Print a document of the service: all of it as JSON or CSV, some columns (and rows) else."""
    if form is Format.TABLE:
        emit(answer.rows() if rows is None else rows, shown, form, title=title)
    else:
        emit(answer.rows(), answer.columns, form, document=answer.document)


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
    """Return rows as lines of at most `width` characters.

    Where columns do not fit side by side, each row is a list of its columns with their names.

    Parameters
    ----------
    rows, columns : as `emit`
    width, indent : of every line
    right : columns whose text is a number, which is never divided
    rule : below the heading
    bold : the heading
    """
    room = width - len(indent)
    headings = [name.replace("_", " ") for name in columns]
    cells = [[_show(row.get(name)) for name in columns] for row in rows]
    numeric = {at for at, name in enumerate(columns) if name in right or _is_numeric(rows, name)}
    least, most = [], []
    for at, (heading, *texts) in enumerate(zip(headings, *cells, strict=True)):
        longest = max(map(len, texts), default=0)
        words = [word for text in texts for word in ([text] if at in numeric else text.split())]
        prose_needs = READABLE if longest > READABLE and at not in numeric else 0
        least.append(max(prose_needs, *map(len, (*heading.split(), *words))))
        most.append(max(len(heading), longest))
    spare = room - sum(least) - GAP * (len(columns) - 1)
    if spare < 0:
        pairs = ([f"{h}: {c}" for h, c in zip(headings, row, strict=True) if c] for row in cells)
        lines = [line for one in pairs for line in _wrapped("; ".join(one), room, "", "  ")]
        return "\n".join(f"{indent}{line}" for line in lines)
    widths = list(least)
    # What wants least first: it may be content with less than its share.
    for left, at in enumerate(sorted(range(len(least)), key=lambda at: most[at] - least[at])):
        widths[at] += min(most[at] - least[at], spare // (len(columns) - left))
        spare -= widths[at] - least[at]
    head = _side_by_side([headings], widths, numeric)
    body = _side_by_side(cells, widths, numeric)
    ruled = ["-" * max(map(len, (*head, *body)), default=0)] if rule else []
    head = [typer.style(line, bold=True) for line in head] if bold else head
    return "\n".join(f"{indent}{line}" for line in (*head, *ruled, *body))


def _side_by_side(
    rows: Sequence[Sequence[str]], widths: Sequence[int], numeric: Collection[int]
) -> list[str]:
    """Return the lines of rows, each cell wrapped in its column."""
    from rich.console import Console  # noqa: PLC0415 - the help does without it
    from rich.table import Table  # noqa: PLC0415 - as above
    from rich.text import Text  # noqa: PLC0415 - as above

    drawn = Table(box=None, pad_edge=False, padding=(0, GAP, 0, 0), show_header=False)
    for at, width in enumerate(widths):
        drawn.add_column(justify="right" if at in numeric else "left", width=width, overflow="fold")
    for row in rows:
        drawn.add_row(*map(Text, row))
    console = Console(file=io.StringIO(), width=sum(widths) + GAP * len(widths), color_system=None)
    with console.capture() as captured:
        console.print(drawn)
    return [line.rstrip() for line in captured.get().splitlines()]


def emit_json(document: Any) -> None:
    """Print a document as JSON; NaN and infinities, which JSON lacks, as null."""
    write(json.dumps(plain_value(with_former_names(document)), indent=2, ensure_ascii=False) + "\n")


def emit_csv(text: str) -> None:
    """Print CSV, for a spreadsheet where `--safe` asks for that."""
    write(spreadsheets.as_asked(text))


def say(words: str, then: str = "") -> None:
    """Print a sentence to stdout, wrapped; `then` stands before its second and further lines."""
    typer.echo("\n".join(prose(words, line_width(), then)))


def prose(words: str, width: int, then: str = "", first: str = "") -> list[str]:
    """Return a sentence in lines that are read with ease; `first` and `then` stand before them."""
    return _wrapped(words, min(width, PROSE), first, then)


def _wrapped(words: str, width: int, first: str, then: str) -> list[str]:
    return textwrap.wrap(
        words, width, initial_indent=first, subsequent_indent=then, break_on_hyphens=False
    )


def line_width() -> int:
    """Return the characters of a line: $COLUMNS, else the terminal's, else 80."""
    from rich.console import Console  # noqa: PLC0415 - the help does without it

    return max(NARROWEST, Console(height=1).width)


def write(text: str) -> None:
    """Print what programs read: UTF-8 with line feeds, whatever the terminal's encoding is."""
    sys.stdout.flush()
    sys.stdout.buffer.write(text.encode())
    sys.stdout.buffer.flush()


def _style() -> bool:
    return sys.stdout.isatty() and not os.environ.get("NO_COLOR")


def _is_numeric(rows: Sequence[Row], name: str) -> bool:
    values = (row.get(name) for row in rows)
    return any(isinstance(one, int | float) and not isinstance(one, bool) for one in values)


def _show(value: Any) -> str:
    if isinstance(value, float) and math.isfinite(value):
        return f"{value:.4g}"
    return cell(value).replace("; ", ", ")
