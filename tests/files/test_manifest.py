"""What was changed by hand is named by file, row and column; what a command wrote passes."""

import re
import shutil
from pathlib import Path

import pytest

import survey_data
from files import manifest
from files.manifest import FILE, NEXT, differences, write_recorded
from survey_data import facts_manifest
from survey_data.descriptor import DATA_DIRECTORY

TABLE = "name,size,colour\none,1,red\ntwo,2,green\nthree,3,blue\n"
NAMES = ("table.csv", "inner/said.json")


@pytest.fixture
def folder(tmp_path):
    contents = {"table.csv": TABLE, "inner/said.json": '{\n"a": 1\n}\n'}
    assert write_recorded(tmp_path, contents, start=True)
    return tmp_path


def problems_of(folder, **options):
    return [str(problem) for problem in differences(folder, NAMES, **options)]


def test_what_a_command_wrote_passes_and_nothing_else_is_left(folder):
    assert problems_of(folder) == []
    assert sorted(p.name for p in folder.iterdir()) == ["inner", FILE, "table.csv"]
    assert not write_recorded(folder, {"table.csv": TABLE}), "unchanged"


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("two,2,", "two,20,", r"table\.csv, row 3, column size: .*'20'"),
        ("blue\n", "blue", "table.csv, row 5"),
        ("blue\n", "bluf\n", "table.csv, row 4, column colour: "),
        ("two,2,green\n", "", "table.csv, row 3"),
        ("two,2,", "extra,9,red\ntwo,2,", "table.csv, row 3: 1"),
        ("one,1,red\ntwo,2,green", "two,2,green\none,1,red", "row 2, column name, size, colour: "),
        ("name,size", "nome,size", "table.csv, row 1"),
        ("two,2,green", "two,2", "table.csv, row 3: not as"),
        ("two", "t\xff", "table.csv, row 3, column name: "),
        ("name,size", "\ufeffname,size", "table.csv, row 1"),
    ],
)
def test_a_change_by_hand_is_named_by_its_cell(folder, old, new, said):
    path = folder / "table.csv"
    assert old in TABLE
    path.write_bytes(TABLE.replace(old, new).encode("latin-1" if "\xff" in new else "utf-8"))
    assert re.search(said, problems_of(folder)[0])


def test_other_files_are_named_by_line_and_what_is_missing_or_extra_by_file(folder):
    (folder / "inner/said.json").write_text('{\n"a": 2\n}\n')
    (said,) = problems_of(folder)
    assert said.startswith("inner/said.json, row 2: ")
    (folder / "inner/said.json").unlink()
    (folder / "new.csv").write_text("a\n")
    found = [str(p) for p in differences(folder, (*NAMES, "new.csv"))]
    assert found == [
        "inner/said.json: the file is missing",
        f"new.csv: the file is not in {FILE}: no command wrote it",
    ]


def test_a_command_takes_over_only_what_it_writes_itself(folder):
    (folder / "table.csv").write_text(TABLE.replace("red", "rot"))
    write_recorded(folder, {"inner/said.json": "{}\n"})
    assert [said.partition(":")[0] for said in problems_of(folder)] == [
        "table.csv, row 2, column colour"
    ]


def test_a_missing_or_damaged_manifest_is_named(folder, tmp_path):
    for text in ("", "[]", '{"schema": 1}', '{"schema": 2, "files": {}}', '{"schema": NaN}'):
        (folder / FILE).write_text(text)
        (said,) = problems_of(folder)
        assert said.startswith(FILE)
        with pytest.raises(ValueError, match=FILE):
            write_recorded(folder, {"table.csv": TABLE})
    (folder / FILE).unlink()
    assert problems_of(folder) == []
    assert problems_of(folder, required=True) == [f"{FILE}: the file is missing"]
    (folder / FILE).mkdir()
    (said,) = problems_of(folder)
    assert said.startswith(f"{FILE}: ")
    assert "directory" in said


@pytest.mark.parametrize("killed_after", [0, 1, 2])
def test_what_a_kill_leaves_is_no_change_by_hand_and_the_next_run_ends_it(
    folder, monkeypatch, killed_after
):
    wanted = {"table.csv": TABLE.replace("red", "rot"), "inner/said.json": "{}\n"}
    real, calls = manifest.replace_file, []

    def dies(path, content):
        if path.name != NEXT and len(calls) == killed_after:
            raise KeyboardInterrupt
        calls.append(path.name != NEXT or calls.clear())
        return real(path, content)

    def settled(_folder):
        raise KeyboardInterrupt

    monkeypatch.setattr(manifest, "replace_file", dies)
    monkeypatch.setattr(manifest, "finish_interrupted_write", settled)
    with pytest.raises(KeyboardInterrupt):
        write_recorded(folder, wanted)
    assert (folder / NEXT).exists()
    assert problems_of(folder) == []
    monkeypatch.undo()
    write_recorded(folder, wanted)
    assert problems_of(folder) == []
    assert not (folder / NEXT).exists()
    assert (folder / "inner/said.json").read_text() == "{}\n"


def test_the_next_command_need_not_take_away_what_a_killed_one_took(folder, monkeypatch):
    """Who drops a file knows no more of it the next time: the coming manifest does."""
    changed = TABLE.replace("red", "rot")
    real = Path.unlink

    def dies(path, *, missing_ok=False):
        real(path, missing_ok=missing_ok)
        if path.name == "said.json":
            raise KeyboardInterrupt

    monkeypatch.setattr(Path, "unlink", dies)
    with pytest.raises(KeyboardInterrupt):
        write_recorded(folder, {"inner/said.json": None, "table.csv": changed})
    monkeypatch.undo()
    assert not (folder / "inner/said.json").exists()
    write_recorded(folder, {"table.csv": changed})
    assert not (folder / NEXT).exists()
    assert "inner/said.json" not in manifest.read_manifest(folder)
    assert [str(p) for p in differences(folder, ("table.csv",))] == []


def test_settling_finishes_or_drops_what_a_kill_left(folder):
    entries = manifest.read_manifest(folder)
    changed = TABLE.replace("red", "rot")
    coming = {**entries, "table.csv": manifest.Entry.of("table.csv", changed.encode())}
    (folder / NEXT).write_text(manifest.manifest_text(coming))
    manifest.finish_interrupted_write(folder)
    assert not (folder / NEXT).exists()
    assert manifest.read_manifest(folder) == entries, "nothing had been written"
    (folder / NEXT).write_text(manifest.manifest_text(coming))
    (folder / "table.csv").write_text(changed)
    manifest.finish_interrupted_write(folder)
    assert not (folder / NEXT).exists()
    assert manifest.read_manifest(folder) == coming, "everything had"


def test_our_own_facts_are_as_their_commands_wrote_them():
    assert facts_manifest.changes() == []


@pytest.fixture
def facts(tmp_path):
    for name in (*facts_manifest.names(), FILE):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copyfile(DATA_DIRECTORY / name, tmp_path / name)
    return tmp_path


def test_a_changed_letter_a_lost_row_and_a_cut_in_the_facts_are_refused(facts):
    path = facts / "studies.csv"
    right = path.read_bytes()
    for wrong in (
        right.replace(b"sensor", b"sensos", 1),
        right[:-1],
        right[: right.rindex(b"\n", 0, -1) + 1],
    ):
        path.write_bytes(wrong)
        with pytest.raises(
            survey_data.SurveyDataError, match=r"studies\.csv, row \d+.*; restore it"
        ):
            facts_manifest.require_unchanged(facts)
    path.write_bytes(right)
    facts_manifest.require_unchanged(facts)


def test_facts_are_taken_over_only_when_they_are_valid(facts):
    path = facts / "studies.csv"
    right = path.read_text()
    path.write_text(right.replace("sensor", "sensos", 1))
    assert facts_manifest.renew(facts) == ["studies.csv"]
    facts_manifest.require_unchanged(facts)
    path.write_text(right + right.splitlines()[1] + "\n")
    with pytest.raises(survey_data.SurveyDataError, match="duplicate"):
        facts_manifest.renew(facts)
    assert facts_manifest.changes(facts) != []
