"""A bundle whose digests all fit is held against the facts, the record and the data sets."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from api.deposit import against_record, bundle
from api.deposit.package import DESCRIPTOR

pytestmark = pytest.mark.slow  # a bundle and each comparison take seconds
FRAMES = ("pd-slit",)


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    return bundle.build(tmp_path_factory.mktemp("deposit") / "bundle", frames=FRAMES).directory


@pytest.fixture
def copy(built, tmp_path):
    return Path(shutil.copytree(built, tmp_path / "copy"))


def test_what_was_built_is_what_the_record_makes_and_a_changed_row_is_named(built, copy):
    assert against_record.differences(built, frames=FRAMES, anew=False) == []
    path = copy / "benchmark" / "scores.csv"
    lines = path.read_bytes().split(b"\n")
    lines[6] = lines[6].replace(b",81,80,", b",82,80,")
    path.write_bytes(b"\n".join(lines))
    found = dict(against_record.differences(copy, frames=FRAMES, anew=False))
    assert found["benchmark/scores.csv"].startswith("row 7 is")


def test_samples_that_are_missing_and_another_version_are_said(copy):
    ((name, text),) = against_record.differences(copy, frames=("pd-slit", "pd-orbit"))
    assert (name, text) == ("frames/pd-orbit", "missing")
    package = json.loads((copy / DESCRIPTOR).read_text("utf-8"))
    (copy / DESCRIPTOR).write_text(json.dumps({**package, "version": "9.9"}))
    ((name, text),) = against_record.differences(copy, frames=FRAMES)
    assert name == DESCRIPTOR
    assert text.startswith("of version '9.9'; here is ")
