"""`sunatlas survey`: the report on good tables, refusals on corrupted ones, imports."""

import csv
import io
import json
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

import survey_data
from api.cli.command_line import app

OURS = Path(survey_data.__file__).parent
TABLES = sorted(path.name for path in OURS.glob("*.csv"))


def survey(*arguments):
    return CliRunner().invoke(app, ["survey", *map(str, arguments)], catch_exceptions=False)


@pytest.fixture
def copy(tmp_path):
    """A copy of the survey's tables, free to be spoilt."""
    directory = tmp_path / "tables"
    directory.mkdir()
    for path in [*OURS.rglob("*.csv"), OURS / "datapackage.json"]:
        target = directory / path.relative_to(OURS)
        target.parent.mkdir(exist_ok=True)
        shutil.copy(path, target)
    return directory


def write(path, rows):
    stream = io.StringIO(newline="")
    csv.writer(stream, lineterminator="\n").writerows(rows)
    path.write_text(stream.getvalue(), "utf-8", newline="")


def refused(directory):
    """Problems of a directory, as JSON tells them, after checking that stderr tells the same."""
    shown = survey("check", "--data", directory, "--format", "json")
    assert shown.exit_code == 1
    problems = json.loads(shown.stdout)["problems"]
    lines = shown.stderr.splitlines()
    assert len(lines) == len(problems) > 0
    for line, problem in zip(lines, problems, strict=True):
        assert line.startswith(f"sunatlas: {problem['file']}")
        assert problem["row"] is None or f"row {problem['row']}" in line
        assert problem["column"] is None or f"column {problem['column']}" in line
    return problems


def test_the_report_counts_129_studies_and_judges_51_findings():
    shown = survey("check", "--format", "json")
    assert shown.exit_code == 0
    assert shown.stderr == ""
    report = json.loads(shown.stdout)
    assert (report["studies"], report["stated"]) == (129, 128)
    assert report["explanation"]
    assert len(report["findings"]) == 51
    verdicts = [finding["verdict"] for finding in report["findings"]]
    assert set(verdicts) <= {"reproduced", "partly", "tied", "contradicted", "undecidable"}
    assert report["verdicts"] == {name: verdicts.count(name) for name in report["verdicts"]}
    assert all("ranking" in clause for found in report["findings"] for clause in found["clauses"])
    assert report["problems"] == []


def test_a_row_with_a_cell_too_many_is_named_in_every_table(copy):
    expected = set()
    for name in TABLES:
        text = (copy / name).read_text("utf-8")
        (copy / name).write_text(text.rstrip("\n") + ",surplus\n", "utf-8")
        expected.add((name, text.count("\n")))
    assert len(expected) == 30
    assert expected <= {(p["file"], p["row"]) for p in refused(copy)}


# ---- import


@pytest.fixture
def theirs(tmp_path):
    """A table as others might write it: other names, one value changed, one unreadable by us."""
    path = tmp_path / "theirs.csv"
    write(
        path,
        [
            ["Citation key", "Sensor technology", "Remarks"],
            ["Chang2008", "CCD", "hello"],
            ["Ali2011", "", ""],
        ],
    )
    return path


def test_an_import_shows_the_mapping_and_the_cells_and_writes_nothing(copy, theirs):
    before = (copy / "attributes.csv").read_bytes()
    shown = survey(
        *("import", theirs, "--map", "Sensor technology=detector", "--data", copy),
        *("--format", "json"),
    )
    assert shown.exit_code == 0
    plan = json.loads(shown.stdout)
    taken = {match["column"]: match["target"] for match in plan["mapping"]["matches"]}
    assert taken == {"Citation key": "study", "Sensor technology": "detector"}
    assert plan["mapping"]["ignored"] == ["Remarks"]
    cells = [(d["study"], d["attribute"], d["theirs"]) for d in plan["differences"]]
    assert cells == [("Chang2008", "detector", ["CCD"])]
    assert plan["written"] == 0
    assert (copy / "attributes.csv").read_bytes() == before
    table = survey("import", theirs, "--map", "Sensor technology=detector", "--data", copy)
    assert "Nothing written; --apply writes 1 cells." in table.stdout


def test_a_bibliography_is_compared_and_its_studies_are_counted(tmp_path):
    """One that is confirmed, one of another year, one of no study; nothing is written."""
    before = (OURS / "studies.csv").read_bytes()
    path = tmp_path / "refs.bib"
    path.write_text(
        "@article{Chang2008, title={Another title altogether}, year={2008}}\n"
        "@article{Mafi2023, title={Of another year}, year={2021}}\n"
        "@book{Knuth1984, title={No study}, year={1984}}\n"
    )
    shown = survey("import", path)
    assert shown.exit_code == 0
    said = " ".join(shown.stdout.split())
    for words in (
        "4 cells of studies that refs.bib says otherwise",
        "confirmed and said otherwise: Chang2008; --replace KEY takes what the file says",
        "Mafi2023: published in 2021 there; the year of the key stays",
        "left aside: Knuth1984: no study has this key",
        "127 studies are not in it: Abhilash2014,",
        "Nothing written; --apply writes 2 cells and 1 identity.",
    ):
        assert words in said
    assert said.count("the year of the key stays") == 1
    rows = list(csv.DictReader(io.StringIO(survey("import", path, "--format", "csv").stdout)))
    assert [(row["study"], row["column"], row["kind"], row["line"]) for row in rows] == [
        ("Chang2008", "title", "conflict", "1"),
        ("Mafi2023", "title", "new", "2"),
        ("Mafi2023", "type", "new", "2"),
        ("Mafi2023", "year", "kept", "2"),
    ]
    assert (OURS / "studies.csv").read_bytes() == before
    for options, refused in ((["--map", "a=b"], path), (["--replace", "Mafi2023"], "table.csv")):
        assert survey("import", refused, *options).exit_code == 2


@pytest.mark.parametrize("key", ["Liebe2001", "Herman2025c"])
def test_no_template_is_written_for_a_key_that_is_taken(key, tmp_path):
    shown = survey("add", "--init", key, tmp_path / "new.toml")
    assert (shown.exit_code, key in shown.stderr) == (2, True)
    assert not list(tmp_path.iterdir())
