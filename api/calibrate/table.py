"""A reader's file as named columns of numbers: CSV, Parquet, NumPy or Excel."""

from __future__ import annotations

import csv
import io
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from files.reading import read_bytes

#: Largest file, and most rows and columns that are read of one.
LARGEST, MOST_ROWS, MOST_COLUMNS = 256 * 1024 * 1024, 2_000_000, 500
#: Bytes that an archive may unpack to, and cells of a table.
_MOST_UNPACKED, _MOST_CELLS = 1024 * 1024 * 1024, 60_000_000
#: Endings of the files that are read.
SUFFIXES = (".csv", ".txt", ".tsv", ".parquet", ".npz", ".npy", ".xlsx")
_DELIMITERS = ",;\t|"


class TableError(ValueError):
    """A file that is no table of numbers: what was expected, what came, in which row and column."""


@dataclass(frozen=True)
class Table:
    """Columns of a file.

    Parameters
    ----------
    columns : mapping of str to ndarray
        Float columns (n,), or text columns (n,) where a cell is not a number.
    first_row : int
        Number of the first row of data as counted in the file; the header is row 1.
    source : str
        Name of the file.
    unread : mapping of str to (int, str)
        Of text columns the first row that is not a number, and what stands there.
    """

    columns: Mapping[str, NDArray[np.generic]]
    first_row: int
    source: str
    unread: Mapping[str, tuple[int, str]]

    def numbers(self, name: str) -> NDArray[np.float64]:
        """Return a column of numbers; TableError naming row and column otherwise."""
        if name not in self.columns:
            from survey_data.nearest import nearest_name  # noqa: PLC0415 - for a message only

            near = nearest_name(name, self.columns)
            hint = f"; did you mean {near!r}?" if near else ""
            raise TableError(
                f"{self.source}: no column {name!r}{hint} (there are {', '.join(self.columns)})"
            )
        if name in self.unread:
            row, cell = self.unread[name]
            raise TableError(
                f"{self.source}, row {row}, column {name}: expected a number; got {cell[:40]!r}"
            )
        return np.asarray(self.columns[name], dtype=np.float64)

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), ()))


def read_table(path: Path) -> Table:
    """Read a file of readings.

    Parameters
    ----------
    path : Path
        ``.csv``, ``.txt``, ``.tsv`` (comma, semicolon, tab; a header), ``.parquet``, ``.npz`` (by
        name), ``.npy`` (structured), ``.xlsx``.

    Returns
    -------
    Table

    Raises
    ------
    TableError
        If it is none of these, empty, ragged, or holds two columns of one name.
    FileRefusedError
        If it is no regular file, or larger than 256 MiB.
    """
    readers: dict[str, Callable[[bytes, str], Table]] = {
        **dict.fromkeys((".csv", ".txt", ".tsv"), _read_text),
        ".parquet": _read_parquet,
        ".npz": _read_numpy,
        ".npy": _read_numpy,
        ".xlsx": _read_excel,
    }
    kind = path.suffix.lower()
    if kind not in readers:
        raise TableError(
            f"{path.name}: expected a file of {', '.join(SUFFIXES)}; got {kind or 'none'}"
        )
    data = read_bytes(path, LARGEST)
    if not data:
        raise TableError(f"{path.name}: the file is empty")
    table = readers[kind](data, path.name)
    if not len(table):
        raise TableError(f"{path.name}: there are no rows under the header")
    return table


def _read_text(data: bytes, source: str) -> Table:
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        row = data.count(b"\n", 0, error.start) + 1
        raise TableError(f"{source}, row {row}: expected UTF-8 text") from None
    if "\x00" in text:
        raise TableError(
            f"{source}, row {text.count(chr(10), 0, text.index(chr(0))) + 1}: a null character"
        )
    header, _, rest = text.partition("\n")
    delimiter = max(_DELIMITERS, key=header.count)
    try:
        names = [name.strip() for name in next(csv.reader([header], delimiter=delimiter), [])]
    except csv.Error as error:
        raise TableError(f"{source}, row 1: expected a header ({error})") from None
    _require_names(names, source)
    wrong = _ragged(rest, len(names), delimiter)
    if wrong:
        raise TableError(f"{source}, row {wrong[0]}: expected {len(names)} cells; got {wrong[1]}")
    decimal = "," if delimiter != "," and _decimal_commas(rest) else "."
    frame = (
        pd.read_csv(
            io.StringIO(rest),
            sep=delimiter,
            header=None,
            names=names,
            dtype=str,
            decimal=".",
            keep_default_na=False,
            skip_blank_lines=False,
            nrows=MOST_ROWS + 1,
        )
        if rest.strip()
        else pd.DataFrame({name: [] for name in names})
    )
    if len(frame) > MOST_ROWS:
        raise TableError(f"{source}: expected at most {MOST_ROWS} rows; got more")
    return _of_frame(frame, source, decimal)


def _ragged(text: str, count: int, delimiter: str) -> tuple[int, int] | None:
    """Return row and number of cells of the first row with another number of cells."""
    for row, line in enumerate(text.splitlines(), start=2):
        if line and line.count(delimiter) != count - 1 and '"' not in line:
            return row, line.count(delimiter) + 1
    return None


def _decimal_commas(text: str) -> bool:
    sample = text[:20_000]
    return sample.count(",") > sample.count(".")


def _of_frame(frame: pd.DataFrame, source: str, decimal: str = ".") -> Table:
    columns: dict[str, NDArray[np.generic]] = {}
    unread: dict[str, tuple[int, str]] = {}
    for name in frame.columns:
        column = frame[name]
        if column.dtype.kind in "iufb":
            columns[name] = column.to_numpy(dtype=np.float64)
            continue
        text = column.fillna("").astype(str).str.strip()
        spelt = text.str.replace(decimal, ".", regex=False) if decimal != "." else text
        numbers = pd.to_numeric(spelt, errors="coerce").to_numpy(dtype=np.float64)
        blank = text.str.lower().isin(["", "nan", "na", "n/a", "null", "-"]).to_numpy()
        bad = ~np.isfinite(numbers) & ~blank
        if bad.any():
            first = int(np.argmax(bad))
            unread[name] = (first + 2, str(text.iloc[first]))
            columns[name] = text.to_numpy(dtype=str)
        else:
            columns[name] = numbers
    return Table(columns, 2, source, unread)


def _read_parquet(data: bytes, source: str) -> Table:
    try:
        from pyarrow.parquet import read_metadata  # noqa: PLC0415 - for such files only

        stated = read_metadata(io.BytesIO(data))
        _require_cells(stated.num_rows, stated.num_columns, source)
        frame = pd.read_parquet(io.BytesIO(data))
    except TableError:
        raise
    except Exception as error:  # noqa: BLE001 - pyarrow raises many kinds for damaged files
        raise TableError(f"{source}: expected a Parquet file ({str(error)[:80]})") from None
    _require_names([str(name) for name in frame.columns], source)
    frame.columns = [str(name) for name in frame.columns]
    return _of_frame(frame, source)


def _read_excel(data: bytes, source: str) -> Table:
    _require_unpacked(data, source)
    try:
        frame = pd.read_excel(io.BytesIO(data), nrows=MOST_ROWS)
    except Exception as error:  # noqa: BLE001 - openpyxl raises many kinds for damaged files
        raise TableError(f"{source}: expected an Excel workbook ({str(error)[:80]})") from None
    frame.columns = [str(name) for name in frame.columns]
    _require_names(list(frame.columns), source)
    return _of_frame(frame, source)


def _read_numpy(data: bytes, source: str) -> Table:
    if zipfile.is_zipfile(io.BytesIO(data)):
        _require_unpacked(data, source)
    try:
        loaded = np.load(io.BytesIO(data), allow_pickle=False)
        arrays = (
            {name: loaded[name] for name in loaded.files}
            if isinstance(loaded, np.lib.npyio.NpzFile)
            else {name: loaded[name] for name in loaded.dtype.names or ()}
        )
    except Exception as error:  # noqa: BLE001 - NumPy raises many kinds for damaged files
        said = str(error)[:80]
        raise TableError(f"{source}: expected NumPy arrays without pickles ({said})") from None
    columns: dict[str, NDArray[np.generic]] = {}
    for name, array in arrays.items():
        if array.ndim == 1:
            columns[name] = array
        elif array.ndim == 2 and array.shape[1] <= MOST_COLUMNS:
            columns |= {f"{name}_{at}": array[:, at] for at in range(array.shape[1])}
        else:
            raise TableError(f"{source}, array {name}: expected one or two axes; got {array.shape}")
    lengths = {len(array) for array in columns.values()}
    if len(lengths) != 1:
        raise TableError(f"{source}: expected arrays of one length by name; got {sorted(lengths)}")
    return _of_frame(pd.DataFrame(columns), source)


def _require_unpacked(data: bytes, source: str) -> None:
    """Refuse an archive whose members say that they unpack to more; no member gives more."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            size = sum(member.file_size for member in archive.infolist())
    except (zipfile.BadZipFile, ValueError, NotImplementedError) as error:
        raise TableError(f"{source}: expected a ZIP archive ({error})") from None
    if size > _MOST_UNPACKED:
        raise TableError(
            f"{source}: expected an archive of at most {_MOST_UNPACKED} bytes unpacked; got {size}"
        )


def _require_cells(rows: int, columns: int, source: str) -> None:
    if rows > MOST_ROWS or columns > MOST_COLUMNS or rows * columns > _MOST_CELLS:
        raise TableError(
            f"{source}: expected at most {MOST_ROWS} rows, {MOST_COLUMNS} columns and "
            f"{_MOST_CELLS} cells; got {rows} rows of {columns} columns"
        )


def _require_names(names: list[str], source: str) -> None:
    if len(names) > MOST_COLUMNS:
        raise TableError(f"{source}: expected at most {MOST_COLUMNS} columns; got {len(names)}")
    if not any(names):
        raise TableError(f"{source}, row 1: expected a header with names of columns")
    for at, name in enumerate(names):
        if not name:
            raise TableError(f"{source}, row 1: column {at + 1} has no name")
        if name in names[:at]:
            raise TableError(f"{source}, row 1: column {name!r} stands twice")
    try:
        [float(name) for name in names]
    except ValueError:
        return
    raise TableError(f"{source}, row 1: expected a header with names of columns; got numbers")
