"""`sunatlas leaderboard` on one screen, and its findings."""

import csv
import io
import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app

COLUMNS, LINES = 80, 45


def sunatlas(*arguments):
    shown = CliRunner().invoke(
        app, ["leaderboard", *arguments], catch_exceptions=False, env={"COLUMNS": str(COLUMNS)}
    )
    assert shown.exit_code == 0, shown.stderr
    return shown.stdout


@pytest.fixture(scope="module")
def rows():
    return json.loads(sunatlas("--format", "json"))["items"]


def table_of(text):
    """Rows of the table: between the two empty lines, without its head, long names unfolded."""
    _, *lines = text.split("\n\n")[1].splitlines()
    return "\n".join(lines).replace("\n  ", "  ").splitlines()


def test_without_options_the_answer_fits_one_screen(rows):
    text = sunatlas()
    lines = text.splitlines()
    assert len(lines) <= LINES
    assert max(map(len, lines)) <= COLUMNS
    table = table_of(text)
    assert len(table) == len(rows)
    for line, row in zip(table, rows, strict=True):
        architecture = f"{row['detector']} {row['mask']}"
        assert line.startswith(architecture)
        pipeline = f"{row['extractor']} + {row['model']}"
        said, named, numbers = line[len(architecture) :].partition(pipeline)
        assert not said.strip()
        assert named == pipeline
        flight, error, ratio, bench = numbers.split()
        assert float(flight) == pytest.approx(row["flight_error_deg"], rel=0.005)
        assert error.endswith("=") == row["tie"]
        assert float(error.rstrip("=")) == pytest.approx(row["own_error_deg"], rel=0.005)
        assert float(ratio) == pytest.approx(row["over_bound"], rel=0.005)
        assert float(bench) == pytest.approx(row["on_bench_deg"], rel=0.005)


@pytest.mark.slow
def test_findings_are_those_of_the_readme_and_come_with_their_pairs():
    readme = (Path(__file__).parents[3] / "README.md").read_text("utf-8")
    said = " ".join(sunatlas("findings").split())
    estimates = json.loads(sunatlas("findings", "--format", "json"))
    named = list(dict.fromkeys(row["finding"] for row in estimates))
    assert len(named) == 5
    for place, name in enumerate(named, start=1):
        (line,) = [line for line in readme.splitlines() if f"findings {name}`" in line]
        title = line.removeprefix(f"{place}. **").partition("**")[0]
        assert f"{place}. {title}" in said
    pairs = list(csv.DictReader(io.StringIO(sunatlas("findings", named[0], "--format", "csv"))))
    assert len(pairs) >= max(row["n"] for row in estimates if row["finding"] == named[0])
