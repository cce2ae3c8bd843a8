"""Files and directories are written whole or not at all, whatever goes wrong between."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import survey_data
from survey_data.whole_files import replace_file, replacing

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
    assert path.stat().st_mode & 0o777 == 0o644
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
        "from survey_data.whole_files import replace_file\n"
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
    with pytest.raises(FileNotFoundError, match="missing"), replacing(tmp_path / "missing" / "out"):
        pytest.fail("nothing can be made there")


@pytest.mark.parametrize("writing", ["replace_file(path, 'new')", "replacing(path).__enter__()"])
def test_a_directory_without_permission_to_write_is_refused(writing: str, tmp_path: Path) -> None:
    held = tmp_path / "held"
    held.mkdir()
    held.chmod(0o500)
    code = (
        "import os, sys; from pathlib import Path\n"
        "from survey_data.whole_files import replace_file, replacing\n"
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
    with replacing(directory / "out", directory / "out.zip") as (out, zipped):
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
        with replacing(earlier / "out") as (out,):
            out.mkdir()
            (out / "new").write_text("new")
            raise RuntimeError("half way")

    with pytest.raises(RuntimeError, match="half way"):
        half_way()
    assert untouched(earlier)


@pytest.mark.parametrize("failing", [1, 2, 3, 4])
def test_whichever_rename_fails_everything_is_put_back(
    failing: int, earlier: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rename, calls = Path.rename, []

    def refused_once(self: Path, target: Path) -> Path:
        calls.append(target)
        if len(calls) == failing:
            raise PermissionError(13, "Permission denied")
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", refused_once)
    with pytest.raises(PermissionError):
        renew(earlier)
    assert untouched(earlier)


def test_what_cannot_be_put_back_is_kept_and_named(
    earlier: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rename, calls = Path.rename, []

    def refused_from_the_second_on(self: Path, target: Path) -> Path:
        calls.append(target)
        if len(calls) > 1:
            raise PermissionError(13, "Permission denied", str(self), None, str(target))
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", refused_from_the_second_on)
    with pytest.raises(PermissionError) as caught:
        renew(earlier)
    assert (Path(caught.value.filename) / "held").read_text() == "old"


@pytest.mark.parametrize("rename", [1, 2, 3, 4])
def test_a_kill_at_any_rename_loses_nothing_of_what_was_there(rename: int, earlier: Path) -> None:
    code = (
        "import os, sys; from pathlib import Path\n"
        "from survey_data.whole_files import replacing\n"
        "rename, calls = Path.rename, []\n"
        "def killing(self, target):\n"
        "    calls.append(target)\n"
        "    if len(calls) == int(sys.argv[2]): os._exit(9)\n"
        "    return rename(self, target)\n"
        "Path.rename = killing\n"
        "here = Path(sys.argv[1])\n"
        "with replacing(here / 'out', here / 'out.zip') as (out, zipped):\n"
        "    out.mkdir(); (out / 'new').write_text('new'); zipped.write_text('new zip')\n"
    )
    killed(code, earlier, rename)
    found = {path.read_text() for path in earlier.rglob("*") if path.is_file()}
    assert {"old", "old zip"} <= found
    visible = earlier / "out"
    assert not visible.exists() or names(visible) in (["held"], ["new"]), "never a half of it"
