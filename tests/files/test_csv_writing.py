"""CSV that a spreadsheet opens: no formula, numbers as they are, everything else back again."""

from __future__ import annotations

import csv
import io

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from files.csv_writing import csv_text, escape_formulas

TEXT = st.text(st.sampled_from("=+-@'\t\r\n\" ,;a1.eE＝＋－＠|!(ä"), max_size=12)
TABLES = st.lists(st.lists(TEXT, min_size=2, max_size=2), max_size=6)


def read(text: str, separator: str = ",") -> list[list[str]]:
    return list(csv.reader(io.StringIO(text, newline=""), delimiter=separator))


def runs(cell: str) -> bool:
    """Say whether a spreadsheet runs a cell: as Excel and LibreOffice decide, and more strictly."""
    if set(cell) <= set("0123456789.eE+-"):
        try:
            float(cell)
        except ValueError:
            pass
        else:
            return False
    return cell.startswith(("\t", "\r", "\n")) or cell.lstrip()[:1] in tuple("=+-@＝＋－＠")


@given(TABLES)
@example([['=HYPERLINK("http://x","y")', "@SUM(1)"], ["\t=1", "\r=1"], [" =1", "-1+cmd|' /C'!A0"]])
@example([["a;=1", "x;\t=1"], ["a;@b", "1;-2;-x"], ["a;'=1", "a; =1"]])
def test_a_spreadsheet_finds_no_formula_and_all_else_is_read_back(rows: list[list[str]]) -> None:
    text = csv_text(["a", "b"], rows)
    assert read(text)[1:] == rows
    for old, new in zip(rows, read(escape_formulas(text))[1:], strict=True):
        assert not any(map(runs, new))
        assert [c.replace("'", "") for c in new] == [c.replace("'", "") for c in old]
    # Where a quote opens a cell depends on the separator: cells that CSV quotes are left out.
    plain = [row for row in rows if not set('",\r\n') & set("".join(row))]
    for row in read(escape_formulas(csv_text(["a", "b"], plain)), ";"):
        assert not any(map(runs, row[1:]))


@given(st.floats(allow_nan=False, allow_infinity=False) | st.integers())
def test_numbers_stay_numbers(number: float) -> None:
    text = csv_text(["n"], [[number]])
    assert escape_formulas(text) == text
    assert float(read(text)[1][0]) == float(number)


@pytest.mark.parametrize(
    ("cell", "written"),
    [
        *(("=1+1", "'=1+1"), ("-x", "'-x"), ("-", "'-"), ("-0.5e-3", "-0.5e-3"), ("a=b", "a=b")),
        *(("a;=b", "a;'=b"), ('a;"=b', '"a;\'""=b"'), ("-2;-2", "'-2;'-2"), ("", "")),
    ],
)
def test_what_is_escaped(cell: str, written: str) -> None:
    assert escape_formulas(csv_text(["a", "b"], [[cell, "x"]])) == f"a,b\n{written},x\n"
