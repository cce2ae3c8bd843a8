"""After the import of a table with everything that one can bring, everything is still served."""

from __future__ import annotations

import csv
import itertools
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app
from survey_data import load
from survey_data.descriptor import DATA_DIRECTORY

ROOT = Path(__file__).parents[2]
COLUMNS = ("task", "error", "detector", "mask", "model", "extractor", "accuracy")
NUMBERS = {"accuracy_deg": ("0.02", "0.5", "3"), "fov_deg": ("60", "90", "128")}

#: Asks a service over the tables beside it for everything, and prints what failed.
ASK = """
import json, sys
from api.server.app import create_app
from registry.studies import facts
from tests.api.conftest import Client
from tests.api.pages.addresses import KINDS

client = Client(create_app())
known = facts()
from_table = sum(v.basis == "authors-table" for s in known.studies.values()
                 for values in s.values.values() for v in values)
described = client.get("/openapi.json").json()["paths"]
asked = [*KINDS.values(), *(p for p, ways in described.items() if "get" in ways and "{" not in p)]
for key in known.studies:
    asked += [f"/studies/{key}", f"/v1/studies/{key}"]
for path in [path for path in asked if path.startswith("/v1/")]:
    asked.append(path + "?format=csv")
for attribute in ("detector", "mask", "model", "extractor", "task", "error", "accuracy"):
    for value in known.taxonomy.values(attribute):
        asked += [f"/studies?{attribute}={value}", f"/v1/recommendations?{attribute}={value}"]
found = {address: client.get(address).status_code for address in dict.fromkeys(asked)}
json.dump({"asked": len(found), "from_table": from_table,
           "failed": {a: s for a, s in found.items() if s >= 500}}, sys.stdout)
"""


def made_up_table(path: Path) -> None:
    """Write a table of every study of the survey with a value in every column."""
    tables = load()
    vocabulary = {
        name: itertools.cycle(
            tables.taxonomy.loc[tables.taxonomy["attribute"] == name, "value"].tolist()
        )
        for name in COLUMNS
    }
    numbers = {name: itertools.cycle(values) for name, values in NUMBERS.items()}
    with path.open("w", encoding="utf-8", newline="") as stream:
        write = csv.writer(stream)
        write.writerow(["study", *COLUMNS, *NUMBERS])
        for key in tables.studies["key"].tolist()[:128]:
            values = [next(vocabulary[c]) for c in COLUMNS]
            write.writerow([key, *values, *(next(numbers[c]) for c in NUMBERS)])


@pytest.fixture(scope="module")
def imported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A directory with tables of facts into which the whole made-up table was imported."""
    directory = tmp_path_factory.mktemp("imported")
    ours = directory / "survey_data"
    shutil.copytree(DATA_DIRECTORY, ours, ignore=shutil.ignore_patterns("__pycache__"))
    made_up_table(directory / "theirs.csv")
    command = ["survey", "import", str(directory / "theirs.csv"), "--data", str(ours)]
    shown = CliRunner().invoke(app, [*command, "--format", "json"], catch_exceptions=False)
    assert json.loads(shown.stdout)["differences"]
    done = CliRunner().invoke(app, [*command, "--apply"], catch_exceptions=False)
    assert done.exit_code == 0, done.stderr
    return directory


def run(code: str, directory: Path, *arguments: str) -> Any:
    """Run code over the tables in a directory; return what it prints as JSON."""
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(directory), str(ROOT)]),
        "SUNATLAS_STORE": str(directory / "working"),
    }
    ran = subprocess.run(
        [sys.executable, "-c", code, *arguments],
        env=environment,
        cwd=directory,
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    return json.loads(ran.stdout)


@pytest.mark.slow
def test_after_an_import_of_every_column_everything_is_served(imported: Path) -> None:
    output = run(ASK, imported)
    assert output["from_table"] > 128
    assert output["asked"] > 400
    assert output["failed"] == {}
