"""The leaderboard follows from the results; a changed number is named by file and cell."""

import csv
import io
import json
import re
from html.parser import HTMLParser

import fake_plan
import pytest
from fake_atlas import Broken, Diodes, LeastSquares

from benchmark import leaderboard, runner_unit, sweeps
from benchmark.content_key import canonical_json
from benchmark.leaderboard_check import compare
from benchmark.leaderboard_formats import FORMATS, SHOWN
from benchmark.store import Store

BOARDS = sorted(set(FORMATS) - {"sweeps.csv"})
pytestmark = pytest.mark.usefixtures("readings_only")
CELL = "fake-diodes/noisy/fake-currents/fake-least-squares"
PARTS = fake_plan.parts(presets=(Diodes(), Diodes(name="fake-second")))


@pytest.fixture(scope="module")
def made(tmp_path_factory, readings_only):
    runner_unit._kept.clear()
    directory = tmp_path_factory.mktemp("published")
    leaderboard.update(directory, parts=PARTS)
    return directory


@pytest.fixture
def published(made, tmp_path):
    """A copy that a test may damage."""
    for path in made.glob("*.*"):
        if path.is_file():
            (tmp_path / path.name).write_bytes(path.read_bytes())
    return tmp_path


def check(directory, **options):
    return leaderboard.check(directory, parts=PARTS, **options)


def change(path, old, new):
    text = path.read_text()
    assert text.count(old) >= 1, (path, old)
    path.write_text(text.replace(old, new, 1))


def test_rows_are_ranked_by_error_within_dataset_and_condition():
    def row(model, rms, condition="c", dataset="d"):
        return {
            "dataset": dataset, "condition": condition, "extractor": "e", "model": model,
            "key": model, "rms_deg": rms, "dataset_version": 1, "detector": "PD", "mask": "M",
        }  # fmt: skip

    rows = [
        row("a", 2.0),
        row("b", None),
        row("c", 1.0),
        row("d", 3.0, "b"),
        row("e", 9.0, "b", "a"),
    ]
    board = leaderboard.build(rows, {"a": {"time_ratio": 4.0}})
    assert [d["name"] for d in board["datasets"]] == ["a", "d"]
    assert board["datasets"][1]["conditions"] == ["b", "c"]
    ranked = [(r["condition"], r["rank"], r["model"]) for r in board["datasets"][1]["rows"]]
    assert ranked == [("b", 1, "d"), ("c", 1, "c"), ("c", 2, "a"), ("c", None, "b")]
    assert board["datasets"][1]["rows"][2]["time_ratio"] == 4.0


def test_all_files_are_written_and_nothing_changes_the_second_time(published):
    assert {path.name for path in published.iterdir()} == {
        *FORMATS, "scores.jsonl", "runs.jsonl", "data.jsonl", "sweeps.jsonl",
    }  # fmt: skip
    before = {path: path.stat().st_mtime_ns for path in published.iterdir() if path.is_file()}
    assert leaderboard.write(published) == []
    assert leaderboard.update(published, parts=PARTS).computed == 0
    after = {path: path.stat().st_mtime_ns for path in published.iterdir() if path.is_file()}
    assert after == before


def test_json_and_csv_hold_every_stored_number(published):
    stored = {row["key"]: row for row in Store(published).rows()}
    as_json = json.loads((published / "leaderboard.json").read_text())
    rows = [row for dataset in as_json["datasets"] for row in dataset["rows"]]
    assert len(rows) == len(stored) == 8
    for row in rows:
        assert row.items() >= stored[row["key"]].items()
        assert row["time_ratio"] > 0
    as_csv = list(csv.DictReader(io.StringIO((published / "leaderboard.csv").read_text())))
    for line, row in zip(as_csv, rows, strict=True):
        assert line == {name: "" if value is None else str(value) for name, value in row.items()}


class Tags(HTMLParser):
    def __init__(self):
        super().__init__()
        self.open, self.outside = [], []

    def handle_starttag(self, tag, attrs):
        if tag not in ("meta", "link", "br"):
            self.open.append(tag)
        self.outside += [v for name, v in attrs if name in ("src", "href") and v[0] != "#"]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def test_the_page_is_well_formed_and_needs_nothing_from_elsewhere(published):
    text = (published / "leaderboard.html").read_text()
    reader = Tags()
    reader.feed(text)
    assert reader.open == []
    assert reader.outside == []
    assert "prefers-color-scheme: dark" in text
    assert "url(" not in text


def test_a_reason_cannot_break_the_page_and_failures_are_shown(tmp_path, monkeypatch):
    class Sly(Broken):
        def fit(self, features, sun):
            raise ValueError('<script>"x"</script> | y')

    leaderboard.update(tmp_path, parts=fake_plan.parts(LeastSquares, Sly))
    text = (tmp_path / "leaderboard.html").read_text()
    assert "<script>" not in text
    assert "&lt;script&gt;" in text
    assert (
        "No score: fake-diodes/quiet/fake-gaps/fake-broken: ValueError"
        in (tmp_path / "leaderboard.md").read_text()
    )


def test_what_is_committed_passes_with_and_without_measuring_again(published):
    assert check(published, stored_only=True) == []
    assert check(published) == []


@pytest.mark.parametrize("name", BOARDS)
@pytest.mark.parametrize("column", ["rms_deg", "found_fraction", "time_ratio", "rank"])
def test_one_number_changed_in_a_derived_file_is_named(published, name, column):
    path = published / name
    right = FORMATS[name].read(path.read_text())[CELL, column]
    wrong = {"rank": "7"}.get(column, "0.123")
    texts = {
        "leaderboard.json": (rf'("{column}": )[^,\n]+', rf"\g<1>{wrong}"),
        "leaderboard.html": (
            rf'(data-cell="{CELL}".*?data-column="{column}">)[^<]+', rf"\g<1>{wrong}",
        ),
    }  # fmt: skip
    text = path.read_text()
    if name == "leaderboard.json":
        board = json.loads(text)
        for row in board["datasets"][0]["rows"]:
            if "/".join(row[n] for n in ("dataset", "condition", "extractor", "model")) == CELL:
                row[column] = json.loads(wrong)
        path.write_text(json.dumps(board, indent=1) + "\n")
    elif name == "leaderboard.html":
        path.write_text(re.sub(*texts[name], text, count=1, flags=re.DOTALL))
    else:
        separator = "," if name.endswith("csv") else " | "
        lines, parts = text.splitlines(), CELL.split("/")
        heads = lines[0].split(",") if separator == "," else list(SHOWN)
        start = 0 if separator == "," else lines.index("### noisy", lines.index("## fake-diodes"))
        wanted = parts if separator == "," else parts[2:]
        for number in range(start, len(lines)):
            values = lines[number].strip("| ").split(separator)
            if all(part in values for part in wanted):
                values[heads.index(column)] = wrong
                line = separator.join(values)
                lines[number] = line if separator == "," else f"| {line} |"
                break
        path.write_text("\n".join(lines) + "\n")
    [difference] = check(published, stored_only=True)
    assert (difference.file, difference.cell) == (name, f"{CELL}/{column}")
    assert (difference.committed, difference.measured) == (wrong, right)


def test_one_number_changed_in_the_scores_is_named_there(published):
    row = next(r for r in Store(published).rows() if r["condition"] == "noisy")
    cell = "/".join(row[n] for n in ("dataset", "condition", "extractor", "model"))
    for column in ("rms_deg", "bias_alpha_deg"):
        old = f'"{column}":{json.dumps(row[column])}'
        change(published / "scores.jsonl", old, f'"{column}":0.5')
        [difference] = check(published, stored_only=True)
        assert (difference.file, difference.cell) == ("scores.jsonl", f"{cell}/{column}")
        assert (difference.committed, difference.measured) == ("0.5", str(row[column]))
        change(published / "scores.jsonl", f'"{column}":0.5', old)
    assert check(published, stored_only=True) == []


def test_a_number_changed_everywhere_is_found_by_measuring_again(published):
    row = Store(published).query(condition="noisy")[0]
    cell = "/".join(row[n] for n in ("dataset", "condition", "extractor", "model"))
    change(published / "scores.jsonl", f'"p95_deg":{row["p95_deg"]}', '"p95_deg":0.5')
    leaderboard.write(published)
    assert check(published, stored_only=True) == []
    [difference] = check(published)
    assert (difference.file, difference.cell) == ("scores.jsonl", f"{cell}/p95_deg")
    assert (difference.committed, difference.measured) == ("0.5", str(row["p95_deg"]))


def test_a_row_taken_out_or_a_file_missing_is_named(published):
    lines = (published / "scores.jsonl").read_text().splitlines(keepends=True)
    (published / "scores.jsonl").write_text("".join(lines[1:]))
    (published / "leaderboard.md").unlink()
    found = {
        (d.file, d.cell.rpartition("/")[2], d.committed) for d in check(published, stored_only=True)
    }
    assert ("scores.jsonl", "row", "absent") in found
    assert ("leaderboard.md", "file", "absent") in found


def test_other_bytes_without_another_number_are_a_named_line(published):
    change(published / "leaderboard.md", "# Leaderboard", "# Leader board")
    [difference] = check(published, stored_only=True)
    assert (difference.file, difference.cell) == ("leaderboard.md", "line 1")


def test_an_unreadable_leaderboard_is_named(published):
    (published / "leaderboard.json").write_text("{")
    [difference] = check(published, stored_only=True)
    assert difference.file == "leaderboard.json"
    assert "unreadable" in difference.committed


def test_results_of_other_code_are_named_without_measuring(published):
    newer = type("Newer", (LeastSquares,), {"version": 2, "__module__": "fake_atlas"})
    parts = fake_plan.parts(newer, presets=(Diodes(), Diodes(name="fake-second")))
    found = leaderboard.check(published, stored_only=True, parts=parts)
    assert len(found) == 8
    assert all(d.cell.endswith("/key") for d in found)
    fewer = leaderboard.check(published, stored_only=True, parts=fake_plan.parts())
    assert {(d.cell.split("/")[0], d.measured) for d in fewer} == {
        ("fake-second", "not planned"),
        ("fake-second", "no such data"),
    }


def test_accuracy_is_compared_within_a_thousandth_and_counts_within_a_sample(published):
    committed = Store(published).rows()

    def differences(column, factor):
        measured = [{**row} for row in committed]
        measured[0][column] = committed[0][column] * factor
        return [d.cell.rpartition("/")[2] for d in compare(committed, measured)]

    assert differences("rms_deg", 1.0005) == []
    assert differences("rms_deg", 1.002) == ["rms_deg"]
    assert differences("found_fraction", 1 - 1 / 400) == []
    assert differences("found_fraction", 1 - 2 / 400) == ["found_fraction"]
    assert differences("n_test", 2) == ["n_test"]
    failed = [{**row, "status": "failed", "rms_deg": None} for row in committed[:1]]
    assert {d.cell.rpartition("/")[2] for d in compare(committed, failed)} == {"status", "rms_deg"}
    assert compare([], committed[:1])[0].committed == "absent"


SWEPT = "faces/noise/50/fake-currents"


def test_sweeps_stand_in_every_file(published):
    stored = sweeps.read(published)
    assert {row["series"] for row in stored} >= {"faces", "quadrants"}
    assert json.loads((published / "leaderboard.json").read_text())["sweeps"] == stored
    for name in ("leaderboard.json", "sweeps.csv", "leaderboard.md", "leaderboard.html"):
        cells = FORMATS[name].read((published / name).read_text())
        assert (SWEPT, "over_bound") in cells, name


def test_a_changed_sweep_is_named_by_its_file_and_point(published):
    path = published / "sweeps.jsonl"
    lines = path.read_text().splitlines()
    for number, line in enumerate(lines):
        row = json.loads(line)
        if "/".join(row[n] for n in ("series", "sweep", "point", "extractor")) == SWEPT:
            lines[number] = canonical_json({**row, "rms": row["rms"] * 1.5})
    path.write_text("\n".join(lines) + "\n")
    (found,) = check(published, stored_only=True)
    assert (found.file, found.cell) == ("sweeps.jsonl", f"{SWEPT}/rms")
    leaderboard.write(published)
    assert check(published, stored_only=True) == []  # files agree; only measuring tells
    (found,) = check(published)
    assert (found.file, found.cell) == ("sweeps.jsonl", f"{SWEPT}/rms")


def test_a_changed_number_in_a_page_of_sweeps_is_named(published):
    path = published / "sweeps.csv"
    lines = path.read_text().splitlines(keepends=True)
    place = next(n for n, line in enumerate(lines) if line.startswith("faces,noise,50,fake-curr"))
    lines[place] = lines[place].replace(",300,", ",299,", 1)
    path.write_text("".join(lines))
    (found,) = check(published, stored_only=True)
    assert (found.file, found.cell, found.committed) == ("sweeps.csv", f"{SWEPT}/n", "299")
