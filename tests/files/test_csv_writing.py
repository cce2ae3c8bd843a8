"""CSV that a spreadsheet opens: no formula, numbers as they are, everything else back again."""

from __future__ import annotations

import csv
import io
from contextlib import suppress

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from files.csv_writing import csv_text, escape_formulas

STARTS = "=+-@\t\r\n＝＋－＠"
LETTERS = "=+-@'\t\r\n\" ,;a1.eE＝＋－＠|!(ä"
TEXT = st.text(st.sampled_from(LETTERS), max_size=12) | st.text(max_size=8)
NUMBERS = st.floats(allow_nan=False, allow_infinity=False) | st.integers()
TABLES = st.lists(st.lists(TEXT, min_size=2, max_size=2), max_size=6)


def read(text: str) -> list[list[str]]:
    """Read CSV by RFC 4180 alone, independently of the csv module."""
    rows, row, cell, quoted, at = [], [], "", False, 0
    while at < len(text):
        c = text[at]
        if quoted:
            if c == '"' and text[at + 1 : at + 2] == '"':
                cell, at = cell + '"', at + 1
            elif c == '"':
                quoted = False
            else:
                cell += c
        elif c == '"' and not cell:
            quoted = True
        elif c == ",":
            row, cell = [*row, cell], ""
        elif c == "\n":
            rows, row, cell = [*rows, [*row, cell]], [], ""
        else:
            cell += c
        at += 1
    assert (quoted, row, cell) == (False, [], ""), "cut off"
    return rows


def runs(cell: str) -> bool:
    """Say whether a spreadsheet runs a cell: as Excel and LibreOffice decide, and more strictly."""
    with suppress(ValueError):
        if set(cell) <= set("0123456789.eE+-"):
            float(cell)
            return False
    return starts(cell)


def starts(cell: str) -> bool:
    """Say whether a cell starts like a formula, as signed numbers do, too."""
    return cell.startswith(tuple(STARTS)) or cell.lstrip().startswith(tuple(STARTS))


@given(TABLES)
@example([['=HYPERLINK("http://x","y")', "@SUM(1)"], ["\t=1", "\r=1"], [" =1", "-1+cmd|' /C'!A0"]])
def test_a_spreadsheet_finds_no_formula(rows: list[list[str]]) -> None:
    for row in read(escape_formulas(csv_text(["a", "b"], rows)))[1:]:
        assert not any(map(runs, row)), row


@given(TABLES)
@example([["a;=1", "x;\t=1"], ["a;@b", "1;-2;-x"], ["a;'=1", "a; =1"]])
def test_a_spreadsheet_that_cuts_at_semicolons_finds_no_formula(rows: list[list[str]]) -> None:
    """Cells that CSV quotes are left out: whether a quote opens a cell depends on the separator."""
    plain = [row for row in rows if not set('",\r\n') & set("".join(row))]
    text = escape_formulas(csv_text(["a", "b"], plain))
    for row in csv.reader(io.StringIO(text, newline=""), delimiter=";"):
        assert not any(map(runs, row[1:])), row


@given(st.lists(NUMBERS, min_size=1, max_size=5))
def test_numbers_stay_numbers(numbers: list[float]) -> None:
    text = csv_text(["n"], [[n] for n in numbers])
    assert escape_formulas(text) == text
    assert [float(cell) for (cell,) in read(escape_formulas(text))[1:]] == [
        float(n) for n in numbers
    ]


@given(TABLES)
@example([["'=1", "'-5"], ["''", "'"], ["'\t", "-"], ["", ";-1"]])
def test_escaping_puts_apostrophes_before_formulas_and_touches_nothing_else(
    rows: list[list[str]],
) -> None:
    text = csv_text(["a", "b"], rows)
    pairs = zip(read(text), read(escape_formulas(text)), strict=True)
    for before, after in ((";".join(b).split(";"), ";".join(a).split(";")) for b, a in pairs):
        for old, new in zip(before, after, strict=True):
            assert new in {old, f"'{old}"}
            assert new == old or starts(old.lstrip("'\""))


@given(TABLES)
@example([["a\rb", "\r"]])
def test_written_cells_are_read_back_as_they_were(rows: list[list[str]]) -> None:
    text = csv_text(["a", "b"], rows)
    assert read(text)[1:] == rows
    assert list(csv.reader(io.StringIO(text, newline="")))[1:] == rows


@pytest.mark.parametrize(
    ("cell", "written"),
    [
        ("=1+1", "'=1+1"),
        ("+cmd", "'+cmd"),
        ("@import", "'@import"),
        ("-x", "'-x"),
        ("-", "'-"),
        ("-0.5e-3", "-0.5e-3"),
        ("+7", "+7"),
        ("a=b", "a=b"),
        ("a;=b", "a;'=b"),
        ('a;"=b', '"a;\'""=b"'),
        ("-2;-2", "'-2;'-2"),
        ("", ""),
    ],
)
def test_what_is_escaped(cell: str, written: str) -> None:
    assert escape_formulas(csv_text(["a", "b"], [[cell, "x"]])) == f"a,b\n{written},x\n"
