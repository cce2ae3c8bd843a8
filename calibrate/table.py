"""A reader's file as named columns of numbers: text, Parquet, NumPy or Excel."""

from __future__ import annotations

import io
import math
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from calibrate.forms.cells import numbers_of
from calibrate.forms.text import (
    Cells,
    TableError,
    cells_of_text,
    cells_of_workbook,
    extent_of_workbook,
)
from calibrate.forms.units import named, unit_of
from calibrate.settings import FileSettings
from files.reading import read_bytes

__all__ = ["SUFFIXES", "Table", "TableError", "read_table"]

#: Largest file, and most rows and columns that are read of one.
LARGEST, MOST_ROWS, MOST_COLUMNS = 256 * 1024 * 1024, 2_000_000, 500
#: Bytes that a file may unpack to, and the text of its cells take; cells of a table.
_MOST_UNPACKED, _MOST_CELLS = 1024 * 1024 * 1024, 60_000_000
_AT_ONCE = 64 * 1024 * 1024
#: Rows and cells of all sheets of a workbook, of which each takes 10 us to read.
_MOST_OF_WORKBOOK = 5_000_000
#: Endings of the files that are read.
SUFFIXES = (".csv", ".txt", ".tsv", ".dat", ".asc", ".parquet", ".npz", ".npy", ".xlsx")


@dataclass(frozen=True)
class Table:
    """Columns of a file.

    Float columns (n,), or text columns (n,) where a cell is not a number. Angles of degrees,
    minutes and seconds are degrees; dates are seconds since 1970. Units are those that a name,
    cells or a row say, as `calibrate.forms.units` spells them; ``unix`` of dates.
    """

    columns: Mapping[str, NDArray[np.generic]]
    first_row: int  # of data, as counted in the file; the header is row 1
    source: str  # name of the file
    unread: Mapping[str, tuple[int, str]]  # of text: first row that is no number, and its cell
    units: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()  # how the file was read, without an end
    row_numbers: NDArray[np.int64] | None = None  # (n,), where rows between were left out
    header_row: int = 1  # in the file, 0 where there is none

    def numbers(self, name: str) -> NDArray[np.float64]:
        """Return a column of numbers; TableError naming row and column otherwise."""
        if name not in self.columns:
            from survey_data.nearest import nearest_name  # noqa: PLC0415 - for a message only

            near = nearest_name(name, self.columns)
            hint = f"; did you mean {near!r}?" if near else ""
            raise TableError(
                f"{self.source}: no column {name!r:.60}{hint} "
                f"(there are {', '.join(self.columns):.1000})"
            )
        if name in self.unread:
            row, cell = self.unread[name]
            raise TableError(
                f"{self.source}, row {row}, column {name}: expected a number; got {cell[:40]!r}"
            )
        return np.asarray(self.columns[name], dtype=np.float64)

    @property
    def rows(self) -> NDArray[np.int64]:
        """Number of each row of data in the file."""
        if self.row_numbers is not None:
            return self.row_numbers
        return np.arange(len(self), dtype=np.int64) + self.first_row

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), ()))


def read_table(path: Path, stated: FileSettings | None = None) -> Table:
    """Read a file of readings.

    Parameters
    ----------
    path : Path
        Text (``.csv``, ``.txt``, ``.tsv``, ``.dat``, ``.asc``) with commas, semicolons, tabs, bars
        or blanks between cells, ``.parquet``, ``.npz`` (by name), ``.npy`` (structured), ``.xlsx``.
    stated : FileSettings, optional
        What is known of the layout of text or a workbook; the rest is found.

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
    kind = path.suffix.lower()
    if kind not in SUFFIXES:
        raise TableError(
            f"{path.name}: expected a file of {', '.join(SUFFIXES)}; got {kind or 'none'}"
        )
    data = read_bytes(path, LARGEST)
    if not data:
        raise TableError(f"{path.name}: the file is empty")
    table = _read(data, path.name, kind, stated or FileSettings())
    if not len(table):
        raise TableError(f"{path.name}: there are no rows under the header")
    return table


def _read(data: bytes, source: str, kind: str, stated: FileSettings) -> Table:
    if kind == ".parquet":
        return _read_parquet(data, source)
    if kind in (".npz", ".npy"):
        return _read_numpy(data, source)
    if kind == ".xlsx":
        return _read_excel(data, source, stated)
    return _of_cells(cells_of_text(data, source, stated, MOST_ROWS), source)


def _of_cells(cells: Cells, source: str) -> Table:
    """Return a table of cells, its columns named and their units said."""
    names, said, frame = _names(cells, source)
    units: dict[str, str] = {}
    for name, cell in zip(names, cells.units or [""] * len(names), strict=False):
        if name and (unit := unit_of(cell)):
            units[name] = unit
    frame.columns = pd.Index(names)
    frame = frame[[name for name in names if name]]
    first = int(cells.rows[0]) if len(cells.rows) else 2
    notes = (*cells.notes, *said)
    return _of_frame(
        frame, source, cells.decimal, units, notes, (first, cells.rows, cells.header_row)
    )


def _names(cells: Cells, source: str) -> tuple[list[str], list[str], pd.DataFrame]:
    """Return names of columns, an empty one of those left out, and what was done to them."""
    frame = cells.frame.copy()
    given = list(cells.names) or [f"column_{at + 1}" for at in range(frame.shape[1])]
    if cells.header_row and not any(given):
        raise TableError(
            f"{source}, row {cells.header_row}: expected a header with names of columns"
        )
    said: list[str] = []
    for at, name in enumerate(given):
        if name:
            continue
        if len(frame) and not frame.iloc[:, at].str.strip().any():
            said.append(f"column {at + 1}, which is empty, is left out")
        else:
            given[at] = f"column_{at + 1}"
            said.append(f"column {at + 1} has no name and is called {given[at]}")
    _require_names([name for name in given if name], source)
    return given, said, frame


def table_of(frame: pd.DataFrame, source: str) -> Table:
    """Return a data frame as a table whose rows count from 0."""
    named = frame.set_axis([str(name) for name in frame.columns], axis=1)
    _require_names(list(named.columns), source)
    return _of_frame(named, source, place=(0, None, 0))


def _of_frame(  # noqa: PLR0917 - what a table is made of
    frame: pd.DataFrame,
    source: str,
    decimal: str = ".",
    stated: Mapping[str, str] | None = None,
    notes: Sequence[str] = (),
    place: tuple[int, NDArray[np.int64] | None, int] = (2, None, 1),
) -> Table:
    columns: dict[str, NDArray[np.generic]] = {}
    unread: dict[str, tuple[int, str]] = {}
    units = dict(stated or {})
    said = list(notes)
    size = 0
    first_row, rows, header = place
    for name in frame.columns:
        column = frame[name]
        read = named(str(name))
        if read.unit and name not in units:
            units[name] = read.unit
        if column.dtype.kind in "iufb":
            columns[name] = column.to_numpy(dtype=np.float64, na_value=np.nan)
            continue
        text = _as_text(column)
        found = numbers_of(text, decimal, of_time="time" in read.bare)
        if found.wrong.any():
            lengths = text.str.len()
            size += 4 * len(text) * int(lengths.max())  # an array gives each cell the same room
            at = int(np.argmax(lengths if size > _MOST_UNPACKED else found.wrong))
            row = int(rows[at]) if rows is not None else at + first_row
            if size > _MOST_UNPACKED:
                raise TableError(
                    f"{source}, row {row}, column {name}: expected a short text; got one of "
                    f"{lengths.iloc[at]} characters in a column of {len(text)} cells"
                )
            unread[name] = (row, text.iloc[at])
            columns[name] = text.to_numpy(dtype=str)
            continue
        columns[name] = found.values
        if found.unit:
            units[name] = found.unit
        if found.note:
            said.append(f"column {name} holds {found.note}")
    return Table(columns, first_row, source, unread, units, tuple(said), rows, header)


def _as_text(column: pd.Series[str]) -> pd.Series[str]:
    """Cells as text without blanks around them; bytes as the text that they spell."""
    if column.dtype.kind == "m":
        return pd.to_timedelta(column).dt.total_seconds().map(str)
    if column.dtype.kind == "M":
        stamps = pd.to_datetime(column, utc=True)
        return stamps.dt.strftime("%Y-%m-%dT%H:%M:%S.%f").fillna("").astype(str)
    if column.dtype == object:
        column = column.map(
            lambda cell: cell.decode("utf-8", "replace") if isinstance(cell, bytes) else cell
        )
    return column.astype(object).fillna("").map(str).str.strip()


def _read_parquet(data: bytes, source: str) -> Table:
    try:
        _require_columns(data, source)
        frame = pd.read_parquet(io.BytesIO(data))
    except TableError:
        raise
    except Exception as error:  # noqa: BLE001 - pyarrow raises many kinds for damaged files
        raise TableError(f"{source}: expected a Parquet file ({str(error)[:80]})") from None
    _require_names([str(name) for name in frame.columns], source)
    frame.columns = [str(name) for name in frame.columns]
    return _of_frame(frame, source)


def _require_columns(data: bytes, source: str) -> None:
    """Refuse what a Parquet file states, and text that unfolds to more: it holds a value once."""
    from pyarrow.parquet import ParquetFile  # noqa: PLC0415 - for such files only
    from pyarrow.types import is_dictionary  # noqa: PLC0415

    file = ParquetFile(io.BytesIO(data))
    stated = file.metadata
    _require_cells(stated.num_rows, stated.num_columns, source)
    groups = [stated.row_group(at) for at in range(stated.num_row_groups)]
    chunks = [group.column(at) for group in groups for at in range(group.num_columns)]
    if (cells := sum(chunk.num_values for chunk in chunks)) > _MOST_CELLS:  # lists, in cells
        raise TableError(f"{source}: expected at most {_MOST_CELLS} cells; got {cells}")
    _require_bytes(sum(chunk.total_uncompressed_size for chunk in chunks), source)
    texts = [chunk for chunk in chunks if chunk.physical_type == "BYTE_ARRAY"]
    if not texts:
        return
    longest = max(chunk.total_uncompressed_size for chunk in texts)  # no value is longer
    rows = min(max(_AT_ONCE // max(longest, 1), 1), 10_000)
    size = 0
    for batch in file.iter_batches(rows, columns=sorted({chunk.path_in_schema for chunk in texts})):
        for column in batch.columns:
            each = column.dictionary_decode() if is_dictionary(column.type) else column
            _require_bytes(size := size + each.nbytes, source)


def _require_bytes(size: int, source: str) -> None:
    if size > _MOST_UNPACKED:
        raise TableError(f"{source}: expected at most {_MOST_UNPACKED} bytes unpacked; got {size}")


def _read_excel(data: bytes, source: str, stated: FileSettings) -> Table:
    _require_unpacked(data, source)
    try:
        rows, columns, elements = extent_of_workbook(data, _MOST_OF_WORKBOOK)
    except Exception as error:  # noqa: BLE001 - zipfile raises many kinds for damaged files
        raise TableError(f"{source}: expected an Excel workbook ({str(error)[:80]})") from None
    _require_cells(rows, columns, source)
    if elements > _MOST_OF_WORKBOOK:
        raise TableError(
            f"{source}: expected at most {_MOST_OF_WORKBOOK} rows and cells in a workbook, filled "
            "or empty; got more: save the sheet as CSV"
        )
    return _of_cells(cells_of_workbook(data, source, stated, MOST_ROWS), source)


def _read_numpy(data: bytes, source: str) -> Table:
    if zipfile.is_zipfile(io.BytesIO(data)):
        _require_unpacked(data, source)
    try:
        _require_arrays(data, source)
        loaded = np.load(io.BytesIO(data), allow_pickle=False)
        arrays = (
            {name: loaded[name] for name in loaded.files}
            if isinstance(loaded, np.lib.npyio.NpzFile)
            else {name: loaded[name] for name in loaded.dtype.names or ()}
        )
    except TableError:
        raise
    except Exception as error:  # noqa: BLE001 - NumPy raises many kinds for damaged files
        said = str(error)[:80]
        raise TableError(f"{source}: expected NumPy arrays without pickles ({said})") from None
    columns: dict[str, NDArray[np.generic]] = {}
    for name, array in arrays.items():
        if array.dtype.kind not in "biufSUMm":
            raise TableError(
                f"{source}, array {name}: expected numbers or text; got type {array.dtype}"
            )
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


def _require_arrays(data: bytes, source: str) -> None:
    """Refuse arrays by their heads, before room is made for what they say that they hold."""
    if not zipfile.is_zipfile(io.BytesIO(data)):
        _require_array(io.BytesIO(data), source)
        return
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        for name in archive.namelist():
            with archive.open(name) as file:
                _require_array(file, f"{source}, array {name.removesuffix('.npy')}")


def _require_array(file: IO[bytes], source: str) -> None:
    version = np.lib.format.read_magic(file)
    read = np.lib.format.read_array_header_1_0
    if version != (1, 0):
        read = np.lib.format.read_array_header_2_0
    shape, _, dtype = read(file)
    rows, *others = shape or (1,)
    _require_cells(rows, math.prod(others) * len(dtype.names or (0,)), source)
    size = math.prod(shape) * dtype.itemsize
    _require_bytes(size, source)


def _require_unpacked(data: bytes, source: str) -> None:
    """Refuse an archive whose members say that they unpack to more; no member gives more."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            size = sum(member.file_size for member in archive.infolist())
    except (zipfile.BadZipFile, ValueError, NotImplementedError) as error:
        raise TableError(f"{source}: expected a ZIP archive ({error})") from None
    _require_bytes(size, source)


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
