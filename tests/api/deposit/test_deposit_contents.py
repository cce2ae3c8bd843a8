"""What lies in a bundle beside its CSV: Parquet, SQLite, references, crate, samples, an example."""

import csv
import json
import re
import sqlite3
import subprocess
import sys
from contextlib import closing

import pyarrow.parquet
import pytest

from api.deposit.database import sql_name
from api.deposit.forms import CellError, write_other_forms
from files.checksums import CHECKSUMS
from tests.api.deposit.test_deposit import files


def described(bundle):
    return json.loads((bundle / "datapackage.json").read_text("utf-8"))["resources"]


def tables(bundle):
    return [resource for resource in described(bundle) if resource.get("type") == "table"]


def rows(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def text(value, kind):
    """A typed value as some cell of a CSV may spell it."""
    if value is None:
        return ""
    if kind == "boolean":
        return "true" if value else "false"
    return value if kind == "number" else str(value)


def agrees(cell, value, kind):
    if kind == "number" and value is not None:
        return float(cell) == value
    return cell == text(value, kind)


@pytest.mark.slow
def test_parquet_holds_what_csv_holds(built):
    found = {path.stem for path in (built.directory / "parquet").iterdir()}
    assert found == {resource["name"] for resource in tables(built.directory)}
    for resource in tables(built.directory):
        path = built.directory / "parquet" / f"{resource['name']}.parquet"
        made = pyarrow.parquet.read_table(path).to_pylist()
        kinds = {field["name"]: field["type"] for field in resource["schema"]["fields"]}
        for row, cells in zip(made, rows(built.directory / resource["path"]), strict=True):
            assert row.keys() == cells.keys()
            for name, kind in kinds.items():
                assert agrees(cells[name], row[name], kind), (resource["name"], name, row)


@pytest.mark.slow
def test_sqlite_holds_what_csv_holds_under_plain_names(built):
    path = built.directory / "sun-sensor-atlas.sqlite"
    with closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as base:
        base.row_factory = sqlite3.Row
        assert base.execute("PRAGMA integrity_check").fetchone()[0] == "ok"
        assert base.execute("PRAGMA foreign_key_check").fetchall() == []
        known = {r[0] for r in base.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
        assert known == {
            *(sql_name(resource["name"]) for resource in tables(built.directory)),
            *("tables_of_the_atlas", "columns_of_the_atlas"),
        }
        for resource in tables(built.directory):
            name = sql_name(resource["name"])
            fields = resource["schema"]["fields"]
            # No quotes: a name that needs them would be a syntax error here.
            listed = ", ".join(sql_name(field["name"]) for field in fields)
            made = base.execute(f"SELECT {listed} FROM {name} ORDER BY rowid").fetchall()
            cells = rows(built.directory / resource["path"])
            for row, stored in zip(made, cells, strict=True):
                for value, field in zip(tuple(row), fields, strict=True):
                    assert agrees(stored[field["name"]], value, field["type"]), (
                        name,
                        field["name"],
                    )
            keys = {r["from"] for r in base.execute(f"PRAGMA foreign_key_list({name})")}
            wanted = resource["schema"].get("foreignKeys", ())
            assert keys == {sql_name(f) for key in wanted for f in key["fields"]}


@pytest.mark.parametrize("name", ["two words", "1st", "Group", "a;drop", ""])
def test_a_name_that_needs_quotes_is_refused(name):
    with pytest.raises(ValueError, match="no plain name"):
        sql_name(name)


@pytest.mark.slow
def test_a_cell_of_another_type_does_not_go_out(bundle, tmp_path):
    path = bundle / "survey" / "studies.csv"
    path.write_text(path.read_text("utf-8").replace(",2008,", ",MMVIII,", 1), "utf-8")
    with pytest.raises(CellError, match=r"studies\.csv.*Row #\d+.*int64.*MMVIII"):
        write_other_forms(bundle, {"resources": described(bundle)}, tmp_path)


@pytest.mark.slow
def test_the_crate_names_every_file_with_its_checksum(built):
    crate = json.loads((built.directory / "ro-crate-metadata.json").read_text("utf-8"))
    graph = {entity["@id"]: entity for entity in crate["@graph"]}
    assert len(graph) == len(crate["@graph"])
    about = graph["ro-crate-metadata.json"]
    assert about["conformsTo"] == {"@id": "https://w3id.org/ro/crate/1.2"}
    assert crate["@context"] == "https://w3id.org/ro/crate/1.2/context"
    root = graph[about["about"]["@id"]]
    parts = {part["@id"] for part in root["hasPart"]}
    assert parts == set(files(built.directory)) - {"ro-crate-metadata.json", CHECKSUMS}
    assert {"name", "description", "datePublished", "license"} <= root.keys()
    listed = dict(
        line.split("  ", 1)[::-1]
        for line in (built.directory / CHECKSUMS).read_text("utf-8").splitlines()
    )
    for part in parts:
        assert int(graph[part]["contentSize"]) == (built.directory / part).stat().st_size
        assert graph[part]["sha256"] == listed[part]
        assert graph[part]["description"]
    for entity in graph.values():
        for name in ("license", "author", "hasPart", "about", "affiliation"):
            found = entity.get(name, [])
            for reference in found if isinstance(found, list) else [found]:
                assert reference["@id"] in graph


@pytest.mark.slow
def test_the_example_of_the_readme_runs_where_it_lies(bundle):
    readme = (bundle / "README.md").read_text("utf-8")
    (example,) = re.findall(r"^```python\n(.*?)^```$", readme, re.DOTALL | re.MULTILINE)
    # -I: neither this checkout nor the environment helps.
    shown = subprocess.run(
        [sys.executable, "-I", "-W", "error", "-c", example],
        cwd=bundle,
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert shown.returncode == 0, shown.stderr
    lines = shown.stdout.splitlines()
    assert lines[0].startswith("cmos-single-aperture ")
    error = float(re.search(r"error: ([\d.]+) deg over 400 frames", shown.stdout)[1])
    # calibrated and tested with true directions, as the leaders: no bench of 0.01 deg is in it
    leaders = [float(line.split(" ")[-1]) for line in lines if re.match(r"\d+ ", line)]
    assert len(leaders) == 3
    assert leaders[0] < error < 5 * leaders[0]
    read = {line.split(" ")[0] for line in lines if ".npz" in line}
    assert read == {row["file"] for row in rows(bundle / "benchmark" / "frames.csv")}
