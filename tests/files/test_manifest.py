"""What was changed by hand is named by its file; what a command wrote passes, and after a kill."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

import survey_data
from files import manifest
from files.manifest import FILE, NEXT, differences, read_manifest, rewrite_manifest, write_recorded
from survey_data import facts_manifest
from survey_data.descriptor import DATA_DIRECTORY

TABLE = "name,size\none,1\ntwo,2\n"
NAMES = ("table.csv", "inner/said.json")
CHANGED = {"table.csv": TABLE.replace("two", "zwei"), "inner/said.json": "{}\n"}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    contents = {"table.csv": TABLE, "inner/said.json": '{"a": 1}\n'}
    assert write_recorded(tmp_path, contents, start=True)
    return tmp_path


def problems_of(folder: Path, **options: bool) -> list[str]:
    return [str(problem) for problem in differences(folder, NAMES, **options)]


def test_what_a_command_wrote_passes_and_sha256sum_says_the_same(folder: Path) -> None:
    assert problems_of(folder) == []
    assert sorted(p.name for p in folder.iterdir()) == [FILE, "inner", "table.csv"]
    assert not write_recorded(folder, {"table.csv": TABLE}), "unchanged"
    subprocess.run(["sha256sum", "--check", "--strict", FILE], cwd=folder, check=True)


def test_a_change_by_hand_is_named_and_stays_one_when_a_command_writes_others(folder: Path) -> None:
    (folder / "table.csv").write_text(TABLE.replace("one", "eins"))
    write_recorded(folder, {"inner/said.json": "{}\n"})
    assert problems_of(folder) == ["table.csv: the file is not as its command wrote it"]
    (folder / "inner/said.json").unlink()
    (folder / "table.csv").unlink()
    (folder / "table.csv").mkdir()
    (folder / "new.csv").write_text("a\n")
    assert [str(p) for p in differences(folder, (*NAMES, "new.csv"))] == [
        "inner/said.json: the file is missing",
        f"new.csv: the file is not in {FILE}: no command wrote it",
        "table.csv: expected a file, got a directory",
    ]


def test_a_missing_or_damaged_manifest_is_named(folder: Path) -> None:
    for text in ("[]", "0" * 64 + "  ../a\n", ("0" * 64 + "  a\n") * 2):
        (folder / FILE).write_text(text)
        (said,) = problems_of(folder)
        assert said.startswith(f"{FILE}, row")
        with pytest.raises(ValueError, match=FILE):
            write_recorded(folder, {"table.csv": TABLE})
    assert rewrite_manifest(folder, NAMES) == sorted(NAMES)
    assert rewrite_manifest(folder, NAMES) == []
    (folder / FILE).unlink()
    assert problems_of(folder) == []
    assert problems_of(folder, required=True) == [f"{FILE}: the file is missing"]
    (folder / FILE).mkdir()
    (said,) = problems_of(folder)
    assert said == f"{FILE}: cannot be read: Is a directory"


@pytest.mark.parametrize("killed_after", [0, 1, 2])
def test_what_a_kill_leaves_is_no_change_by_hand_and_the_next_run_ends_it(
    folder: Path, monkeypatch: pytest.MonkeyPatch, killed_after: int
) -> None:
    real, written = manifest.replace_file, []

    def dies(path: Path, content: str | bytes) -> bool:
        if path.name != NEXT and len(written) == killed_after:
            raise KeyboardInterrupt
        written.extend([path] if path.name != NEXT else [])
        return real(path, content)

    def ends(_folder: Path) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(manifest, "replace_file", dies)
    monkeypatch.setattr(manifest, "finish_interrupted_write", ends)
    with pytest.raises(KeyboardInterrupt):
        write_recorded(folder, CHANGED)
    monkeypatch.undo()
    assert (folder / NEXT).exists()
    assert problems_of(folder) == []
    manifest.finish_interrupted_write(folder)
    assert (folder / NEXT).exists() == (killed_after == 1), "some of both: run it again"
    assert problems_of(folder) == []
    write_recorded(folder, CHANGED)
    assert problems_of(folder) == []
    assert not (folder / NEXT).exists()
    assert (folder / "inner/said.json").read_text() == "{}\n"


def test_what_a_killed_command_took_away_the_next_need_not_take_away(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def dies(path: Path, content: str | bytes) -> bool:
        if path.name != NEXT:
            raise KeyboardInterrupt
        path.write_text(str(content))
        return True

    monkeypatch.setattr(manifest, "replace_file", dies)
    with pytest.raises(KeyboardInterrupt):
        write_recorded(folder, {"inner/said.json": None, "table.csv": "x\n"})
    monkeypatch.undo()
    assert not (folder / "inner/said.json").exists()
    write_recorded(folder, {"table.csv": "x\n"})
    assert not (folder / NEXT).exists()
    assert (read_manifest(folder) or {}).keys() == {"table.csv"}


def test_a_damaged_coming_manifest_does_not_undo_what_a_command_writes(folder: Path) -> None:
    (folder / NEXT).write_text("half of it")
    assert write_recorded(folder, CHANGED)
    assert not (folder / NEXT).exists()
    assert problems_of(folder) == []


def test_files_that_change_together_are_replaced_as_a_folder(folder: Path) -> None:
    before = (folder / "inner").stat().st_ino
    assert not write_recorded(folder, {"inner/said.json": '{"a": 1}\n'}, together="inner")
    assert (folder / "inner").stat().st_ino == before
    assert write_recorded(folder, {"inner/said.json": None, "inner/b.csv": "b\n"}, together="inner")
    assert [path.name for path in (folder / "inner").iterdir()] == ["b.csv"]
    assert differences(folder, ("table.csv", "inner/b.csv")) == []


@pytest.fixture
def facts(tmp_path: Path) -> Path:
    for name in (*facts_manifest.names(), FILE):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copyfile(DATA_DIRECTORY / name, tmp_path / name)
    return tmp_path


def test_a_changed_letter_and_a_cut_in_the_facts_are_refused(facts: Path) -> None:
    assert facts_manifest.changes() == []
    path = facts / "studies.csv"
    right = path.read_bytes()
    for wrong in (right.replace(b"sensor", b"sensos", 1), right[:-1]):
        path.write_bytes(wrong)
        with pytest.raises(survey_data.SurveyDataError, match=r"studies\.csv: .*; restore it"):
            facts_manifest.require_unchanged(facts)
    path.write_bytes(right)
    facts_manifest.require_unchanged(facts)


def test_facts_are_taken_over_only_when_they_are_valid(facts: Path) -> None:
    path = facts / "studies.csv"
    right = path.read_text()
    path.write_text(right.replace("sensor", "sensos", 1))
    assert facts_manifest.renew(facts) == ["studies.csv"]
    facts_manifest.require_unchanged(facts)
    path.write_text(right + right.splitlines()[1] + "\n")
    with pytest.raises(survey_data.SurveyDataError, match="duplicate"):
        facts_manifest.renew(facts)
    assert facts_manifest.changes(facts) != []
