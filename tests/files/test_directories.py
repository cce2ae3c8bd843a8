"""A set of files takes its place at once: killed anywhere, the old set is there or the new one."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from files import directories
from files.directories import (
    UnreplaceableDirectoryError,
    replace_in_directory,
    require_replaceable_directory,
)

OLD = {"a.json": b"old a", "a.h": b"old h", "a_no_code.txt": b"old text"}
NEW = {"a.json": b"new a", "a.h": b"new h", "a.c": b"new c"}
GONE = ("a_no_code.txt",)
FOREIGN = {"notes.txt": b"mine", "b.json": b"another name's"}

#: Kills itself at the nth step of the file system below a directory, each n in a child of its own.
KILLED = """
import json, os, signal, sys
from pathlib import Path
from files.directories import replace_in_directory

place, new, gone, ways = Path(sys.argv[1]), *map(json.loads, sys.argv[2:])
new = {name: text.encode() for name, text in new.items()}
root = str(place.parent)
left = None


def count(event, given):
    global left
    at_place = any(isinstance(one, (str, bytes)) and root in os.fsdecode(one) for one in given)
    if left is not None and (at_place or event.startswith("ctypes.call")):
        left -= 1
        if left == 0:
            os.kill(os.getpid(), signal.SIGKILL)


sys.addaudithook(count)
for number in ways:
    child = os.fork()
    if not child:
        left = number
        replace_in_directory(place, new, gone)
        os._exit(0)
    _, status = os.waitpid(child, 0)
    print(json.dumps([number, os.WIFSIGNALED(status)]), flush=True)
    sys.stdin.readline()
"""


def held(place: Path) -> dict[str, bytes]:
    """What a reader finds: every file below, by its path."""
    return {
        path.relative_to(place).as_posix(): path.read_bytes()
        for path in sorted(place.rglob("*"))
        if path.is_file()
    }


def filled(place: Path, files: dict[str, bytes]) -> None:
    place.mkdir(parents=True)
    for name, content in files.items():
        (place / name).write_bytes(content)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="kills children that it forks")
@pytest.mark.parametrize("exchanges", [True, False], ids=["exchange", "two renames"])
def test_every_kill_leaves_the_old_set_or_the_new_one(tmp_path: Path, exchanges: bool) -> None:
    place = tmp_path / "out"
    filled(place, {**OLD, **FOREIGN})
    (place / "sub").mkdir()
    (place / "sub" / "deep.txt").write_bytes(b"mine too")
    shutil.copytree(place, tmp_path / "kept")
    before = held(place)
    others = {name: content for name, content in before.items() if name not in OLD}
    after = {**NEW, **others}
    code = KILLED if exchanges else KILLED.replace(
        "sys.addaudithook", "import files.directories\n"
        "files.directories.exchange = lambda *_: False\nsys.addaudithook"
    )  # fmt: skip
    given = json.dumps({name: content.decode() for name, content in NEW.items()})
    kills, seen = 0, {"old": 0, "new": 0, "none": 0}
    command = [sys.executable, "-c", code, str(place), given, json.dumps(GONE)]
    with subprocess.Popen(
        [*command, json.dumps(list(range(1, 400)))],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    ) as run:  # fmt: skip
        assert run.stdin is not None
        assert run.stdout is not None
        for line in run.stdout:
            _, killed = json.loads(line)
            found = held(place) if place.exists() else None
            assert found in (None, before, after)
            state = "none" if found is None else "old" if found == before else "new"
            if not killed:
                assert state == "new"
                break
            kills, seen[state] = kills + 1, seen[state] + 1
            if state != "old":  # as it was, for the next kill
                shutil.rmtree(place, ignore_errors=True)
                shutil.copytree(tmp_path / "kept", place)
            run.stdin.write("\n")
            run.stdin.flush()
        run.kill()
    assert kills >= 30
    assert seen["old"] > 0
    assert seen["new"] > 0
    assert (seen["none"] > 0) == (not exchanges)


def test_what_a_killed_writer_left_is_gone_after_the_next(tmp_path: Path) -> None:
    place = tmp_path / "out"
    left = tmp_path / ".out.1-00000000.sunatlas"
    (left / "new").mkdir(parents=True)
    replace_in_directory(place, NEW)
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
    assert held(place) == NEW


def test_an_error_leaves_everything_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    place = tmp_path / "out"
    filled(place, OLD)

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space left on device"):
        replace_in_directory(place, NEW, GONE)
    assert held(place) == OLD
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_modes_and_links_of_others_stay(tmp_path: Path) -> None:
    place = tmp_path / "out"
    filled(place, OLD)
    place.chmod(0o750)
    (place / "a.json").chmod(0o640)
    (place / "link").symlink_to("a.json")
    number = (place / "a_no_code.txt").stat().st_ino
    replace_in_directory(place, {"a.json": b"new"})
    assert place.stat().st_mode & 0o777 == 0o750
    assert (place / "a.json").stat().st_mode & 0o777 == 0o640
    assert (place / "link").readlink() == Path("a.json")
    assert (place / "a_no_code.txt").stat().st_ino == number


def test_a_link_to_a_directory_stays_one(tmp_path: Path) -> None:
    filled(tmp_path / "real", OLD)
    (tmp_path / "out").symlink_to("real")
    replace_in_directory(tmp_path / "out", NEW)
    assert (tmp_path / "out").is_symlink()
    assert held(tmp_path / "real") == {**OLD, **NEW}


def test_what_cannot_be_replaced_as_a_whole_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "work").mkdir()
    monkeypatch.chdir(tmp_path / "work")
    wrong = {
        "file": "this is a file",
        ".": "this is the current directory",
        "..": "this is above the current one",
        "/": "this is the root of a file system|this is above",
    }
    for name, said in wrong.items():
        place = Path(name) if name in (".", "..", "/") else tmp_path / name
        with pytest.raises(UnreplaceableDirectoryError, match=said):
            require_replaceable_directory(place)
    with pytest.raises((UnreplaceableDirectoryError, OSError)):
        replace_in_directory(tmp_path / "loop", NEW)
    monkeypatch.setattr(directories, "MOST_OTHERS", 2)
    filled(tmp_path / "full", OLD)
    with pytest.raises(UnreplaceableDirectoryError, match="at most 2 files"):
        replace_in_directory(tmp_path / "full", NEW)
    assert held(tmp_path / "full") == OLD
