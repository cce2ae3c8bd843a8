"""An import writes what was asked for, once, or nothing at all."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

import pytest

from survey_data import SurveyImportError, import_table, load, validate
from survey_data.importing.writing import locked_tables


def offer(copy: Any, text: str) -> Path:
    path = copy.directory / "theirs.txt"
    path.write_text(text, encoding="utf-8")
    return path


def cell(copy: Any, study: str, attribute: str) -> list[list[str]]:
    return [row for row in copy.rows("attributes") if row[:2] == [study, attribute]]


THEIRS = (
    "Key;Mask;Task;Error;Accuracy (deg);Model\n"
    "Alvi2014;Slit;Accuracy;Alignment;0.2;\n"  # mask agrees, task and error and accuracy are new
    "Chang2008;Multi;Cost, Accuracy;;;LUT\n"  # model is printed otherwise
    "Nobody1999;Slit;Cost;;;\n"
)


def test_a_comparison_writes_nothing_and_shows_every_kind(copy: Any) -> None:
    before = {path: path.read_bytes() for path in copy.directory.rglob("*.csv")}
    plan = import_table(offer(copy, THEIRS), copy.directory)
    after = {path: path.read_bytes() for path in copy.directory.rglob("*.csv")}
    assert after == before
    assert plan.written == 0
    kinds = {(d.study, d.attribute): d.kind for d in (*plan.differences, *plan.confirmed)}
    assert kinds["Alvi2014", "mask"] == "confirmed"
    assert kinds["Alvi2014", "error"] == "new"
    assert kinds["Alvi2014", "accuracy_deg"] == "new"
    assert kinds["Chang2008", "mask"] == "changed"
    assert kinds["Chang2008", "model"] == "conflict"
    (conflict,) = (entry for entry in plan.differences if entry.kind == "conflict")
    assert (conflict.ours, conflict.theirs) == (("SPM",), ("LUT",))
    assert (conflict.basis, conflict.row, conflict.column) == ("survey-table", 3, "Model")
    assert [(entry.row, entry.reason) for entry in plan.unmatched] == [
        (4, "no study has the key 'Nobody1999'")
    ]
    assert [(one.row, one.study) for one in plan.matched] == [(2, "Alvi2014"), (3, "Chang2008")]


@pytest.mark.slow
def test_applying_raises_the_basis_and_keeps_what_was_said_before(copy: Any) -> None:
    old_mask = cell(copy, "Alvi2014", "mask")[0]
    plan = import_table(offer(copy, THEIRS), copy.directory, apply=True)
    assert plan.written == len(plan.edits) > 0
    assert validate(copy.directory) == []
    doi = "10.5281/zenodo.15784429"
    (mask,) = cell(copy, "Alvi2014", "mask")
    assert mask[2:5] == ["Slit", "authors-table", doi]
    assert old_mask[3] in mask[5]
    assert old_mask[5] in mask[5]
    assert cell(copy, "Alvi2014", "error") == [
        ["Alvi2014", "error", "Alignment", "authors-table", doi, ""]
    ]
    assert cell(copy, "Alvi2014", "accuracy_deg")[0][2] == "0.2"
    (changed,) = cell(copy, "Chang2008", "mask")
    assert changed[2] == "Multi-Ap."
    assert "Single-Ap." in changed[5]
    assert {row[2] for row in cell(copy, "Chang2008", "task")} == {"Cost", "Accuracy"}


@pytest.mark.parametrize(
    ("column", "said", "kind"),
    [
        ("", "", "unspecified"),  # 3 sigma was said of the number that is gone
        pytest.param(";Accuracy kind", ";RMS", "rms", marks=pytest.mark.slow),
        (";Accuracy kind", ";3-sigma", "3sigma"),
    ],
)
def test_a_replaced_accuracy_does_not_keep_the_kind_of_the_old_one(
    copy: Any, column: str, said: str, kind: str
) -> None:
    text = f"Key;Accuracy (deg){column}\nWei2011;0.05{said}\n"
    import_table(offer(copy, text), copy.directory, apply=True)
    assert cell(copy, "Wei2011", "accuracy_deg")[0][2] == "0.05"
    (found,) = cell(copy, "Wei2011", "accuracy_kind")
    assert found[2:4] == [kind, "authors-table"]
    assert validate(copy.directory) == []


def test_the_survey_s_printed_cells_are_never_overwritten(copy: Any) -> None:
    before = [row for row in copy.rows("attributes") if row[3] == "survey-table"]
    import_table(offer(copy, THEIRS), copy.directory, apply=True)
    assert [row for row in copy.rows("attributes") if row[3] == "survey-table"] == before


def test_only_the_cells_taken_over_change(copy: Any) -> None:
    before = copy.rows("attributes")
    plan = import_table(offer(copy, THEIRS), copy.directory, apply=True)
    touched = {(edit.study, edit.attribute) for edit in plan.edits}
    rest = [row for row in copy.rows("attributes") if (row[0], row[1]) not in touched]
    assert rest == [row for row in before if (row[0], row[1]) not in touched]
    others = {path for path in copy.directory.iterdir() if path.is_file()}
    assert {path.name for path in others if path.suffix not in {".csv", ".json"}} == {"theirs.txt"}


def test_who_imports_while_another_writes_waits_and_keeps_what_that_one_wrote(copy: Any) -> None:
    path = offer(copy, "Key,Error\nAlvi2014,Alignment\n")
    applied = threading.Event()

    def other() -> None:
        assert import_table(path, copy.directory, apply=True).written == 1
        applied.set()

    waiting = threading.Thread(target=other)
    with locked_tables(copy.directory):
        waiting.start()
        assert not applied.wait(0.5)
        rows = copy.rows("attributes")
        mask = next(row for row in rows if row[:2] == ["Alvi2014", "mask"])
        mask[5] = "written meanwhile"
        copy.write("attributes", rows)
    waiting.join(60)
    assert applied.is_set()
    assert cell(copy, "Alvi2014", "mask")[0][5] == "written meanwhile"
    assert cell(copy, "Alvi2014", "error")[0][2] == "Alignment"
    assert not list(copy.directory.glob(".*")), "the lock went with its holder"


def test_applying_twice_changes_nothing_the_second_time(copy: Any) -> None:
    path = offer(copy, THEIRS)
    import_table(path, copy.directory, apply=True)
    once = copy.path("attributes").read_bytes()
    again = import_table(path, copy.directory, apply=True)
    assert again.written == 0
    assert [entry.kind for entry in again.differences] == ["conflict"]
    assert again.confirmed == ()
    assert copy.path("attributes").read_bytes() == once


@pytest.mark.slow
def test_a_newer_authors_table_replaces_an_older_one(copy: Any) -> None:
    import_table(offer(copy, "Key,Mask\nAlvi2014,Lens\n"), copy.directory, apply=True)
    import_table(offer(copy, "Key,Mask\nAlvi2014,V-Slit\n"), copy.directory, apply=True)
    (mask,) = cell(copy, "Alvi2014", "mask")
    assert mask[2:4] == ["V-Slit", "authors-table"]


def test_our_own_table_brings_no_difference(copy: Any) -> None:
    attributes = load(copy.directory).attributes.dropna(subset=["value"])
    cells = attributes.groupby(["study", "attribute"])["value"].agg("; ".join).unstack()
    path = copy.directory / "theirs.csv"
    cells.to_csv(path)
    plan = import_table(path, copy.directory)
    assert plan.differences == plan.errors == plan.unmatched == ()
    assert len(plan.matched) == 129


@pytest.mark.parametrize(
    ("text", "row", "column", "expected"),
    [
        ("Key,Mask\nAlvi2014,Lens\nChang2008,Sundial\n", 3, "Mask", "'Sundial' is no value"),
        ("Key,Mask,FOV\nAlvi2014,Lens,wide\n", 2, "FOV", "expected an angle"),
        ("Key,Accuracy class,Mask\nAlvi2014,\"CSS, FSS\",Lens\n", 2, "Accuracy class", "takes one"),
        ("Key,Authors,Year,Mask\nAlvi2014,,,Lens\n,B. Alvi,2014,Slit\n", 3, "Key", "as row 2 does"),
    ],
)  # fmt: skip
def test_an_unreadable_cell_stops_everything(
    text: str, row: int, column: str, expected: str, copy: Any
) -> None:
    path = offer(copy, text)
    before = copy.path("attributes").read_bytes()
    overrides = {"FOV": "fov_deg"} if "FOV" in text else None
    plan = import_table(path, copy.directory, overrides=overrides)
    assert [(p.row, p.column) for p in plan.errors] == [(row, column)]
    with pytest.raises(SurveyImportError, match=expected) as caught:
        import_table(path, copy.directory, overrides=overrides, apply=True)
    assert (caught.value.row, caught.value.column) == (row, column)
    assert copy.path("attributes").read_bytes() == before


def test_a_table_about_other_studies_is_refused(copy: Any) -> None:
    with pytest.raises(SurveyImportError, match=r"our.*2"):
        import_table(offer(copy, "Key,Mask\nNobody1999,Slit\n"), copy.directory)


@pytest.mark.slow
def test_an_import_into_invalid_tables_is_refused(copy: Any) -> None:
    copy.set("studies", 2, "doi", "no doi")
    before = copy.path("attributes").read_bytes()
    with pytest.raises(SurveyImportError, match=r"studies.csv.*2.*doi"):
        import_table(offer(copy, "Key,Mask\nAlvi2014,Lens\n"), copy.directory, apply=True)
    assert copy.path("attributes").read_bytes() == before


def test_a_failing_write_leaves_the_old_file(copy: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(self: Path, target: Path) -> None:
        raise PermissionError(13, "Permission denied")

    path = offer(copy, "Key,Mask\nAlvi2014,Lens\n")
    before = {entry.name for entry in copy.directory.iterdir()}
    old = copy.path("attributes").read_bytes()
    monkeypatch.setattr(Path, "replace", refuse)
    with pytest.raises(SurveyImportError, match="cannot write"):
        import_table(path, copy.directory, apply=True)
    assert copy.path("attributes").read_bytes() == old
    assert {entry.name for entry in copy.directory.iterdir()} == before


def test_angles_that_differ_by_rounding_are_the_same(copy: Any) -> None:
    # Mobasser2003 is held as 0.0167 deg
    text = "Key,Accuracy\nMobasser2003,1 arcmin\n"
    plan = import_table(offer(copy, text), copy.directory, overrides={"Accuracy": "accuracy_deg"})
    assert plan.differences == ()
    assert [entry.theirs for entry in plan.confirmed] == [("0.0167",)]
