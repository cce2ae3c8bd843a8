"""What a file says that it holds is bounded before room is made for it."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from calibrate import table
from calibrate.table import TableError, read_table

HEADER = ("x_px", "y_px", "alpha", "beta")


def workbook(path: Path, stray: str, value: object) -> Path:
    book = openpyxl.Workbook()
    sheet: Any = book.active
    for row in (HEADER, (1, 2, 3, 4)):
        sheet.append(row)
    sheet[stray].number_format = "0.00"
    sheet[stray] = value
    book.save(path)
    return path


@pytest.mark.parametrize(
    ("stray", "said"),
    [("XFD1048576", "1048576 rows of 16384 columns"), ("SH3", "3 rows of 502 columns")],
)
def test_a_stray_cell_far_out_is_refused_before_cells_are_read(
    stray: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pd, "read_excel", lambda *_, **__: pytest.fail("cells are read"))
    with pytest.raises(TableError, match=said):
        read_table(workbook(tmp_path / "a.xlsx", stray, 1))


def altered(path: Path, rows: bytes, **parts: bytes) -> Path:
    """A small workbook with more rows in its sheet."""
    workbook(path, "A3", 1)
    with zipfile.ZipFile(path) as archive:
        made = {name: archive.read(name) for name in archive.namelist()}
    sheet = "xl/worksheets/sheet1.xml"
    made[sheet] = made[sheet].replace(b"</sheetData>", rows + b"</sheetData>")
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in {**made, **parts}.items():
            archive.writestr(name, data)
    return path


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ((b"<row>" + b"<c/>" * 60 + b"</row>") * 2, "at most 99 rows and cells in a workbook"),
        ((b'<x:row r="9"><x:c s="1" r="A9"><x:v>1</x:v></x:c></x:row>') * 50, "at most 99 rows"),
        (b"<row/>" * 100, "at most 99 rows"),
        (b"<row>" + b"<c><v>1</v></c>" * 501 + b"</row>", "rows of 501 columns"),
    ],
    ids=["empty cells", "one place", "rows", "a row"],
)
def test_a_workbook_of_many_cells_is_refused_before_they_are_read(
    rows: bytes, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """40 million empty cells in 0.2 MB took 60 s and 3.2 GB."""
    monkeypatch.setattr(pd, "read_excel", lambda *_, **__: pytest.fail("cells are read"))
    if "99" in said:
        monkeypatch.setattr(table, "_MOST_OF_WORKBOOK", 99)
    with pytest.raises(TableError, match=said):
        read_table(altered(tmp_path / "a.xlsx", rows))


def test_texts_of_a_workbook_are_counted_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(table, "_MOST_OF_WORKBOOK", 99)
    texts = {"xl/sharedStrings.xml": b"<sst>" + b"<si/>" * 100 + b"</sst>"}
    with pytest.raises(TableError, match="at most 99 rows and cells"):
        read_table(altered(tmp_path / "a.xlsx", b"", **texts))


def test_cells_that_do_not_state_their_place_are_read(tmp_path: Path) -> None:
    rows = b"<row>" + b"<c><v>5</v></c>" * 4 + b"</row>"
    found = read_table(altered(tmp_path / "a.xlsx", rows * 300))
    assert found.numbers("beta")[-300:].tolist() == [5.0] * 300


def test_an_empty_cell_far_out_is_passed_over(tmp_path: Path) -> None:
    assert len(read_table(workbook(tmp_path / "a.xlsx", "XFD9", None))) == 1


def head(shape: tuple[int, ...], kind: Any) -> bytes:
    file = io.BytesIO()
    described = {"descr": kind, "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(file, described)
    return file.getvalue()


@pytest.mark.parametrize(
    ("shape", "kind", "said"),
    [
        ((100_000_000,), "<f8", "at most 2000000 rows"),
        ((1_000, 501), "<f8", "500 columns"),
        (
            (600,),
            [("a", "<U1000000"), ("b", "<f8")],
            "at most 1073741824 bytes unpacked; got 2400004800",
        ),
        ((600, 10), [("a", "<U100000"), ("b", "<f8")], "bytes unpacked; got 2400048000"),
    ],
)
@pytest.mark.parametrize("suffix", [".npy", ".npz"])
def test_arrays_are_refused_by_their_heads(
    shape: tuple[int, ...], kind: Any, said: str, suffix: str, tmp_path: Path
) -> None:
    """No file of theirs holds as much as an element."""
    path = tmp_path / f"a{suffix}"
    path.write_bytes(head(shape, kind))
    if suffix == ".npz":
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("x_px.npy", head(shape, kind))
    with pytest.raises(TableError, match=said):
        read_table(path)


def coded(path: Path, rows: int, values: list[str], kept: bool) -> Path:
    """A Parquet file of a column of text that holds each value once; `kept`: for pandas too."""
    places = pa.array(np.arange(rows, dtype=np.int32) % len(values))
    runs = pa.DictionaryArray.from_arrays(places, pa.array(values))
    columns = pa.table({"x_px": np.arange(float(rows)), "run": runs})
    pq.write_table(columns, path, store_schema=kept)
    return path


@pytest.mark.parametrize("kept", [False, True])
def test_text_that_unfolds_to_gigabytes_is_refused_before_cells_are_read(
    kept: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """12,000 cells of 100,000 letters, in 0.2 MB."""
    path = coded(tmp_path / "a.parquet", 12_000, ["b" * 100_000], kept)
    assert path.stat().st_size < 300_000
    monkeypatch.setattr(pd, "read_parquet", lambda *_, **__: pytest.fail("cells are read"))
    with pytest.raises(TableError, match="at most 1073741824 bytes unpacked"):
        read_table(path)


@pytest.mark.parametrize("kept", [False, True])
def test_names_of_runs_are_read_however_often_they_stand(kept: bool, tmp_path: Path) -> None:
    found = read_table(coded(tmp_path / "a.parquet", 30_000, ["cold", "hot"], kept))
    assert found.columns["run"][-2:].tolist() == ["cold", "hot"]


@pytest.mark.slow
def test_lists_of_many_numbers_in_a_few_cells_are_refused_by_their_count(tmp_path: Path) -> None:
    path = tmp_path / "a.parquet"
    pq.write_table(pa.table({"x_px": [[0.0] * 2_100_000] * 30}), path)
    with pytest.raises(TableError, match="at most 60000000 cells; got 63000000"):
        read_table(path)


def test_a_long_text_in_a_long_column_is_named_by_its_row(tmp_path: Path) -> None:
    """An array of text would give each cell the room of the longest: 40 GB."""
    path = tmp_path / "a.csv"
    path.write_text("x_px,note\n" + "1,a\n" * 100_000 + f"1,{'b' * 100_000}\n")
    said = r"row 100002, column note: .* one of 100000 characters in a column of 100001 cells"
    with pytest.raises(TableError, match=said):
        read_table(path)
