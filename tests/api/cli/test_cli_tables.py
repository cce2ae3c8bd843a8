"""Tables on a terminal: no line is wider than it, no word that says which row it is is lost."""

import itertools
import json
import os
import re
import sys
from functools import cache

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app
from api.cli.layout import Column, laid_out, wrap
from api.cli.table_output import COLUMNS, NARROWEST, line_width

#: The narrowest, which is the hardest; slow are what most terminals have, and others.
WIDTHS = (40, *[pytest.param(width, marks=pytest.mark.slow) for width in (60, 80, 120, 200)])
#: What says which row it is, in the JSON of the command, and where that lists the rows.
TABLES = (
    (("studies", "--detector", "Event"), ("key",), None),
    (("claims", "--verdict", "partly"), ("id", "verdict"), "items"),
    (("curves", "--dataset", "cmos-l-slit"), ("dataset", "extractor", "model"), "items"),
    (("leaderboard",), ("detector", "mask", "extractor"), "items"),
    (("leaderboard", "--each"), ("dataset", "condition", "extractor", "model"), "items"),
    (("leaderboard", "--field", "30"), ("dataset", "extractor", "model"), "items"),
    (("leaderboard", "--overview"), ("part",), "parts"),
    (("dataset", "list"), ("name", "detector", "mask"), None),
    (("dataset", "coverage"), ("detector", "mask"), "pairs"),
    (("recommend", "--limit", "3"), ("detector", "mask"), "architectures"),
    (("assess",), ("method",), "methods"),
    (
        ("benchmark", "--dataset", "pd-slit", "--condition", "nominal"),
        ("dataset", "condition", "extractor", "model"),
        "scores",
    ),
)


def shown(*arguments, width=80):
    found = CliRunner(env={"COLUMNS": str(width)}).invoke(app, arguments, catch_exceptions=False)
    assert found.exit_code == 0, found.stderr
    return found.stdout


@cache
def document_of(arguments):
    """Rows are the same at every width."""
    return json.loads(shown(*arguments, "--format", "json"))


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize(("arguments", "names", "listed"), TABLES)
def test_every_row_keeps_its_words_at_every_width(arguments, names, listed, width):
    document = document_of(arguments)
    rows = document if listed is None else document[listed]
    assert rows
    text = shown(*arguments, width=width)
    assert max(map(len, text.splitlines())) <= width
    there = set(re.split(r"[\s+,>]+", text))
    for row, name in itertools.product(rows, names):
        for word in re.split(r"[\s+]+", row[name] or ""):
            assert not word or word in there, (name, row[name])


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize(
    "arguments",
    [
        ("studies", "Chang2008"),
        ("claims", "C04"),
        ("dataset", "describe", "pd-slit"),
        ("dataset", "realism", "--dataset", "pd-slit"),
        ("assess", "--method", "BCM"),
        ("run", "Chang2008", "--condition", "nominal"),
        ("survey", "check"),
        ("recommend", "--detector", "Event", "--mask", "Lens"),
        ("get", "/v1/taxonomy"),
    ],
)
def test_no_line_is_wider_than_the_terminal(arguments, width):
    assert max(map(len, shown(*arguments, width=width).splitlines())) <= width


def cells(*columns):
    return [Column(name, texts, numeric) for name, texts, numeric in columns]


NAMES = ["cmos-single-aperture", "pd-slit"]
NUMBERS = ["0.001234", "17"]


def test_a_table_that_fits_has_a_line_a_row_and_aligned_numbers():
    made = laid_out(cells(("data set", NAMES, False), ("rms deg", NUMBERS, True)), 40)
    assert made.heading == ("data set               rms deg",)
    assert made.rows == ("cmos-single-aperture  0.001234", "pd-slit                     17")


def test_one_that_does_not_is_stacked_alike_in_every_row():
    columns = cells(("data set", NAMES, False), *[(f"n{i}", NUMBERS, True) for i in range(4)])
    made = laid_out(columns, 42)
    assert made.heading == ("data set                    n0        n1", "        n2        n3")
    assert made.rows == (
        "cmos-single-aperture  0.001234  0.001234",
        "  0.001234  0.001234",
        "pd-slit                     17        17",
        "        17        17",
    )


def test_prose_is_wrapped_in_its_column_and_headings_by_words():
    words = "a sentence of several words that does not fit a line of the table"
    made = laid_out(cells(("key", ["x"], False), ("why it is so", [words], False)), 40)
    assert made.rows[0].startswith("x")
    assert " ".join(line.strip() for line in made.rows).removeprefix("x").split() == words.split()
    narrow = laid_out(
        cells(("over bound unit", ["1.5", "2"], True), ("b", ["y" * 14] * 2, False)), 21
    )
    assert [line.split()[0] for line in narrow.heading] == ["over", "bound", "unit"]


@pytest.mark.parametrize("width", [20, 33, 47])
def test_only_a_word_longer_than_a_line_is_divided_and_behind_a_mark(width):
    word = "https://sensors.example/a-long-address/of-a-page/with-many-parts-in-it"
    lines = wrap(f"see {word} there", width)
    assert max(map(len, lines)) <= width
    assert "".join(lines).replace("see", "").replace("there", "").replace(" ", "") == word
    assert all(line[-1] in "-/." for line in lines[1:-2])
    assert wrap("", width) == []
    assert wrap("x" * (2 * width), width) == ["x" * width] * 2


def test_empty_columns_are_left_out_where_there_are_rows():
    text = shown("benchmark", "--dataset", "pd-slit", "--condition", "nominal", width=200)
    assert "rms deg" in text
    assert "false sun" not in text  # diodes see no place: no false sun is counted


class _Stream:
    """A stream of a number, or one that has none: closed, or not a file."""

    def __init__(self, number: int | None) -> None:
        self.number = number

    def fileno(self) -> int:
        if self.number is None:
            raise ValueError("I/O operation on closed file")
        return self.number


@pytest.mark.parametrize(
    ("given", "terminals", "width"),
    [
        ("132", {1: 90}, 132),
        ("5", {}, NARROWEST),
        ("0", {1: 90}, 90),
        ("wide", {1: 90}, 90),
        (None, {1: 90, 2: 70}, 90),
        (None, {2: 70, 0: 60}, 70),  # stdout goes to a pager
        (None, {0: 60}, 60),
        (None, {1: 8}, NARROWEST),
        (None, {1: 0, 2: 70}, 70),  # a terminal that does not know how wide it is
        (None, {1: 0}, COLUMNS),
        (None, {}, COLUMNS),
    ],
)
def test_lines_are_as_wide_as_the_first_terminal(
    monkeypatch: pytest.MonkeyPatch, given: str | None, terminals: dict[int, int], width: int
) -> None:
    def size(number: int) -> os.terminal_size:
        if number not in terminals:
            raise OSError(25, "Inappropriate ioctl for device")
        return os.terminal_size((terminals[number], 24))

    monkeypatch.setattr(os, "get_terminal_size", size)
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        monkeypatch.setattr(sys, name, _Stream(number))
    monkeypatch.delenv("COLUMNS", raising=False)
    if given is not None:
        monkeypatch.setenv("COLUMNS", given)
    found = line_width()
    monkeypatch.undo()
    assert found == width


@pytest.mark.parametrize("closed", [None, _Stream(None)])
def test_a_closed_stream_is_passed_over(
    monkeypatch: pytest.MonkeyPatch, closed: _Stream | None
) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    monkeypatch.setattr(os, "get_terminal_size", lambda _: os.terminal_size((66, 24)))
    monkeypatch.setattr(sys, "stdout", closed)
    monkeypatch.setattr(sys, "stderr", _Stream(2))
    found = line_width()
    monkeypatch.undo()
    assert found == 66
