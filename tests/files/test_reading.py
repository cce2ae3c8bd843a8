"""Text, JSON and numbers are read to the letter, or refused with their place."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from files.reading import (
    FileRefusedError,
    parse_decimal,
    parse_integer,
    parse_json,
    parse_toml,
    read_bytes,
    read_text,
    require_type,
)


def test_a_file_of_the_largest_size_is_read_and_a_larger_one_refused(tmp_path: Path) -> None:
    path = tmp_path / "given.csv"
    path.write_bytes(b"1234")
    assert read_bytes(path, 4) == b"1234"
    with pytest.raises(FileRefusedError, match="expected at most 3 bytes, got more"):
        read_bytes(path, 3)


def test_what_is_no_regular_file_is_refused_and_a_pipe_not_waited_for(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to("nothing")
    os.mkfifo(tmp_path / "pipe")
    for name, said in (("", "got a directory"), ("link", "broken link"), ("pipe", "named pipe")):
        with pytest.raises(FileRefusedError, match=said):
            read_bytes(tmp_path / name)
    with pytest.raises(FileNotFoundError):
        read_bytes(tmp_path / "missing")


@pytest.mark.parametrize(
    ("data", "line", "said"),
    [
        (b"one\ntw\xff", 2, "not UTF-8 text: byte 0xff"),
        (b"\xef\xbb\xbfone", 1, "byte-order mark"),
        (b"one\ntwo\nth\x00ree", 3, "null character"),
        ("one\n\ufffd".encode(), 2, "a lost letter"),
    ],
)
def test_what_is_no_plain_text_is_refused_with_its_line(
    data: bytes, line: int, said: str, tmp_path: Path
) -> None:
    path = tmp_path / "given.txt"
    path.write_bytes(data)
    with pytest.raises(FileRefusedError, match=said) as caught:
        read_text(path)
    assert caught.value.line == line


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('{"a": 1,\n "a": 2}', "'a' stands twice"),
        ('{"a": NaN}', "expected a finite number, got NaN"),
        ("[-Infinity]", "got -Infinity"),
        ("[1e999]", "got 1e999"),
        ('{"a": 1\n "b": 2}', "line 2: not JSON"),
        ("[" * 100_000 + "]" * 100_000, "nested too deeply"),
    ],
)
def test_what_is_no_plain_json_is_refused_with_the_reason(text: str, said: str) -> None:
    with pytest.raises(FileRefusedError, match=rf"given\.json.*{said}"):
        parse_json(text, Path("given.json"))


@pytest.mark.parametrize("value", ["1", True, None, [1.0]])
def test_a_member_of_another_type_is_named(value: object) -> None:
    require_type({"size": [0.5, 1]}, dict[str, list[float]], Path("given.json"))
    with pytest.raises(FileRefusedError, match=r"given\.json: size/1: .*, got"):
        require_type({"size": [0.5, value]}, dict[str, list[float]], Path("given.json"))


def test_numbers_are_read_as_python_reads_their_plain_spelling_alone() -> None:
    assert [parse_decimal(text) for text in ("-.5", "1e-3", "2.")] == [-0.5, 0.001, 2.0]
    assert parse_integer("+12") == 12
    for text in ("1e999", "1_29", "nan", " 1", "١"):
        with pytest.raises(ValueError, match="expected a"):
            parse_decimal(text)
    with pytest.raises(ValueError, match=r"expected a whole number, got '1\.0'"):
        parse_integer("1.0")


@pytest.mark.parametrize("part", ["a.", "'a b' . ", '"a" .', "1.", r'"\"" .'])
def test_a_key_of_toml_of_many_parts_is_refused_and_one_of_few_is_read(part: str) -> None:
    """Reading one takes the square of its parts: 8 s and 1.6 GB of 20,000."""
    assert parse_toml(f"{part * 19}z = 1\n")
    with pytest.raises(ValueError, match=r"at most 20 parts \(at line 2, column 1\)"):
        parse_toml(f"x = 1\n[{part * 20}z]\n")


@pytest.mark.parametrize("quote", ['"', "'", '"' * 3, "'" * 3])
def test_dots_in_texts_and_comments_of_toml_are_no_parts_of_a_key(quote: str) -> None:
    dots = "a." * 40
    assert parse_toml(f"x = {quote}{dots}{quote} # {dots}{quote}\ny = 2\n") == {"x": dots, "y": 2}


@pytest.mark.parametrize("torn", ['"\\', '"' * 3 + "\\", "'" * 3 + "a'", "a."])
def test_a_megabyte_of_torn_toml_is_refused(torn: str) -> None:
    """In one pass: looking for an end from every quote would take hours."""
    with pytest.raises(ValueError, match=r"\(at "):
        parse_toml(torn * 300_000)
