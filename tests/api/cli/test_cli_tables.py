"""Tables on a terminal: no line is wider than it, no word that says which row it is is lost."""

import itertools
import json
import re
from functools import cache

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app

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
#: What says of one thing, or in sentences: no words of rows are looked for.
OTHERS = (
    *(("studies", "Chang2008"), ("claims", "C04"), ("dataset", "describe", "pd-slit")),
    ("dataset", "realism", "--dataset", "pd-slit"),
    *(("assess", "--method", "BCM"), ("run", "Pita2014", "--condition", "nominal")),
    *(("survey", "check"), ("recommend", "--detector", "Event", "--mask", "Lens")),
    ("get", "/v1/taxonomy"),
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
    there = set(re.split(r"[\s+,;>]+", text))
    for row, name in itertools.product(rows, names):
        for word in re.split(r"[\s+;]+", row[name] or ""):
            assert not word or word in there, (name, row[name])


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("arguments", OTHERS)
def test_no_line_is_wider_than_the_terminal(arguments, width):
    assert max(map(len, shown(*arguments, width=width).splitlines())) <= width


def test_empty_columns_are_left_out_where_there_are_rows():
    text = shown("benchmark", "--dataset", "pd-slit", "--condition", "nominal", width=200)
    assert "rms deg" in text
    assert "false sun" not in text  # diodes see no place: no false sun is counted
