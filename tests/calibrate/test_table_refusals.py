"""A file that is no table of numbers is refused with what was expected and what came."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from calibrate import table as tables
from calibrate.table import TableError, read_table


def read(directory: Path, name: str, data: bytes) -> tables.Table:
    """Read bytes as a file of this name."""
    path = directory / name
    path.write_bytes(data)
    return read_table(path)


def archive(**members: bytes) -> bytes:
    """A ZIP archive."""
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as file:
        for name, data in members.items():
            file.writestr(name, data)
    return made.getvalue()


def npz(**arrays: np.ndarray) -> bytes:
    made = io.BytesIO()
    np.savez(made, **arrays)  # type: ignore[arg-type]
    return made.getvalue()


def npy(array: np.ndarray) -> bytes:
    made = io.BytesIO()
    np.save(made, array, allow_pickle=True)
    return made.getvalue()


def parquet(frame: pd.DataFrame) -> bytes:
    made = io.BytesIO()
    frame.to_parquet(made)
    return made.getvalue()


MANY = tables.MOST_COLUMNS + 1


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (b"x,y\n", "there are no rows under the header"),
        (b"x,y\n1,2\n3,4\n5,\x00\n", "row 4: a null character"),
        (b"x,y\n1,2\n3\n", "row 3: expected 2 cells; got 1"),
        (
            ",".join(f"c{n}" for n in range(MANY)).encode() + b"\n",
            f"expected at most {MANY - 1} columns; got {MANY}",
        ),
    ],
)
def test_text_that_is_no_table_is_refused(text: bytes, said: str, tmp_path: Path) -> None:
    with pytest.raises(TableError, match=rf"^bench\.csv.*{said}"):
        read(tmp_path, "bench.csv", text)


def test_text_of_another_encoding_is_read_and_its_cells_judged(tmp_path: Path) -> None:
    found = read(tmp_path, "bench.csv", b"x,y\n1,2\n3,\xff\n")
    assert found.notes[0].startswith("text in CP1252")
    with pytest.raises(TableError, match="row 3, column y: expected a number; got 'ÿ'"):
        found.numbers("y")


def test_more_rows_than_the_limit_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tables, "MOST_ROWS", 3)
    assert len(read(tmp_path, "bench.csv", b"x,y\n" + 3 * b"1,2\n")) == 3
    with pytest.raises(TableError, match="expected at most 3 rows; got more"):
        read(tmp_path, "bench.csv", b"x,y\n" + 4 * b"1,2\n")


@pytest.mark.parametrize(
    ("name", "data", "said"),
    [
        ("a.parquet", b"PAR1 and no more", r"expected a Parquet file \("),
        (
            "a.parquet",
            parquet(pd.DataFrame({f"c{n}": [1.0] for n in range(MANY)})),
            rf"expected at most .* {MANY - 1} columns .*; got 1 rows of {MANY} columns",
        ),
        ("a.xlsx", b"no archive", "expected a ZIP archive"),
        ("a.xlsx", archive(note=b"no workbook"), r"expected an Excel workbook \("),
        ("a.npz", b"no arrays", "expected NumPy arrays without pickles"),
        (
            "a.npy",
            npy(np.array([{"x": 1.0}], dtype=object)),
            r"expected NumPy arrays without pickles \(Object arrays cannot be loaded",
        ),
        (
            "a.npz",
            npz(x=np.zeros((2, 2, 2))),
            r"array x: expected one or two axes; got \(2, 2, 2\)",
        ),
        ("a.npz", npz(x=np.zeros(3), y=np.zeros(4)), r"arrays of one length by name; got \[3, 4\]"),
        ("a.npy", npy(np.zeros(3)), r"arrays of one length by name; got \[\]"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_damaged_or_oversized_binary_file_is_refused(
    name: str, data: bytes, said: str, tmp_path: Path
) -> None:
    with pytest.raises(TableError, match=rf"^{name}.*{said}"):
        read(tmp_path, name, data)


def test_a_structured_array_gives_its_fields_as_columns(tmp_path: Path) -> None:
    array = np.array([(1.0, 2), (3.0, 4)], dtype=[("x_px", float), ("run", int)])
    found = read(tmp_path, "bench.npy", npy(array))
    assert list(found.columns) == ["x_px", "run"]
    assert found.numbers("run").tolist() == [2.0, 4.0]


def test_an_array_of_two_axes_gives_a_column_for_each_place(tmp_path: Path) -> None:
    spots = np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]])
    found = read(tmp_path, "bench.npz", npz(spot=spots, run=np.arange(3)))
    assert list(found.columns) == ["spot_0", "spot_1", "run"]
    assert found.numbers("spot_1").tolist() == [2.0, 4.0, 6.0]
