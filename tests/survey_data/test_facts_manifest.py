"""Facts that were changed by hand are taken over, or it is said why they cannot be."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from survey_data import facts_manifest
from survey_data.descriptor import DATA_DIRECTORY
from survey_data.problems import SurveyDataError
from survey_data.table_records import read_records


@pytest.fixture
def tables(tmp_path: Path) -> Path:
    copied = tmp_path / "tables"
    shutil.copytree(DATA_DIRECTORY, copied, ignore=shutil.ignore_patterns("*.py", "__pycache__"))
    return copied


def test_a_changed_letter_and_a_cut_in_the_facts_are_refused(tables: Path) -> None:
    path = tables / "studies.csv"
    right = path.read_bytes()
    for wrong in (right.replace(b"sensor", b"sensos", 1), right[:-1]):
        path.write_bytes(wrong)
        with pytest.raises(SurveyDataError, match=r"studies\.csv: .*; restore it"):
            facts_manifest.require_unchanged(tables)
    path.write_bytes(right)
    facts_manifest.require_unchanged(tables)


def test_facts_that_are_not_valid_are_not_taken_over(tables: Path) -> None:
    path = tables / "studies.csv"
    text = path.read_text()
    path.write_text(text + text.splitlines()[1] + "\n")
    with pytest.raises(SurveyDataError, match="duplicate"):
        facts_manifest.renew(tables)
    assert facts_manifest.changes(tables) != []


@pytest.mark.parametrize(
    ("data", "row", "column", "said"),
    [
        (b"a,b\n1,2\n3,4", 3, "b", "the last line is cut off"),
        (b"a,b\n1," + b"x" * 5001 + b"\n", 2, "b", "longer than 5000 characters"),
        (b"a,b\n 1,2\n", 2, "a", "space around the value ' 1'"),
    ],
)
def test_damage_of_a_table_is_located(
    data: bytes, row: int, column: str, said: str, tmp_path: Path
) -> None:
    path = tmp_path / "given.csv"
    path.write_bytes(data)
    (problem,) = read_records(path, ["a", "b"]).problems
    assert (problem.file, problem.row, problem.column) == ("given.csv", row, column)
    assert said in problem.message


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


@pytest.mark.slow
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
