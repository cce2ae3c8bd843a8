"""Writing CSV, one record a line, quoted only where it must be, and without formulas if asked."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Sequence

#: Cells that a spreadsheet takes for a formula, as OWASP lists their first characters
#: (https://owasp.org/www-community/attacks/CSV_Injection), also behind white space; apostrophes
#: before them count as well, so that who takes one apostrophe away has what there was.
_FORMULA = re.compile(r"'*(?:[\t\r\n]|\s*[=+\-@＝＋－＠])")
#: The same after a semicolon, at which spreadsheets of many countries cut; a quote opens a cell.
_AFTER_SEMICOLON = re.compile(r"""'*"*'*(?:[\t\r\n]|\s*[=+\-@＝＋－＠])""")
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)


class _Lines(list[str]):
    """Takes records of the csv module, which quotes a carriage return only where lines end so."""

    def write(self, record: str) -> None:
        self.append(record[:-2] + "\n")


def csv_text(header: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return the text of a CSV file; lines end in a line feed, numbers have all their digits."""
    lines = _Lines()
    writer = csv.writer(lines, lineterminator="\r\n")
    writer.writerow(header)
    writer.writerows(rows)
    return "".join(lines)


def escape_formulas(text: str) -> str:
    """Return a CSV text, with a header, whose cells no spreadsheet runs as formulas.

    A cell whose first character, white space aside, is ``=``, ``+``, ``-`` or ``@`` (or their
    full-width forms), or that starts with a tab or a line break, gets an apostrophe before it; so
    does what follows a semicolon within a cell, where many spreadsheets cut. Numbers stay as they
    are, and so does everything else.
    """
    rows = ([_escape(cell) for cell in row] for row in csv.reader(io.StringIO(text, newline="")))
    header = next(rows, None)
    return "" if header is None else csv_text(header, rows)


def _escape(cell: str) -> str:
    if _NUMBER.fullmatch(cell):
        return cell
    first, *rest = cell.split(";")
    parts = [(first, _FORMULA), *((part, _AFTER_SEMICOLON) for part in rest)]
    return ";".join(f"'{part}" if formula.match(part) else part for part, formula in parts)
