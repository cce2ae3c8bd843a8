"""Files and directories are written whole or not at all, whatever goes wrong between."""

from __future__ import annotations

import errno
import itertools
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import survey_data
from files import atomic
from files.atomic import FileSystemRootError, replace_all, replace_file

ROOT = Path(survey_data.__file__).parent.parent


def names(directory: Path) -> list[str]:
    return sorted(entry.name for entry in directory.iterdir())


def killed(code: str, *arguments: object) -> None:
    """Run code that ends its process with `os._exit(9)`: no handler of ours runs."""
    command = [sys.executable, "-c", code, *map(str, arguments)]
    assert subprocess.run(command, check=False, cwd=ROOT, timeout=600).returncode == 9


def test_text_and_bytes_are_written_as_they_are(tmp_path: Path) -> None:
    path = tmp_path / "made" / "on" / "the" / "way.csv"
    assert replace_file(path, "é\r\n\n")
    assert path.read_bytes() == "é\r\n\n".encode()
    assert not replace_file(path, "é\r\n\n"), "the same content is not written again"
    assert replace_file(path, b"\x00\xff")
    assert path.read_bytes() == b"\x00\xff"
    assert names(path.parent) == ["way.csv"]


def test_a_new_file_may_be_read_by_all_and_an_earlier_one_keeps_its_permissions(
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


@pytest.mark.parametrize("step", ["fsync", "replace"])
def test_a_failed_write_leaves_the_earlier_file_and_no_temporary_one(
    step: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "file"
    replace_file(path, "old")

    def refuse(*_: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr(os if step == "fsync" else Path, step, refuse)
    with pytest.raises(OSError, match="disk full"):
        replace_file(path, "new")
    assert path.read_text() == "old"
    assert names(tmp_path) == ["file"]


def test_a_kill_before_the_rename_leaves_the_earlier_file(tmp_path: Path) -> None:
    path = tmp_path / "file"
    replace_file(path, "old")
    code = (
        "import os, sys; from pathlib import Path\n"
        "from files.atomic import replace_file\n"
        "Path.replace = lambda *_: os._exit(9)\n"
        "replace_file(Path(sys.argv[1]), 'new')\n"
    )
    killed(code, path)
    assert path.read_text() == "old"


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


def test_a_place_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no directory")
    with pytest.raises(FileExistsError, match="file"):
        replace_file(tmp_path / "file" / "inside", "new")
    with pytest.raises(FileExistsError, match="file"), replace_all(tmp_path / "file" / "out"):
        pytest.fail("nothing can be made there")


@pytest.mark.parametrize("writing", ["replace_file(path, 'new')", "replace_all(path).__enter__()"])
def test_a_directory_without_permission_to_write_is_refused(writing: str, tmp_path: Path) -> None:
    held = tmp_path / "held"
    held.mkdir()
    held.chmod(0o500)
    code = (
        "import os, sys; from pathlib import Path\n"
        "from files.atomic import FileSystemRootError, replace_file, replace_all\n"
        "path = Path(sys.argv[1]) / 'out'\n"
        "if os.geteuid() == 0: os.setuid(65534)  # root writes everywhere\n"
        f"try: {writing}\n"
        "except PermissionError: os._exit(9)\n"
    )
    killed(code, held)
    held.chmod(0o700)
    assert names(held) == []


@pytest.fixture
def earlier(tmp_path: Path) -> Path:
    """A directory and a file beside it, as an earlier run left them."""
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "held").write_text("old")
    (tmp_path / "out.zip").write_text("old zip")
    return tmp_path


def untouched(directory: Path) -> bool:
    return (
        names(directory) == ["out", "out.zip"]
        and names(directory / "out") == ["held"]
        and (directory / "out" / "held").read_text() == "old"
        and (directory / "out.zip").read_text() == "old zip"
    )


def renew(directory: Path) -> None:
    with replace_all(directory / "out", directory / "out.zip") as (out, zipped):
        out.mkdir()
        (out / "new").write_text("new")
        zipped.write_text("new zip")


@pytest.mark.parametrize("occupied", [True, False])
def test_directory_and_file_take_their_places(
    occupied: bool, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    if occupied:
        request.getfixturevalue("earlier")
    renew(tmp_path)
    assert names(tmp_path) == ["out", "out.zip"]
    assert names(tmp_path / "out") == ["new"]
    assert (tmp_path / "out.zip").read_text() == "new zip"


def test_an_error_while_making_leaves_what_was_there(earlier: Path) -> None:
    def half_way() -> None:
        with replace_all(earlier / "out") as (out,):
            out.mkdir()
            (out / "new").write_text("new")
            raise RuntimeError("half way")

    with pytest.raises(RuntimeError, match="half way"):
        half_way()
    assert untouched(earlier)


#: What puts new things in place, and how many of its steps `renew` takes on `earlier`.
WAYS = [("exchange", 2), ("one at a time", 3)]
STEPS = [(way, step) for way, steps in WAYS for step in range(1, steps + 1)]


def counted(
    way: str, act: Callable[[int], None], patch: Callable[[object, str, object], None]
) -> None:
    """Call `act` with its number before every step that puts something in its place."""
    calls = itertools.count(1)

    def counting(step):
        def stepping(one, other):
            act(next(calls))
            return step(one, other)

        return stepping

    if way == "exchange":
        patch(atomic, "exchange", counting(atomic.exchange))
    else:
        patch(atomic, "exchange", lambda _one, _other: False)
        patch(Path, "rename", counting(Path.rename))
        patch(Path, "replace", counting(Path.replace))


@pytest.mark.parametrize(("way", "failing"), STEPS)
def test_whichever_step_fails_everything_is_put_back(
    way: str, failing: int, earlier: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(step: int) -> None:
        if step == failing:
            raise PermissionError(13, "Permission denied")

    counted(way, refuse, monkeypatch.setattr)
    with pytest.raises(PermissionError):
        renew(earlier)
    assert untouched(earlier)


def test_a_file_system_without_an_exchange_gives_the_same(
    earlier: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nested directories, an entry of another kind, and one that is no longer wanted."""
    monkeypatch.setattr(atomic, "exchange", lambda _one, _other: False)
    for name in ("deep/kept", "deep/gone", "was-directory/inside"):
        (earlier / "out" / name).parent.mkdir(exist_ok=True)
        (earlier / "out" / name).write_text("old")
    with replace_all(earlier / "out") as (out,):
        (out / "deep").mkdir(parents=True)
        (out / "deep" / "kept").write_text("new")
        (out / "was-directory").write_text("new")
    found = {p.relative_to(earlier): p.read_text() for p in earlier.rglob("*") if p.is_file()}
    assert found == {
        Path("out.zip"): "old zip",
        Path("out/deep/kept"): "new",
        Path("out/was-directory"): "new",
    }


@pytest.mark.parametrize(("way", "step"), [(way, s) for way, n in WAYS for s in range(1, n + 2)])
def test_a_kill_at_any_step_leaves_an_out_and_the_next_run_nothing_else(
    way: str, step: int, earlier: Path
) -> None:
    code = (
        "import os, sys; from pathlib import Path\n"
        "sys.path.insert(0, 'tests/files')\n"
        "import shutil, test_atomic as tests\n"
        "here, way, last = Path(sys.argv[1]), sys.argv[2], int(sys.argv[3])\n"
        "tests.counted(way, lambda step: os._exit(9) if step == last else None, setattr)\n"
        "shutil.rmtree = lambda *_, **__: os._exit(9)\n"  # a step later: all is in place
        "tests.renew(here)\n"
    )
    killed(code, earlier, way, step)
    held = names(earlier / "out")
    assert held in (
        [["held"], ["new"]] if way == "exchange" else [["held"], ["held", "new"], ["new"]]
    )
    assert (earlier / "out.zip").read_text() in ("old zip", "new zip")
    assert len(names(earlier)) == 5, "the killed run left its temporary directory and two locks"
    renew(earlier)
    assert names(earlier) == ["out", "out.zip"]
    assert names(earlier / "out") == ["new"]
    assert (earlier / "out.zip").read_text() == "new zip"


def test_a_new_file_has_the_permissions_that_the_umask_leaves(tmp_path: Path) -> None:
    code = (
        "import os, sys; from pathlib import Path\n"
        "from files.atomic import FileSystemRootError, replace_file, replace_all\n"
        "os.umask(0o077)\n"
        "here = Path(sys.argv[1])\n"
        "replace_file(here / 'deep' / 'file', 'mine')\n"
        "with replace_all(here / 'out') as (out,): out.mkdir(); (out / 'held').write_text('mine')\n"
        "os._exit(9)\n"
    )
    killed(code, tmp_path)
    found = {str(p.relative_to(tmp_path)): p.stat().st_mode & 0o777 for p in tmp_path.rglob("*")}
    assert found == {"deep": 0o700, "deep/file": 0o600, "out": 0o700, "out/held": 0o600}


def test_a_full_disk_is_told_with_the_name_of_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space left") as caught:
        replace_file(tmp_path / "file", "new")
    assert caught.value.filename == str(tmp_path / "file")
    with pytest.raises(OSError, match="No space left") as caught, replace_all(tmp_path / "out"):
        full()
    assert caught.value.filename == str(tmp_path / "out")
    assert names(tmp_path) == []


def interrupted(out: Path, beside: Path | None = None) -> None:
    with replace_all(out) as (made,):
        made.mkdir()
        if beside is not None:
            beside.write_text("theirs")
        raise KeyboardInterrupt


def test_directories_above_are_made_and_go_again_after_an_error(tmp_path: Path) -> None:
    out = tmp_path / "a" / "b" / "out"
    with pytest.raises(KeyboardInterrupt):
        interrupted(out)
    assert list(tmp_path.iterdir()) == []
    with replace_all(out) as (made,):
        made.write_text("whole")
    assert out.read_text() == "whole"


def test_a_directory_above_that_somebody_uses_stays_after_an_error(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        interrupted(tmp_path / "a" / "b" / "out", beside=tmp_path / "a" / "theirs")
    assert [path.name for path in (tmp_path / "a").iterdir()] == ["theirs"]


@pytest.mark.parametrize("path", [Path("/"), Path("/proc")])
def test_the_root_of_a_file_system_is_not_replaced(path: Path) -> None:
    if not path.is_mount():
        pytest.skip(f"{path} is no mount here")
    with pytest.raises(FileSystemRootError, match="cannot be replaced"), replace_all(path):
        pytest.fail("it would be replaced")


def test_an_error_of_a_file_being_made_names_its_place(tmp_path: Path) -> None:
    def write() -> None:
        with replace_all(tmp_path / "out") as (made,):
            made.mkdir()
            (made / "sub" / "file").write_text("")

    with pytest.raises(FileNotFoundError) as raised:
        write()
    assert raised.value.filename == str(tmp_path / "out" / "sub" / "file")
