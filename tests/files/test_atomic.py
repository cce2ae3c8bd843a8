"""Files and directories are written whole or not at all, whatever goes wrong between."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

import survey_data
from files import atomic
from files.atomic import (
    UnreplaceableError,
    replace_all,
    replace_file,
    replace_in_directory,
    require_replaceable_directory,
    sweep,
    temporary_directory,
    temporary_directory_beside,
)

ROOT = Path(survey_data.__file__).parent.parent


def names(directory: Path) -> list[str]:
    return sorted(entry.name for entry in directory.iterdir())


def killed(code: str, *arguments: object) -> None:
    """Run code that ends its process with `os._exit(9)`: no handler of ours runs."""
    command = [sys.executable, "-c", code, *map(str, arguments)]
    assert subprocess.run(command, check=False, cwd=ROOT, timeout=600).returncode == 9


def full(*_: object) -> None:
    raise OSError(errno.ENOSPC, "No space left on device")


def test_text_and_bytes_are_written_as_they_are(tmp_path: Path) -> None:
    path = tmp_path / "made" / "on" / "the" / "way.csv"
    assert replace_file(path, "é\r\n\n")
    assert path.read_bytes() == "é\r\n\n".encode()
    assert not replace_file(path, "é\r\n\n"), "the same content is not written again"
    assert replace_file(path, b"\x00\xff")
    assert path.read_bytes() == b"\x00\xff"
    assert names(path.parent) == ["way.csv"]


def test_a_new_file_has_the_umask_s_permissions_and_an_earlier_one_keeps_its_own(
    tmp_path: Path,
) -> None:
    path = tmp_path / "file"
    replace_file(path, "first")
    umask = os.umask(0)
    os.umask(umask)
    assert path.stat().st_mode & 0o777 == 0o666 & ~umask
    path.chmod(0o640)
    replace_file(path, "second")
    assert path.stat().st_mode & 0o777 == 0o640


def test_content_is_on_disk_before_it_takes_its_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    steps: list[str] = []
    fsync, replace = os.fsync, Path.replace

    def synced(descriptor: int) -> None:
        steps.append(f"synced {os.fstat(descriptor).st_size}")
        fsync(descriptor)

    def replaced(self: Path, target: Path) -> Path:
        steps.append("replaced")
        return replace(self, target)

    monkeypatch.setattr(os, "fsync", synced)
    monkeypatch.setattr(Path, "replace", replaced)
    replace_file(tmp_path / "file", "seven b")
    assert steps == ["synced 7", "replaced"]


def test_a_full_disk_leaves_the_earlier_content_and_is_told_with_the_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def write() -> None:
        with replace_all(tmp_path / "out") as (made,):
            made.mkdir()
            (made / "sub" / "file").write_text("")

    replace_file(tmp_path / "file", "old")
    replace_in_directory(tmp_path / "out", {"a": b"old"})
    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space left") as caught:
        replace_file(tmp_path / "file", "new")
    assert caught.value.filename == str(tmp_path / "file")
    with pytest.raises(OSError, match="No space left") as caught:
        replace_in_directory(tmp_path / "out", {"a": b"new", "b": b"new"})
    assert caught.value.filename == str(tmp_path / "out")
    with pytest.raises(FileNotFoundError) as missing:
        write()
    assert missing.value.filename == str(tmp_path / "out" / "sub" / "file")
    with pytest.raises(FileExistsError, match="file"):
        replace_file(tmp_path / "file" / "inside", "new")
    assert names(tmp_path) == ["file", "out"]
    assert (tmp_path / "file").read_text() == (tmp_path / "out" / "a").read_text() == "old"


@pytest.fixture
def earlier(tmp_path: Path) -> Path:
    """A directory and a file that are there already."""
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "held").write_text("old")
    (tmp_path / "out.zip").write_text("old zip")
    return tmp_path


def renew(here: Path) -> None:
    with replace_all(here / "out", here / "out.zip") as (out, packed):
        out.mkdir()
        (out / "new").write_text("new")
        packed.write_text("new zip")


def test_a_directory_and_a_file_take_their_places_and_an_error_changes_nothing(
    earlier: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail() -> None:
        with replace_all(earlier / "out") as (out,):
            out.mkdir()
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fail()
    rename = Path.rename

    def refused(self: Path, target: Path) -> Path:
        if target == earlier / "out" and self.parent != earlier:
            raise PermissionError(errno.EACCES, "Permission denied")
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", refused)
    with pytest.raises(PermissionError):
        renew(earlier)
    monkeypatch.undo()
    assert names(earlier) == ["out", "out.zip"]
    assert names(earlier / "out") == ["held"]
    renew(earlier)
    assert names(earlier) == ["out", "out.zip"]
    assert names(earlier / "out") == ["new"]
    assert (earlier / "out.zip").read_text() == "new zip"


@pytest.mark.parametrize("step", [1, 2, 3, 4])
def test_a_kill_at_any_step_loses_nothing_and_the_next_run_ends_well(
    step: int, earlier: Path
) -> None:
    code = (
        "import os, sys; from pathlib import Path\n"
        "sys.path.insert(0, 'tests/files')\n"
        "import shutil, test_atomic as tests\n"
        "left = int(sys.argv[2])\n"
        "def dying(real):\n"
        "    def step(*given, **named):\n"
        "        global left\n"
        "        left -= 1\n"
        "        return real(*given, **named) if left else os._exit(9)\n"
        "    return step\n"
        "Path.rename, Path.replace = dying(Path.rename), dying(Path.replace)\n"
        "atomic = tests.atomic\n"
        "atomic.restore = lambda _: None\n"
        "shutil.rmtree = dying(shutil.rmtree)\n"
        "tests.renew(Path(sys.argv[1]))\n"
    )
    killed(code, earlier, step)
    aside = earlier / ".out.before"
    kept = [names(path) for path in (aside, earlier / "out") if path.exists()]
    assert ["held"] in kept or ["new"] in kept
    if not (earlier / "out").exists():
        assert kept == [["held"]], "moved aside, and put back by the next"
        with replace_all(earlier / "out", earlier / "more") as (out, more):
            assert names(earlier / "out") == ["held"]
            out.mkdir()
            more.touch()
    renew(earlier)
    assert names(earlier / "out") == ["new"]
    assert not aside.exists()


FILES = {"a.json": b"new a", "a.c": b"new c"}


def test_other_files_of_a_directory_stay_with_their_modes_and_links(tmp_path: Path) -> None:
    place = tmp_path / "real"
    replace_in_directory(place, {"a.json": b"old", "gone": b"old", "notes.txt": b"mine"})
    (place / "sub").mkdir()
    (place / "sub" / "gone").write_text("mine too")
    (place / "link").symlink_to("a.json")
    place.chmod(0o750)
    (place / "a.json").chmod(0o640)
    (tmp_path / "out").symlink_to("real")
    replace_in_directory(tmp_path / "out", FILES, gone=("gone",))
    assert (tmp_path / "out").is_symlink()
    assert names(place) == ["a.c", "a.json", "link", "notes.txt", "sub"]
    assert names(place / "sub") == ["gone"]
    assert {name: (place / name).read_bytes() for name in FILES} == FILES
    assert place.stat().st_mode & 0o777 == 0o750
    assert (place / "a.json").stat().st_mode & 0o777 == 0o640
    assert (place / "link").readlink() == Path("a.json")


def test_what_cannot_be_replaced_as_a_whole_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "work").mkdir()
    monkeypatch.chdir(tmp_path / "work")
    wrong = {
        tmp_path / "file": "this is a file",
        Path(): "this is the current directory or above it",
        Path(".."): "this is the current directory or above it",
        Path("/"): "the root of a file system",
    }
    for place, said in wrong.items():
        with pytest.raises(UnreplaceableError, match=said):
            require_replaceable_directory(place)
    with pytest.raises((UnreplaceableError, OSError)):
        replace_in_directory(tmp_path / "loop", FILES)
    with pytest.raises(UnreplaceableError, match="cannot be replaced"), replace_all(Path("/")):
        pytest.fail("it would be replaced")
    monkeypatch.setattr(atomic, "MOST_OTHERS", 1)
    (tmp_path / "held").mkdir()
    for name in ("a", "b"):
        (tmp_path / "held" / name).write_text("")
    with pytest.raises(UnreplaceableError, match="at most 1 files"):
        replace_in_directory(tmp_path / "held", FILES)
    assert names(tmp_path / "held") == ["a", "b"]


def test_what_a_kill_left_a_day_ago_is_removed_and_nothing_else(tmp_path: Path) -> None:
    (tmp_path / "kept").mkdir()
    (tmp_path / ".out.link.sunatlas").symlink_to("kept")
    old = time.time() - 90_000
    for name in (".out.abc.sunatlas", ".table.csv.abc.sunatlas", ".out.before", "out.sunatlas"):
        (tmp_path / name).mkdir()
        os.utime(tmp_path / name, (old, old))
    (tmp_path / ".out.new.sunatlas").mkdir()
    expected = set(names(tmp_path)) - {".out.abc.sunatlas"}
    with temporary_directory_beside(tmp_path / "out") as made:
        assert made.stat().st_mode & 0o777 == 0o700
        assert set(names(tmp_path)) == {*expected, made.name}
    assert set(names(tmp_path)) == expected


def test_directories_of_processes_that_are_gone_are_swept_and_no_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    code = (
        "import os, sys, tempfile\nfrom pathlib import Path\nfrom files import atomic\n"
        "tempfile.tempdir = sys.argv[1]\nwith atomic.temporary_directory() as made:\n"
        " (made / 'bench.csv').write_bytes(b'x')\n os._exit(9)"
    )
    killed(code, tmp_path)
    (left,) = tmp_path.iterdir()
    others = [tmp_path / "sunatlas-a", tmp_path / "b.sunatlas", tmp_path / "sunatlas-c.sunatlas"]
    for path in others[:2]:
        path.mkdir()
    others[2].symlink_to(tmp_path / "b.sunatlas", target_is_directory=True)
    sweep()
    assert left.is_dir(), "just made, it may not be locked yet"
    monkeypatch.setattr(atomic, "_UNLOCKED_S", -1.0)
    with temporary_directory() as held:
        sweep()
        assert not left.exists()
        assert held.is_dir()
        assert all(os.path.lexists(path) for path in others)
