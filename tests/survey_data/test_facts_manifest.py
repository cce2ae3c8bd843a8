"""Facts that were changed by hand are taken over, or it is said why they cannot be."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from survey_data import facts_manifest
from survey_data.descriptor import DATA_DIRECTORY
from survey_data.problems import SurveyDataError


@pytest.fixture
def tables(tmp_path: Path) -> Path:
    copied = tmp_path / "tables"
    shutil.copytree(DATA_DIRECTORY, copied, ignore=shutil.ignore_patterns("*.py", "__pycache__"))
    return copied


def test_a_change_by_hand_is_named_and_taken_over(
    tables: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tables / "studies.csv"
    path.write_bytes(path.read_bytes() + b"\n")
    with pytest.raises(SurveyDataError, match=r"studies\.csv"):
        facts_manifest.require_unchanged(tables)
    renew = facts_manifest.renew
    monkeypatch.setattr(facts_manifest, "renew", lambda: renew(tables))
    path.write_bytes(path.read_bytes()[:-1] + b"broken,row\n")
    before = (tables / "checksums-sha256.txt").read_bytes()
    assert facts_manifest.main() == 1
    assert "studies.csv" in capsys.readouterr().err
    assert (tables / "checksums-sha256.txt").read_bytes() == before
    shutil.copyfile(DATA_DIRECTORY / "studies.csv", path)
    assert facts_manifest.main() == 0
    assert capsys.readouterr().err == ""


def test_a_sound_change_by_hand_is_taken_over_and_named(
    tables: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tables / "studies.csv"
    path.write_bytes(path.read_bytes().replace(b"sensor", b"sensos", 1))
    renew = facts_manifest.renew
    monkeypatch.setattr(facts_manifest, "renew", lambda: renew(tables))
    assert facts_manifest.main() == 0
    assert capsys.readouterr().err == "studies.csv taken over\n"
    facts_manifest.require_unchanged(tables)
