"""What a killed process leaves is removed by the next one; what a living one makes is not."""

from __future__ import annotations

import subprocess
import sys
import threading
from pathlib import Path

import pytest

import survey_data
from files import temporary
from files.atomic import replace_file
from files.locks import lock_path
from files.temporary import remove_stale_files, temporary_directory, temporary_directory_beside

ROOT = Path(survey_data.__file__).parent.parent
MAKING = """
import os, sys
from pathlib import Path
from files.temporary import temporary_directory_beside, temporary_file_beside, temporary_directory
here = Path(sys.argv[1])
with temporary_directory_beside(here / "out") as out, \\
        temporary_file_beside(here / "table.csv") as file, temporary_directory() as temporary:
    for path in (out / "half", file, temporary / "half"):
        path.write_text("half")
    print("made", flush=True)
    sys.stdin.read()
    os._exit(9)
"""


def names(directory: Path) -> list[str]:
    return sorted(entry.name for entry in directory.iterdir())


@pytest.fixture
def maker(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """A process that is making two things in tmp_path and one among temporary files."""
    (tmp_path / "temporary").mkdir()
    monkeypatch.setenv("TMPDIR", str(tmp_path / "temporary"))
    monkeypatch.setattr(temporary.tempfile, "tempdir", None)
    command = [sys.executable, "-c", MAKING, str(tmp_path)]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, cwd=ROOT, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "made\n"
        yield process
        process.kill()


def test_stale_files_of_a_dead_process_are_removed_and_a_living_one_keeps_its_own(
    tmp_path: Path, maker: subprocess.Popen[str]
) -> None:
    made = [name for name in names(tmp_path) if name != "temporary"]
    assert len(made) == 4, "two, and a lock of each"
    assert all(f".{maker.pid}-" in name for name in made), "people see whose it is"
    remove_stale_files(tmp_path)
    with temporary_directory():
        assert len(names(tmp_path / "temporary")) == 4
    assert [name for name in names(tmp_path) if name != "temporary"] == made
    maker.kill()
    maker.wait()
    remove_stale_files(tmp_path, "out")
    assert [name[:11] for name in names(tmp_path)] == ["..table.csv", ".table.csv.", "temporary"]
    replace_file(tmp_path / "table.csv", "whole")
    with temporary_directory() as mine:
        assert names(tmp_path / "temporary") == [lock_path(mine).name, mine.name]
    assert names(tmp_path) == ["table.csv", "temporary"]
    assert names(tmp_path / "temporary") == []


def test_a_write_of_what_is_there_already_removes_stale_files_too(
    tmp_path: Path, maker: subprocess.Popen[str]
) -> None:
    (tmp_path / "table.csv").write_text("whole")
    maker.kill()
    maker.wait()
    assert not replace_file(tmp_path / "table.csv", "whole")
    assert [name[:5] for name in names(tmp_path)] == ["..out", ".out.", "table", "tempo"]


def test_what_merely_looks_alike_stays(tmp_path: Path) -> None:
    kept = [".out", ".out.1-abc.sunatlas", "out.12-0123abcd.sunatlas", ".sunatlas"]
    for name in kept:
        (tmp_path / name).write_text("somebody's")
    (tmp_path / ".out.12-0123abcd.sunatlas").write_text("left")
    (tmp_path / "..out.13-0123abcd.sunatlas.lock").write_text("13\n")
    remove_stale_files(tmp_path)
    assert names(tmp_path) == sorted(kept)
    remove_stale_files(tmp_path / "missing")


def test_many_that_write_and_tidy_at_once_keep_their_own(tmp_path: Path) -> None:
    """A name is locked before anything has it: nobody takes what is being made for stale."""

    def work() -> None:
        for _ in range(20):
            with temporary_directory_beside(tmp_path / "out") as path:
                remove_stale_files(tmp_path)
                (path / "mine").write_text("mine")
                made.append(path.stat().st_mode & 0o777)

    made: list[int] = []
    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert made == [0o700] * 80
    assert names(tmp_path) == []


def test_a_symbolic_link_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "precious").mkdir()
    (tmp_path / "precious" / "file").write_text("kept")
    (tmp_path / ".out.12-0123abcd.sunatlas").symlink_to("precious")
    remove_stale_files(tmp_path)
    assert (tmp_path / "precious" / "file").read_text() == "kept"
