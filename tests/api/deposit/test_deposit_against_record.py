"""A bundle whose digests all fit is held against the facts, the record and the data sets."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from api.deposit import against_record, bundle
from api.deposit.crate import CRATE
from api.deposit.database import DATABASE
from api.deposit.package import DESCRIPTOR
from api.deposit.verification import verify
from files.checksums import CHECKSUMS, read_checksums, sha256, write_checksums

pytestmark = pytest.mark.slow  # a bundle and each comparison take seconds
FRAMES = ("pd-slit",)


def fit(folder: Path) -> None:
    """Make descriptor, crate and checksums fit what is there."""
    package = json.loads((folder / DESCRIPTOR).read_text("utf-8"))
    kept = [r for r in package["resources"] if (folder / r["path"]).is_file()]
    for resource in kept:
        path = folder / resource["path"]
        resource.update(bytes=path.stat().st_size, hash=f"sha256:{sha256(path)}")
    package["resources"] = kept
    (folder / DESCRIPTOR).write_text(json.dumps(package, indent=2, ensure_ascii=False) + "\n")
    (folder / CHECKSUMS).unlink(missing_ok=True)
    write_checksums(folder)
    listed = read_checksums(folder)
    crate = json.loads((folder / CRATE).read_text("utf-8"))
    known = {entity["@id"] for entity in crate["@graph"]}
    for name in listed.keys() - known - {CRATE}:
        crate["@graph"].append({"@id": name, "@type": "File"})
    for entity in crate["@graph"]:
        if entity["@id"] in listed and entity["@id"] != CRATE:
            size = (folder / entity["@id"]).stat().st_size
            entity.update(sha256=listed[entity["@id"]], contentSize=str(size))
    (folder / CRATE).write_text(json.dumps(crate, indent=2, ensure_ascii=False) + "\n")
    (folder / CHECKSUMS).unlink()
    write_checksums(folder)


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    return bundle.build(tmp_path_factory.mktemp("deposit") / "bundle", frames=FRAMES).directory


@pytest.fixture
def copy(built, tmp_path):
    return Path(shutil.copytree(built, tmp_path / "copy"))


def test_what_was_built_is_what_the_record_makes(built, copy):
    assert against_record.differences(built, frames=FRAMES, anew=False) == []
    fit(copy)  # lays nothing out in another way
    assert against_record.differences(copy, frames=FRAMES, anew=False) == []


def test_the_row_of_a_changed_number_is_named(copy):
    path = copy / "benchmark" / "scores.csv"
    lines = path.read_bytes().split(b"\n")
    lines[6] = lines[6].replace(b",81,80,", b",82,80,")
    path.write_bytes(b"\n".join(lines))
    fit(copy)
    forms = ["parquet/scores.parquet", DATABASE]
    assert [name for name, _ in verify(copy)] == forms
    (copy / DATABASE).unlink()
    bundle.write_other_forms(copy, json.loads((copy / DESCRIPTOR).read_text("utf-8")))
    fit(copy)
    assert verify(copy) == [], "the number is the same in every form"
    found = dict(against_record.differences(copy, frames=FRAMES, anew=False))
    assert found.keys() == {"benchmark/scores.csv", *forms}
    assert found["benchmark/scores.csv"].startswith("row 7 is")


def test_samples_that_are_missing_and_another_version_are_said(copy):
    ((name, text),) = against_record.differences(copy, frames=("pd-slit", "pd-orbit"))
    assert (name, text) == ("frames/pd-orbit", "missing")
    package = json.loads((copy / DESCRIPTOR).read_text("utf-8"))
    (copy / DESCRIPTOR).write_text(json.dumps({**package, "version": "9.9"}))
    ((name, text),) = against_record.differences(copy, frames=FRAMES)
    assert name == DESCRIPTOR
    assert text.startswith("of version '9.9'; here is ")
