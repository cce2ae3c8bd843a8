"""`sunatlas curves` and /v1/curves: the same learning curves, however they are asked."""

import csv
import io
import json

from typer.testing import CliRunner

from api.cli.command_line import app
from benchmark.learning_curves import record


def run(*arguments):
    return CliRunner(env={"COLUMNS": "200"}).invoke(app, ["curves", *arguments])


def test_formats_and_http_say_the_same_as_the_record(atlas):
    document = json.loads(run("--format", "json").stdout)
    assert document["items"] == record.published_curves() == atlas.walk("/v1/curves?limit=50")
    rows = list(csv.DictReader(io.StringIO(run("--format", "csv").stdout)))
    assert rows == atlas.table("/v1/curves")
    assert len(rows) == document["total"]


def test_the_table_shows_a_row_a_leader_and_a_dash_for_more_than_all_poses():
    shown = run("--dataset", "cmos-l-slit")
    assert shown.exit_code == 0
    known = [row for row in record.published_curves() if row["dataset"] == "cmos-l-slit"]
    assert len(known) == 3
    for row in known:
        (line,) = [
            text
            for text in shown.stdout.splitlines()
            if f"{row['extractor']} + {row['model']} " in text
        ]
        needed = "-" if row["needed_poses"] is None else str(row["needed_poses"])
        assert f" {needed} " in line
        assert f"{row['over_bound']:.4g}" in line


def test_they_are_narrowed_and_a_wrong_name_is_answered_with_the_nearest(atlas):
    found = atlas.get("/v1/curves?dataset=pd-code-dial&model=periodic").json()
    assert [(row["dataset"], row["model"]) for row in found["items"]] == [
        ("pd-code-dial", "periodic")
    ]
    wrong = run("--dataset", "pd-code-dail")
    assert wrong.exit_code == 2
    assert "did you mean 'pd-code-dial'" in wrong.stderr
    refused = atlas.get("/v1/curves?model=periodicc")
    assert refused.status_code == 422
    assert refused.json()["errors"][0]["nearest"] == "periodic"
