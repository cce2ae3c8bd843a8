"""A file is read whole or refused with its reason; a table is read with every flaw located."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from files.numerals import parse_decimal, parse_integer
from files.problems import Problem
from files.reading import FileRefusedError, read_bytes, read_text
from files.strict_csv import read_records
from files.strict_json import parse_json
from files.whole_csv import read_whole_records

linux = pytest.mark.skipif(sys.platform != "linux", reason="/proc is Linux's")


def test_a_file_of_the_largest_size_is_read_and_a_larger_one_refused(tmp_path: Path) -> None:
    path = tmp_path / "given.csv"
    path.write_bytes(b"1234")
    assert read_bytes(path, 4) == b"1234"
    with pytest.raises(FileRefusedError, match="expected at most 3 bytes, got 4 bytes"):
        read_bytes(path, 3)


@linux
def test_a_file_that_holds_more_than_the_system_says_is_refused() -> None:
    path = Path("/proc/self/status")
    assert path.stat().st_size == 0
    with pytest.raises(FileRefusedError, match="expected at most 3 bytes, got more"):
        read_bytes(path, 3)


@pytest.mark.parametrize(
    ("data", "line", "said"),
    [
        (b"one\ntw\xff", 2, "not UTF-8 text: byte 0xff"),
        (b"\xef\xbb\xbfone", 1, "byte-order mark"),
        (b"one\ntwo\nth\x00ree", 3, "null character"),
        ("one\n\ufffd".encode(), 2, "U+FFFD"),
    ],
)
def test_what_is_no_plain_text_is_refused_with_its_line(
    data: bytes, line: int, said: str, tmp_path: Path
) -> None:
    path = tmp_path / "given.txt"
    path.write_bytes(data)
    with pytest.raises(FileRefusedError) as caught:
        read_text(path)
    assert caught.value.line == line
    assert said in caught.value.reason


@pytest.mark.parametrize(
    ("data", "row", "column", "said"),
    [
        (b"a,b\n1,2\n3,4", 3, "b", "the last line is cut off"),
        ("a,b\n1,2\n3,x\ufffd\n".encode(), 3, "b", "a letter that was lost"),
        (b"a,b\n1," + b"x" * 5001 + b"\n", 2, "b", "longer than 5000 characters"),
        (b"a,b\n 1,2\n", 2, "a", "space around the value ' 1'"),
    ],
)
def test_damage_of_a_table_is_located(
    data: bytes, row: int, column: str, said: str, tmp_path: Path
) -> None:
    path = tmp_path / "given.csv"
    path.write_bytes(data)
    (problem,) = read_whole_records(path, ["a", "b"]).problems
    assert (problem.file, problem.row, problem.column) == ("given.csv", row, column)
    assert said in problem.message


def test_a_cell_of_the_greatest_length_is_taken(tmp_path: Path) -> None:
    path = tmp_path / "given.csv"
    path.write_bytes(b"a,b\n1," + b"x" * 5000 + b"\n")
    records = read_records(path, ["a", "b"])
    assert records.problems == []
    assert records.rows == [(2, ["1", "x" * 5000])]


def test_a_table_that_is_missing_or_no_file_has_no_rows_and_says_why(tmp_path: Path) -> None:
    missing = read_whole_records(tmp_path / "given.csv", ["a"])
    assert missing.problems == [Problem("given.csv", None, None, "the file is missing")]
    refused = read_whole_records(tmp_path, ["a"])
    assert refused.problems == [
        Problem(tmp_path.name, None, None, "expected a file, got a directory")
    ]
    assert missing.rows == refused.rows == []


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("1e999", "expected a finite number, got '1e999'"),
        ("-1e999", "expected a finite number, got '-1e999'"),
        ("1_29", "expected a number, got '1_29'"),
        ("nan", "expected a number, got 'nan'"),
        ("0" * 41, "expected a number"),
    ],
)
def test_what_is_no_plain_finite_number_is_refused(text: str, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        parse_decimal(text)


def test_numbers_are_read_as_python_reads_their_plain_spelling() -> None:
    assert [parse_decimal(text) for text in ("-.5", "1e-3", "2.")] == [-0.5, 0.001, 2.0]
    assert parse_integer("+12") == 12
    with pytest.raises(ValueError, match=r"expected a whole number, got '1\.0'"):
        parse_integer("1.0")


@pytest.mark.parametrize("depth", [51, 60, 400])
def test_json_that_nests_too_deep_is_refused_though_python_reads_it(depth: int) -> None:
    text = '{"a": [' * (depth // 2) + "1" + "]}" * (depth // 2) if depth % 2 == 0 else ""
    text = text or "[" * depth + "]" * depth
    with pytest.raises(FileRefusedError, match=r"given\.json: not JSON: nested deeper than 50"):
        parse_json(text, Path("given.json"))
