"""What a killed process left a day ago is removed; what is being made, or looks alike, is not."""

from __future__ import annotations

import os
import time
from pathlib import Path

from files.temporary import (
    remove_stale_files,
    temporary_directory,
    temporary_directory_beside,
    temporary_file_beside,
)


def names(directory: Path) -> list[str]:
    return sorted(entry.name for entry in directory.iterdir())


def test_what_is_made_is_gone_at_the_end_and_a_directory_is_this_user_s(tmp_path: Path) -> None:
    with temporary_directory_beside(tmp_path / "out") as made, temporary_directory() as other:
        (made / "mine").write_text("mine")
        assert made.stat().st_mode & 0o777 == other.stat().st_mode & 0o777 == 0o700
        with temporary_file_beside(tmp_path / "file") as file:
            assert file.parent == tmp_path
    assert names(tmp_path) == []
    assert not other.exists()


def test_only_what_is_a_day_old_and_of_the_target_is_removed(tmp_path: Path) -> None:
    (tmp_path / "precious").mkdir()
    (tmp_path / "precious" / "file").write_text("kept")
    old = time.time() - 90_000
    for name in (".out.abc.sunatlas", ".table.csv.abc.sunatlas", ".out.before", "out.sunatlas"):
        (tmp_path / name).mkdir()
        os.utime(tmp_path / name, (old, old))
    (tmp_path / ".out.link.sunatlas").symlink_to("precious")
    os.utime(tmp_path / ".out.link.sunatlas", (old, old), follow_symlinks=False)
    (tmp_path / ".out.new.sunatlas").mkdir()
    kept = [".out.before", ".out.new.sunatlas", "out.sunatlas", "precious"]
    with temporary_directory_beside(tmp_path / "out") as made:
        assert names(tmp_path) == sorted([*kept, ".table.csv.abc.sunatlas", made.name])
    remove_stale_files(tmp_path)
    assert names(tmp_path) == kept
    assert (tmp_path / "precious" / "file").read_text() == "kept"
    remove_stale_files(tmp_path / "missing")
