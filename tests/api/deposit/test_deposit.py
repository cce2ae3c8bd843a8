"""The bundle: valid, complete, checkable, reproducible, and never over somebody else's files."""

import csv
import hashlib
import json
import os
import shutil
import subprocess
import zipfile
from functools import partial
from pathlib import Path

import pytest
import yaml
from frictionless import Package
from pyarrow import parquet

import survey_data
from api.deposit import bundle as deposit
from api.deposit.deposit_tables import NothingPublishedError
from api.deposit.verification import verify
from benchmark.results import samples
from benchmark.results.store import PUBLISHED
from files import manifest
from files.checksums import CHECKSUMS
from survey_data.editions import editions
from tests.api.deposit.conftest import FRAMES

ROOT = Path(__file__).resolve().parents[3]


build = partial(deposit.build, frames=FRAMES)


def files(directory):
    return {
        path.relative_to(directory).as_posix(): path.read_bytes()
        for path in directory.rglob("*")
        if path.is_file()
    }


@pytest.mark.slow
def test_the_data_package_is_valid(built):
    report = Package(str(built.directory / "datapackage.json")).validate()
    assert report.valid, report.flatten(["place", "rowNumber", "fieldName", "message"])
    described = json.loads((built.directory / "datapackage.json").read_text("utf-8"))["resources"]
    assert report.stats["tasks"] == len(described)
    tables = [resource for resource in described if resource.get("type") == "table"]
    # three splits of each data set; errors and directions of every data set; the code
    others = 3 * len(FRAMES) + 2 * len(samples.datasets(PUBLISHED)) + 1
    assert len(described) - len(tables) == others
    assert len(tables) > 30
    assert verify(built.directory) == []


@pytest.mark.skipif(shutil.which("sha256sum") is None, reason="no sha256sum on this machine")
def test_sha256sum_reads_the_checksums(small):
    command = ["sha256sum", "--strict", "--check", CHECKSUMS]
    shown = subprocess.run(command, cwd=small, capture_output=True, text=True, check=False)
    assert shown.returncode == 0, shown.stdout


@pytest.mark.slow
def test_two_builds_are_the_same_bytes(built, tmp_path):
    before = os.umask(0o077)
    try:
        again = build(tmp_path / "elsewhere" / "other-name")
    finally:
        os.umask(before)
    assert files(again.directory) == files(built.directory)
    assert again.archive.read_bytes() == built.archive.read_bytes()


def test_the_zip_holds_what_the_directory_holds(small):
    with zipfile.ZipFile(small.with_name("bundle.zip")) as archive:
        assert archive.testzip() is None
        packed = {entry.filename: archive.read(entry) for entry in archive.infolist()}
        moments = {entry.date_time for entry in archive.infolist()}
    top = {name.partition("/")[0] for name in packed}
    assert len(top) == 1
    assert {name.partition("/")[2]: c for name, c in packed.items()} == files(small)
    assert len(moments) == 1


@pytest.mark.slow
def test_every_column_is_described(built):
    described = json.loads((built.directory / "datapackage.json").read_text("utf-8"))
    assert described["$schema"].startswith("https://datapackage.org/profiles/2.")
    for resource in described["resources"]:
        content = (built.directory / resource["path"]).read_bytes()
        assert resource["hash"] == f"sha256:{hashlib.sha256(content).hexdigest()}"
        assert resource["bytes"] == len(content)
        if resource["path"].endswith((".npz", ".tar.gz")):
            continue
        if resource["path"].endswith(".parquet"):  # Table Schema readers here know CSV alone
            for column in parquet.read_schema(built.directory / resource["path"]).names:
                assert f" {column}: " in resource["description"]
            continue
        fields = resource["schema"]["fields"]
        with (built.directory / resource["path"]).open(encoding="utf-8", newline="") as file:
            header = next(csv.reader(file))
        assert [field["name"] for field in fields] == header
        assert all(field["type"] for field in fields)
        if resource["path"].startswith("benchmark/"):
            assert all(field["description"] for field in fields)


@pytest.mark.slow
def test_the_terms_go_with_the_files(built):
    assert (built.directory / "LICENSE").read_bytes() == (ROOT / "LICENSE").read_bytes()
    theirs, ours = (
        yaml.safe_load((place / "CITATION.cff").read_text("utf-8"))
        for place in (built.directory, ROOT)
    )
    named, *cited = theirs.pop("identifiers")
    assert [one["value"] for one in cited] == [
        f"{edition.name}:{edition.version}" for edition in editions()
    ]
    content = (PUBLISHED / manifest.FILE).read_bytes()
    assert named["value"] == f"sha256:{hashlib.sha256(content).hexdigest()}"
    assert theirs == {**ours, "type": "dataset"}
    assert "CC BY 4.0" in (built.directory / "survey" / "LICENSE").read_text("utf-8")


def test_tables_with_problems_are_not_deposited(tmp_path):
    survey = tmp_path / "survey"
    shutil.copytree(Path(survey_data.__file__).parent, survey)
    path = survey / "attributes.csv"
    path.write_text(path.read_text("utf-8").replace(",CMOS,", ",CMSO,", 1), "utf-8")
    with pytest.raises(deposit.DepositError, match=r"attributes\.csv, row \d+, column value"):
        build(tmp_path / "bundle", survey=survey)
    assert not (tmp_path / "bundle").exists()


def test_without_published_results_there_is_nothing_to_deposit(tmp_path):
    with pytest.raises(NothingPublishedError, match="sunatlas leaderboard"):
        build(tmp_path / "bundle", published=tmp_path)
    assert list(tmp_path.iterdir()) == []
