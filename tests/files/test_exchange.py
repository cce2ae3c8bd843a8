"""Two entries change places in one step, or nothing is done."""

from __future__ import annotations

import errno
import sys
from pathlib import Path

import pytest

from files import exchange as module
from files.exchange import exchange


@pytest.mark.skipif(sys.platform != "linux", reason="renameat2 is Linux's")
def test_a_file_and_a_directory_change_places(tmp_path: Path) -> None:
    one, other = tmp_path / "one", tmp_path / "other"
    one.write_text("text")
    other.mkdir()
    (other / "inside").touch()
    if not exchange(one, other):
        pytest.skip("this file system cannot exchange two entries")
    assert [path.name for path in one.iterdir()] == ["inside"]
    assert other.read_text() == "text"
    with pytest.raises(OSError, match="none"):
        exchange(one, tmp_path / "none")


@pytest.mark.parametrize("cannot", [errno.EINVAL, errno.ENOSYS, errno.EXDEV, errno.EOPNOTSUPP])
def test_where_the_system_cannot_it_says_so_and_does_nothing(
    cannot: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_renameat2", lambda: lambda *_: -1)
    monkeypatch.setattr(module.ctypes, "get_errno", lambda: cannot)
    assert not exchange(tmp_path / "one", tmp_path / "other")


def test_a_kernel_without_it_and_an_error_of_it_are_told_apart(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_renameat2", lambda: None)
    assert not exchange(tmp_path / "one", tmp_path / "other")
    monkeypatch.setattr(module, "_renameat2", lambda: lambda *_: -1)
    monkeypatch.setattr(module.ctypes, "get_errno", lambda: errno.EACCES)
    with pytest.raises(PermissionError):
        exchange(tmp_path / "one", tmp_path / "other")
