"""Tables made to hurt or to mislead: refused with the place named, soon, in little memory."""

import zipfile
from pathlib import Path

import pytest
from openpyxl import Workbook

import survey_data
from survey_data.importing.table_reader import read_table
from survey_data.importing.values import UnreadableValueError, ValueReader
from survey_data.problems import SurveyImportError

HEADER = ("Key", "Mask", "Accuracy")


def workbook(path: Path, change=None, rows=(("Alvi2014", "Slit", 0.5),)) -> Path:
    book = Workbook()
    sheet = book.active
    for row in (HEADER, *rows):
        sheet.append(row)
    if change is not None:
        change(book, sheet)
    book.save(path)
    return path


def refusal(path: Path, sheet: str | None = None) -> str:
    with pytest.raises(SurveyImportError) as refused:
        read_table(path, sheet)
    return str(refused.value)


def test_a_stray_cell_at_the_far_corner_is_refused(tmp_path):
    def far(_book, sheet):
        sheet["XFD1048576"] = "x"

    assert "row 1048576, column Accuracy: 16384 cells" in refusal(
        workbook(tmp_path / "t.xlsx", far)
    )


def test_empty_formatted_cells_and_merges_to_the_last_row_are_passed_over(tmp_path):
    path = workbook(
        tmp_path / "t.xlsx", lambda _b, sheet: sheet["XFD2000"].__setattr__("number_format", "0")
    )
    _with_part(
        path,
        "xl/worksheets/sheet1.xml",
        b"</sheetData>",
        b'</sheetData><mergeCells count="1"><mergeCell ref="D5:XFD1048576"/></mergeCells>',
    )
    assert read_table(path).shape == (1, 3)


def _with_part(path: Path, part: str, old: bytes, new: bytes) -> None:
    with zipfile.ZipFile(path) as archive:
        held = {name: archive.read(name) for name in archive.namelist()}
    assert old in held[part]
    held[part] = held[part].replace(old, new, 1)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in held.items():
            archive.writestr(name, data)


def test_formulas_without_values_are_refused_by_the_names_of_their_cells(tmp_path):
    path = workbook(
        tmp_path / "t.xlsx", rows=(("Alvi2014", "Slit", "=0.1*5"), ("Bao2020", "=A1", 1))
    )
    assert "cell C2: a formula without a value" in refusal(path)


@pytest.mark.parametrize(
    ("value", "said"),
    [("#N/A", "C2: an error (#N/A)"), (True, "C2: a truth value"), ("a\ufffd", "U+FFFD")],
)
def test_errors_truth_values_and_lost_letters_are_no_values(tmp_path, value, said):
    assert said in refusal(workbook(tmp_path / "t.xlsx", rows=(("Alvi2014", "Slit", value),)))
    if isinstance(value, str):
        path = tmp_path / "t.csv"
        path.write_text(f"Key,Mask,Accuracy\nAlvi2014,Slit,{value}\n")
        assert "row 2, column Accuracy" in refusal(path)


def test_a_hidden_first_sheet_is_not_taken_for_the_table(tmp_path):
    def hide(book, sheet):
        sheet.sheet_state = "hidden"
        other = book.create_sheet("seen")
        other.append(HEADER)
        other.append(("Bao2020", "Slit", 1))

    path = workbook(tmp_path / "t.xlsx", hide)
    assert list(read_table(path)["Key"]) == ["Bao2020"]
    assert list(read_table(path, "Sheet")["Key"]) == ["Alvi2014"]


def test_rows_in_hidden_sheets_alone_are_refused(tmp_path):
    def hide(book, sheet):
        sheet.sheet_state = "hidden"
        book.create_sheet("seen")

    assert "hidden sheets alone (Sheet)" in refusal(workbook(tmp_path / "t.xlsx", hide))


@pytest.fixture(scope="module")
def reader():
    return ValueReader(survey_data.load())


@pytest.mark.parametrize(
    "text",
    [">0.1", "<0.1", "≥ 0.1 deg", "<= 0.1", "0.1 0.2", "１.０", "1_29", "0x10", "nan", "inf"],
)
@pytest.mark.parametrize("attribute", ["accuracy_deg", "accuracy"])
def test_limits_and_what_is_no_plain_number_are_refused(reader, attribute, text):
    if text == "nan":  # how tables say that nothing is stated
        assert reader.read(attribute, text) == []
        return
    with pytest.raises(UnreadableValueError):
        reader.read(attribute, text)


def test_a_huge_cell_is_refused_and_a_long_one_split_in_one_pass(reader):
    with pytest.raises(UnreadableValueError, match="at most 5000 characters"):
        reader.read("mask", "(" * 100_000)
    assert reader.read("mask", "(," * 2000) == []
