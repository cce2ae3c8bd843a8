"""What a file says that it holds is bounded before room is made for it."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl
import pandas as pd
import pytest

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
        ((600,), [("a", "<U1000000"), ("b", "<f8")], "at most 1073741824 bytes; got 2400004800"),
        ((600, 10), [("a", "<U100000"), ("b", "<f8")], "bytes; got 2400048000"),
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
