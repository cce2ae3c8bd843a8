"""What was changed by hand is named by its file; what a command wrote passes, and after a kill."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import pytest

from files import manifest
from files.manifest import FILE, NEXT, differences, rewrite_manifest, write_recorded

NAMES = ("table.csv", "inner/said.json")
CHANGED = {"table.csv": "name\nzwei\n", "inner/said.json": None, "inner/new.json": "{}\n"}


class KilledError(BaseException):
    """Stands for a kill."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    assert write_recorded(tmp_path, {"table.csv": "name\n", "inner/said.json": "1\n"}, start=True)
    return tmp_path


def test_what_a_command_wrote_passes_and_sha256sum_says_the_same(folder: Path) -> None:
    assert differences(folder, NAMES) == []
    assert not write_recorded(folder, {"table.csv": "name\n"}), "unchanged"
    assert sorted(p.name for p in folder.iterdir()) == [FILE, "inner", "table.csv"]
    subprocess.run(["sha256sum", "--check", "--strict", FILE], cwd=folder, check=True)


def test_a_change_by_hand_is_named_and_stays_one_when_a_command_writes_others(folder: Path) -> None:
    (folder / "table.csv").write_text("other\n")
    write_recorded(folder, {"inner/said.json": "{}\n"})
    ((name, said),) = differences(folder, NAMES)
    assert name == "table.csv"
    assert said.startswith("SHA-256 is ")
    (folder / "inner/said.json").unlink()
    (folder / "table.csv").unlink()
    (folder / "table.csv").mkdir()
    (folder / "new.csv").write_text("a\n")
    assert differences(folder, (*NAMES, "new.csv")) == [
        ("inner/said.json", "listed but missing"),
        ("new.csv", "not listed"),
        ("table.csv", "not a regular file"),
    ]


def test_a_missing_or_damaged_list_is_named(folder: Path) -> None:
    for text in ("[]", "0" * 64 + "  ../a\n", ("0" * 64 + "  a\n") * 2):
        (folder / FILE).write_text(text)
        ((name, said),) = differences(folder, NAMES)
        assert name == FILE
        assert said.startswith("line ")
        with pytest.raises(ValueError, match=FILE):
            write_recorded(folder, {"table.csv": "x\n"})
    assert rewrite_manifest(folder, NAMES) == sorted(NAMES)
    (folder / FILE).unlink()
    assert differences(folder, NAMES) == []
    assert differences(folder, NAMES, required=True) == [(FILE, "missing")]


@pytest.mark.parametrize("steps", range(5))
def test_what_a_kill_leaves_is_no_change_by_hand_and_the_next_run_ends_it(
    folder: Path, monkeypatch: pytest.MonkeyPatch, steps: int
) -> None:
    """At any of the steps: the list that is to come, two files written, one removed, the list."""
    left = iter(range(steps))
    acts = (manifest, "replace_file"), (Path, "unlink"), (manifest, "finish_interrupted_write")
    for owner, name in acts:
        real = getattr(owner, name)

        def step(*given: Any, real: Any = real, **named: Any) -> Any:
            if next(left, None) is None:
                raise KilledError
            return real(*given, **named)

        monkeypatch.setattr(owner, name, step)
    with pytest.raises(KilledError):
        write_recorded(folder, CHANGED)
    monkeypatch.undo()
    there = [name for name in (*NAMES, "inner/new.json") if (folder / name).exists()]
    assert differences(folder, there) == []
    manifest.finish_interrupted_write(folder)
    assert (folder / NEXT).exists() == (steps in {2, 3}), "some of both: run it again"
    write_recorded(folder, CHANGED)
    assert differences(folder, ("table.csv", "inner/new.json")) == []
    assert sorted(p.name for p in folder.rglob("*")) == [FILE, "inner", "new.json", "table.csv"]


def test_a_damaged_coming_list_does_not_undo_what_a_command_writes(folder: Path) -> None:
    (folder / NEXT).write_text("half of it")
    assert write_recorded(folder, CHANGED)
    assert not (folder / NEXT).exists()
    assert differences(folder, ("table.csv", "inner/new.json")) == []


def test_files_that_change_together_are_replaced_as_a_folder(folder: Path) -> None:
    before = (folder / "inner").stat().st_ino
    assert not write_recorded(folder, {"inner/said.json": "1\n"}, together="inner")
    assert (folder / "inner").stat().st_ino == before
    assert write_recorded(folder, {"inner/said.json": None, "inner/b.csv": "b\n"}, together="inner")
    assert [path.name for path in (folder / "inner").iterdir()] == ["b.csv"]
    assert differences(folder, ("table.csv", "inner/b.csv")) == []
