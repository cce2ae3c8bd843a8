"""A damaged manifest or file is named, and never taken for what a command wrote."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from files import manifest
from files.manifest import FILE, NEXT, differences, read_manifest, rewrite_manifest, write_recorded
from files.reading import FileRefusedError

TABLE = "name,size\n" + "".join(f"part {k},{k}\n" for k in range(1, 9))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    contents = {"table.csv": TABLE, "inner/one.csv": "a\n1\n", "inner/two.csv": "a\n2\n"}
    assert write_recorded(tmp_path, contents, start=True)
    return tmp_path


NAMES = ("table.csv", "inner/one.csv", "inner/two.csv")


def problems_of(folder: Path) -> list[str]:
    return [str(problem) for problem in differences(folder, NAMES)]


@pytest.mark.parametrize("member", ["rows", "columns"])
def test_digests_that_are_no_base_64_are_refused_with_their_file(folder: Path, member: str) -> None:
    held = json.loads((folder / FILE).read_text())
    held["files"]["inner/one.csv"][member] = "?"
    (folder / FILE).write_text(json.dumps(held))
    with pytest.raises(FileRefusedError, match=r"inner/one\.csv: not base 64"):
        read_manifest(folder)
    (said,) = problems_of(folder)
    assert said.startswith(f"{FILE}: inner/one.csv: not base 64")


def test_a_folder_that_changes_in_one_step_may_gain_files_and_stays_where_nothing_changes(
    folder: Path,
) -> None:
    (folder / "inner/one.csv").chmod(0o600)
    before = (folder / "inner").stat().st_ino
    assert not write_recorded(folder, {"inner/one.csv": "a\n1\n"}, together="inner")
    assert (folder / "inner").stat().st_ino == before
    coming: dict[str, str | bytes | None] = {"inner/three.csv": "a\n3\n", "inner/two.csv": None}
    assert write_recorded(folder, coming, together="inner")
    assert {path.name: path.read_text() for path in (folder / "inner").iterdir()} == {
        "one.csv": "a\n1\n",
        "three.csv": "a\n3\n",
    }
    assert (folder / "inner/one.csv").stat().st_mode & 0o777 == 0o600
    names = ("table.csv", "inner/one.csv", "inner/three.csv")
    assert differences(folder, names) == []


def test_a_damaged_coming_manifest_does_not_undo_what_a_command_writes(folder: Path) -> None:
    known = read_manifest(folder)
    assert known is not None
    (folder / NEXT).write_text("half of it")
    wanted = TABLE.replace("part 1", "part one")
    assert write_recorded(folder, {"table.csv": wanted})
    assert not (folder / NEXT).exists()
    assert read_manifest(folder) == {
        **known,
        "table.csv": manifest.Entry.of("table.csv", wanted.encode()),
    }


def test_a_damaged_manifest_is_replaced_and_every_file_counts_as_changed(folder: Path) -> None:
    assert rewrite_manifest(folder, NAMES) == []
    (folder / FILE).write_text("[]")
    assert rewrite_manifest(folder, NAMES) == sorted(NAMES)
    assert problems_of(folder) == []


def test_a_directory_in_place_of_a_file_is_named(folder: Path) -> None:
    (folder / "table.csv").unlink()
    (folder / "table.csv").mkdir()
    assert problems_of(folder) == ["table.csv: expected a file, got a directory"]
