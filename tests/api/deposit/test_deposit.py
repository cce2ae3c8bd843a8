"""The bundle: valid, complete, checkable, reproducible, and never over somebody else's files."""

import csv
import hashlib
import json
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from frictionless import Package

import survey_data
from api.deposit import bundle as deposit
from api.deposit.tables import NothingPublishedError
from benchmark.datasets.checksums import CHECKSUMS, ChecksumFileError, read_checksums
from benchmark.results.store import PUBLISHED, Store

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """A bundle nobody changes."""
    return deposit.build(tmp_path_factory.mktemp("deposit") / "bundle")


@pytest.fixture
def bundle(built, tmp_path):
    """A bundle of one's own."""
    return Path(shutil.copytree(built.directory, tmp_path / "bundle"))


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
    assert (
        report.stats["tasks"] == 21 + 6 + 3
    )  # the survey's tables, the measured and the told ones
    assert deposit.verify(built.directory) == []


@pytest.mark.slow
def test_frictionless_on_the_command_line_agrees(built):
    command = (sys.executable, "-m", "frictionless", "validate", "datapackage.json", "--json")
    shown = subprocess.run(
        command, cwd=built.directory, capture_output=True, text=True, check=False, timeout=600
    )
    assert shown.returncode == 0, shown.stdout
    assert json.loads(shown.stdout)["valid"]


@pytest.mark.slow
def test_the_checksums_hold_by_another_s_count(built):
    listed = {}
    for line in (built.directory / CHECKSUMS).read_text("utf-8").splitlines():
        digest, name = line.split("  ", 1)
        assert name not in listed
        listed[name] = digest
    counted = {
        name: hashlib.sha256(content).hexdigest()
        for name, content in files(built.directory).items()
        if name != CHECKSUMS
    }
    assert listed == counted


@pytest.mark.skipif(shutil.which("sha256sum") is None, reason="no sha256sum on this machine")
def test_sha256sum_reads_the_checksums(built):
    command = ["sha256sum", "--strict", "--check", CHECKSUMS]
    shown = subprocess.run(
        command, cwd=built.directory, capture_output=True, text=True, check=False
    )
    assert shown.returncode == 0, shown.stdout


@pytest.mark.slow
def test_a_flipped_byte_is_found_in_every_file(bundle):
    names = [name for name in files(bundle) if name != CHECKSUMS]
    assert len(names) > 20
    for name in names:
        content = (bundle / name).read_bytes()
        middle = len(content) // 2
        flipped = content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]
        (bundle / name).write_bytes(flipped)
        assert [place for place, _ in deposit.verify(bundle)] == [name]
        (bundle / name).write_bytes(content)
    assert deposit.verify(bundle) == []


def test_a_missing_and_an_added_file_are_found(bundle):
    (bundle / "survey" / "claims.csv").unlink()
    (bundle / "survey" / "claims2.csv").write_text("id\n")
    assert deposit.verify(bundle) == [
        ("survey/claims.csv", "listed but missing"),
        ("survey/claims2.csv", "not listed"),
    ]


@pytest.mark.slow
def test_a_wrong_table_is_found_though_its_checksum_holds(bundle):
    path = bundle / "survey" / "studies.csv"
    path.write_text(path.read_text("utf-8").replace("2008", "MMVIII", 1), "utf-8")
    (bundle / CHECKSUMS).unlink()
    deposit.write_checksums(bundle)
    assert {name for name, _ in deposit.verify(bundle)} >= {"survey/studies.csv"}


@pytest.mark.parametrize(
    "line", ["", "abc  README.md", f"{'0' * 64}  ../secret", f"{'0' * 64}  /etc/passwd"]
)
def test_a_list_of_checksums_that_is_none_is_refused(bundle, line):
    (bundle / CHECKSUMS).write_text(f"{line}\n")
    with pytest.raises(ChecksumFileError, match="line 1"):
        read_checksums(bundle)


@pytest.mark.slow
def test_two_builds_are_the_same_bytes(built, tmp_path):
    before = os.umask(0o077)
    try:
        again = deposit.build(tmp_path / "elsewhere" / "other-name")
    finally:
        os.umask(before)
    assert files(again.directory) == files(built.directory)
    assert again.archive.read_bytes() == built.archive.read_bytes()


def test_the_zip_holds_what_the_directory_holds(built):
    with zipfile.ZipFile(built.archive) as archive:
        assert archive.testzip() is None
        packed = {entry.filename: archive.read(entry) for entry in archive.infolist()}
        moments = {entry.date_time for entry in archive.infolist()}
    top = {name.partition("/")[0] for name in packed}
    assert len(top) == 1
    assert {name.partition("/")[2]: c for name, c in packed.items()} == files(built.directory)
    assert len(moments) == 1


@pytest.mark.slow
def test_the_tables_hold_what_their_sources_hold(built):
    package = Package(str(built.directory / "datapackage.json"))
    assert len(package.get_resource("studies").read_rows()) == 129
    for name in ("studies", "attributes", "findings"):
        ours = Path(survey_data.__file__).parent / f"{name}.csv"
        assert (built.directory / "survey" / f"{name}.csv").read_bytes() == ours.read_bytes()
    measured = [dict(row) for row in package.get_resource("scores").read_rows()]
    for row, stored in zip(measured, Store(PUBLISHED).rows(unit=None), strict=True):
        assert set(row) == set(stored)
        for column, value in stored.items():
            found = row[column]
            # An empty cell is text that is empty, or nothing at all.
            assert (found if found is None or isinstance(found, str) else type(value)(found)) in (
                [value] if value not in (None, "") else [None, ""]
            )


def test_every_column_is_described(built):
    described = json.loads((built.directory / "datapackage.json").read_text("utf-8"))
    assert described["$schema"].startswith("https://datapackage.org/profiles/2.")
    for resource in described["resources"]:
        with (built.directory / resource["path"]).open(encoding="utf-8", newline="") as file:
            header = next(csv.reader(file))
        fields = resource["schema"]["fields"]
        assert [field["name"] for field in fields] == header
        assert all(field["type"] for field in fields)
        content = (built.directory / resource["path"]).read_bytes()
        assert resource["hash"] == f"sha256:{hashlib.sha256(content).hexdigest()}"
        assert resource["bytes"] == len(content)
        if resource["path"].startswith("benchmark/"):
            assert all(field["description"] for field in fields)


def test_the_crate_names_every_file_and_refers_to_nothing_that_is_not_there(built):
    crate = json.loads((built.directory / "ro-crate-metadata.json").read_text("utf-8"))
    graph = {entity["@id"]: entity for entity in crate["@graph"]}
    assert len(graph) == len(crate["@graph"])
    assert graph["ro-crate-metadata.json"]["conformsTo"] == {"@id": "https://w3id.org/ro/crate/1.1"}
    root = graph[graph["ro-crate-metadata.json"]["about"]["@id"]]
    parts = {part["@id"] for part in root["hasPart"]}
    assert parts == set(files(built.directory)) - {"ro-crate-metadata.json", CHECKSUMS}
    assert {"name", "description", "datePublished", "license"} <= root.keys()
    for part in parts:
        assert int(graph[part]["contentSize"]) == len((built.directory / part).read_bytes())
    for entity in graph.values():
        for name in ("license", "author", "hasPart", "about"):
            found = entity.get(name, [])
            for reference in found if isinstance(found, list) else [found]:
                assert reference["@id"] in graph


def test_the_terms_go_with_the_files(built):
    assert (built.directory / "LICENSE").read_bytes() == (ROOT / "LICENSE").read_bytes()
    assert (built.directory / "CITATION.cff").read_bytes() == (ROOT / "CITATION.cff").read_bytes()
    assert "CC BY 4.0" in (built.directory / "survey" / "LICENSE").read_text("utf-8")


@pytest.mark.slow
def test_an_earlier_bundle_is_replaced_and_a_damaged_one_mended(built, tmp_path):
    out = tmp_path / "bundle"
    shutil.copytree(built.directory, out)
    (out / "README.md").write_text("damaged")
    deposit.build(out)
    assert files(out) == files(built.directory)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bundle", "bundle.zip"]


def foreign_file(out):
    out.mkdir()
    (out / "thesis.tex").write_text("irreplaceable")


def foreign_file_in_a_bundle(out):
    deposit.build(out)
    (out / "notes.txt").write_text("irreplaceable")


def another_data_package(out):
    out.mkdir()
    (out / "datapackage.json").write_text('{"name": "other", "resources": []}')
    deposit.write_checksums(out)


def plain_file(out):
    out.write_text("irreplaceable")


def link_elsewhere(out):
    out.symlink_to(out.parent)


def foreign_zip(out):
    with zipfile.ZipFile(out.with_name(f"{out.name}.zip"), "w") as archive:
        archive.writestr("thesis.tex", "irreplaceable")


@pytest.mark.slow
@pytest.mark.parametrize(
    "occupy",
    [
        foreign_file,
        foreign_file_in_a_bundle,
        another_data_package,
        plain_file,
        link_elsewhere,
        foreign_zip,
    ],
)
def test_what_is_not_ours_is_not_overwritten(occupy, tmp_path):
    out = tmp_path / "bundle"
    occupy(out)
    before = files(tmp_path)
    with pytest.raises(deposit.DepositError, match="nothing was written"):
        deposit.build(out)
    assert files(tmp_path) == before


@pytest.mark.slow
def test_a_build_that_fails_midway_leaves_the_earlier_bundle(built, tmp_path, monkeypatch):
    out = tmp_path / "bundle"
    shutil.copytree(built.directory, out)

    def full(*_arguments):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(deposit, "_pack", full)
    with pytest.raises(OSError, match="No space"):
        deposit.build(out)
    assert files(out) == files(built.directory)
    assert [path.name for path in tmp_path.iterdir()] == ["bundle"]


@pytest.mark.slow
def test_a_bundle_that_cannot_be_moved_into_place_leaves_the_earlier_one(
    built, tmp_path, monkeypatch
):
    out = tmp_path / "bundle"
    shutil.copytree(built.directory, out)
    (out / "README.md").write_text("of before")
    before, rename = files(out), Path.rename

    def refuse(path, target):
        if path.parent.name == "made" and Path(target) == out:
            raise OSError(5, "Input/output error")
        return rename(path, target)

    monkeypatch.setattr(Path, "rename", refuse)
    with pytest.raises(OSError, match="Input/output"):
        deposit.build(out)
    assert files(out) == before
    assert [path.name for path in tmp_path.iterdir()] == ["bundle"]


def test_tables_with_problems_are_not_deposited(tmp_path):
    survey = tmp_path / "survey"
    shutil.copytree(Path(survey_data.__file__).parent, survey)
    path = survey / "attributes.csv"
    path.write_text(path.read_text("utf-8").replace(",CMOS,", ",CMSO,", 1), "utf-8")
    with pytest.raises(deposit.DepositError, match=r"attributes\.csv, row \d+, column value"):
        deposit.build(tmp_path / "bundle", survey=survey)
    assert not (tmp_path / "bundle").exists()


def test_without_published_results_there_is_nothing_to_deposit(tmp_path):
    with pytest.raises(NothingPublishedError, match="sunatlas leaderboard"):
        deposit.build(tmp_path / "bundle", published=tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_a_column_nobody_described_does_not_go_out(tmp_path, monkeypatch):
    rows = [{**row, "mystery": 1} for row in Store(PUBLISHED).swept()]
    monkeypatch.setattr(Store, "swept", lambda _store: rows)
    with pytest.raises(ValueError, match="no description of column mystery"):
        deposit.build(tmp_path / "bundle")
    assert not (tmp_path / "bundle").exists()


def test_what_is_no_bundle_cannot_be_verified(tmp_path):
    with pytest.raises(deposit.DepositError, match="not a bundle"):
        deposit.verify(tmp_path)
