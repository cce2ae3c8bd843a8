"""Errors sample by sample: two Parquet files a data set, beside the record's tables.

``samples/<dataset>.parquet`` has one row a sample of every cell measured under `CONDITION`
(`COLUMNS`), sorted by extractor, model, unit and sample. ``samples/<dataset>.directions.parquet``
says what the samples are: the direction of the Sun, whether it is observable, and the bound
(`DIRECTION_COLUMNS`). All units of a data set see the same directions; the bound is unit 0's.

An error is kept to a part in 2,000, less than the noise of one answer needs, and NaN says that
there is no answer; `OUTCOMES` says why. The bytes depend on the numbers and the version of pyarrow.
"""

from __future__ import annotations

import io
from base64 import b64decode, b64encode
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from benchmark.contract import Cell
from benchmark.results import record_manifest
from benchmark.results.csv_tables import StoreError
from benchmark.results.store import PUBLISHED
from files.reading import FileRefusedError, read_bytes

if TYPE_CHECKING:
    import pandas as pd

Kind = TypeVar("Kind", bound=np.generic)

#: The condition whose errors are kept.
CONDITION = "nominal"
FOLDER = "samples"

#: Codes of the column `outcome`.
OUTCOMES: Mapping[int, str] = {
    0: "answered",
    1: "no answer: the extractor found no features",
    2: "no answer: the model refused the features, as outside of what it was calibrated for",
}
ANSWERED, NOT_FOUND, REFUSED = OUTCOMES

#: Columns of the errors and of the directions, with the type of each as Arrow spells it.
COLUMNS: Mapping[str, str] = {
    "extractor": "string",
    "model": "string",
    "unit": "int8",
    "sample": "int16",
    "error_deg": "float",
    "outcome": "int8",
}
#: Greatest number that the column `unit` holds.
GREATEST_UNIT = int(np.iinfo(np.int8).max)
DIRECTION_COLUMNS: Mapping[str, str] = {
    "sample": "int16",
    "sun_x": "float",
    "sun_y": "float",
    "sun_z": "float",
    "observable": "bool",
    "bound_deg": "float",
}
_NAMES = ("extractor", "model")
_MANTISSA_BITS = 10  # of 23: a part in 2,000


@dataclass(frozen=True)
class CellErrors:
    """Errors of one cell, as they are kept.

    Attributes
    ----------
    error_deg
        (N,) float32 in degrees, rounded to a part in 2,000; NaN where there is no answer.
    outcome
        (N,) int8, codes of `OUTCOMES`.
    """

    error_deg: NDArray[np.float32]
    outcome: NDArray[np.int8]

    @classmethod
    def of(cls, error_deg: ArrayLike, found: ArrayLike) -> CellErrors:
        """Round errors and say of each missing one why it is.

        Errors (N,) are from 0 to 180 degrees, NaN where the pipeline gave no answer; `found` (N,)
        says whether the extractor found features. ValueError for anything else.
        """
        error = np.asarray(error_deg, dtype=np.float64)
        seen = np.asarray(found, dtype=np.bool_)
        if error.ndim != 1 or not error.size or seen.shape != error.shape:
            raise ValueError(
                f"error_deg and found must have one shape (N,); got {error.shape}, {seen.shape}"
            )
        missing = np.isnan(error)
        if not ((error >= 0.0) & (error <= 180.0) | missing).all():
            raise ValueError("error_deg must be from 0 to 180 degrees, or NaN for no answer")
        outcome = np.where(missing, np.where(seen, REFUSED, NOT_FOUND), ANSWERED)
        return cls(_round_to(error), outcome.astype(np.int8))

    def to_texts(self) -> dict[str, str]:
        """Spell the arrays for a journal, each in base 64."""
        return {"error_deg": _format_value(self.error_deg), "outcome": _format_value(self.outcome)}

    @classmethod
    def read(cls, fields: Mapping[str, str]) -> CellErrors:
        """Read what `parquet_bytes` wrote; ValueError or KeyError for anything else."""
        return cls(_unspelt(fields["error_deg"], np.float32), _unspelt(fields["outcome"], np.int8))


@dataclass(frozen=True)
class Directions:
    """Samples of a data set's test split.

    Attributes
    ----------
    sun
        (N, 3) true unit vectors to the Sun.
    observable
        (N,) of bool: whether the direction can be determined at all.
    bound_deg
        (N,) Cramer-Rao standard deviation of the angle in degrees; not finite where there is none.
    """

    sun: NDArray[Any]
    observable: NDArray[Any]
    bound_deg: NDArray[Any]

    def __post_init__(self) -> None:
        shapes = self.sun.shape, self.observable.shape, self.bound_deg.shape
        count = self.observable.shape
        if len(count) != 1 or not count[0] or shapes != ((*count, 3), count, count):
            raise ValueError(
                "sun, observable and bound_deg must have shapes (N, 3), (N,) and (N,); "
                f"got {', '.join(map(str, shapes))}"
            )

    def to_texts(self) -> dict[str, str]:
        """Spell the arrays for a journal, each in base 64."""
        return {
            "sun": _format_value(np.asarray(self.sun, dtype=np.float64)),
            "observable": _format_value(np.asarray(self.observable, dtype=np.bool_)),
            "bound_deg": _format_value(np.asarray(self.bound_deg, dtype=np.float64)),
        }

    @classmethod
    def read(cls, fields: Mapping[str, str]) -> Directions:
        """Read what `parquet_bytes` wrote; ValueError or KeyError for anything else."""
        return cls(
            _unspelt(fields["sun"], np.float64).reshape(-1, 3),
            _unspelt(fields["observable"], np.bool_),
            _unspelt(fields["bound_deg"], np.float64),
        )


class SampleErrors:
    """Errors that one run measures, collected to be written beside the record."""

    def __init__(self) -> None:
        self.cells: dict[Cell, CellErrors] = {}
        self.directions: dict[str, Directions] = {}

    def add(self, cell: Cell, error_deg: ArrayLike, found: ArrayLike) -> None:
        """Take in a cell's errors, as `CellErrors.of`; ValueError for another condition."""
        self.keep(cell, CellErrors.of(error_deg, found))

    def keep(self, cell: Cell, errors: CellErrors) -> None:
        """Take in a cell's errors; ValueError for another condition than `CONDITION`."""
        if cell.condition != CONDITION:
            raise ValueError(f"errors are kept of {CONDITION!r} alone; got {cell}")
        self.cells[cell] = errors

    def write(self, directory: Path, keep: Callable[[Cell], bool]) -> bool:
        """Write what was collected over what the record has; return whether a file changed.

        Cells that were not measured now stay as they are on disk. Each file is written whole or
        not at all, and only where its numbers change. Directions come with the standard unit: of a
        data set of which other units alone were measured, they are not there yet.

        `keep` says of a cell, collected or on disk, whether the record still has it. StoreError for
        a file that cannot be read: nothing has been written. ValueError where a data set's cells
        have other samples than its directions or each other.
        """
        contents: dict[str, str | bytes | None] = {}
        measured = {cell.dataset for cell in self.cells}
        for name in sorted({*_store(directory), *measured, *self.directions}):
            before = _cells_on_disk(directory, name)
            now = {cell: self.cells[cell] for cell in self.cells if cell.dataset == name}
            wanted = {cell: found for cell, found in (before | now).items() if keep(cell)}
            errors, directions = path_of(name), path_of(name, directions=True)
            if not wanted:
                contents |= {errors: None, directions: None}
                continue
            known = _directions_on_disk(directory, name)
            if name in self.directions:
                known = _of_directions(self.directions[name])
            first = next(iter(wanted.values()))
            _require_samples(wanted, len(first.outcome) if known is None else len(known["sample"]))
            contents |= _change(directory / errors, errors, _of_cells(wanted), COLUMNS)
            if known is not None:
                contents |= _change(directory / directions, directions, known, DIRECTION_COLUMNS)
        return record_manifest.write(directory, contents) if contents else False


def path_of(dataset: str, *, directions: bool = False) -> str:
    """Return where a data set's errors, or its directions, are in a record; relative, POSIX."""
    return f"{FOLDER}/{dataset}{'.directions' if directions else ''}.parquet"


def datasets(directory: Path = PUBLISHED) -> tuple[str, ...]:
    """Return the names of the data sets whose errors a record has, sorted."""
    return tuple(sorted(n for n in _store(directory) if has_samples(n, directory)))


def has_samples(dataset: str, directory: Path = PUBLISHED) -> bool:
    """Say whether a record has the errors of a data set, and what they are errors of."""
    return all((directory / path_of(dataset, directions=d)).is_file() for d in (False, True))


def read_samples(dataset: str, directory: Path = PUBLISHED) -> pd.DataFrame:
    """Return the errors of a data set, sorted by extractor, model, unit and sample.

    Of `COLUMNS`; extractor and model are categories. FileNotFoundError where the record has none of
    this data set; StoreError for a file that is damaged or holds other columns or types.
    """
    return read_parquet(directory / path_of(dataset), COLUMNS, names=_NAMES)


def read_directions(dataset: str, directory: Path = PUBLISHED) -> pd.DataFrame:
    """Return the samples of a data set by number, `DIRECTION_COLUMNS`; raises as `read_parquet`."""
    return read_parquet(directory / path_of(dataset, directions=True), DIRECTION_COLUMNS)


def _format_value(array: NDArray[Any]) -> str:
    return b64encode(array.tobytes()).decode()


def _unspelt(text: str, kind: type[Kind]) -> NDArray[Kind]:
    return np.frombuffer(b64decode(text, validate=True), dtype=kind)


def _round_to(values: NDArray[np.float64]) -> NDArray[np.float32]:
    """Round to `_MANTISSA_BITS` bits behind the point of the mantissa, ties up; NaN stays NaN."""
    spare = 23 - _MANTISSA_BITS
    bits = np.asarray(values, dtype=np.float32).view(np.uint32)
    rounded = ((bits + np.uint32(1 << (spare - 1))) >> spare << spare).view(np.float32)
    return np.where(np.isnan(values), np.float32(np.nan), rounded).astype(np.float32)


def _store(directory: Path) -> set[str]:
    """Return the data sets that a record has files of."""
    return {path.name.partition(".")[0] for path in (directory / FOLDER).glob("*.parquet")}


def _cells_on_disk(directory: Path, dataset: str) -> dict[Cell, CellErrors]:
    try:
        table = read_samples(dataset, directory)
    except FileNotFoundError:
        return {}
    names = [table[name].astype(str).to_numpy() for name in _NAMES]
    unit, error, outcome = (table[name].to_numpy() for name in ("unit", "error_deg", "outcome"))
    starts = [*np.flatnonzero(table["sample"].to_numpy() == 0).tolist(), len(table)]
    return {
        Cell(dataset, CONDITION, str(names[0][a]), str(names[1][a]), int(unit[a])): CellErrors(
            error[a:b], outcome[a:b]
        )
        for a, b in pairwise(starts)
    }


def _directions_on_disk(directory: Path, dataset: str) -> dict[str, Any] | None:
    try:
        table = read_directions(dataset, directory)
    except FileNotFoundError:
        return None
    return {name: table[name].to_numpy() for name in DIRECTION_COLUMNS}


def _of_directions(directions: Directions) -> dict[str, Any]:
    bound = np.asarray(directions.bound_deg, dtype=np.float32)
    sun = np.asarray(directions.sun, dtype=np.float32)
    return {
        "sample": np.arange(len(bound), dtype=np.int16),
        **{f"sun_{axis}": np.ascontiguousarray(sun[:, k]) for k, axis in enumerate("xyz")},
        "observable": np.asarray(directions.observable, dtype=np.bool_),
        "bound_deg": np.where(np.isfinite(bound), bound, np.float32(np.nan)),
    }


def _of_cells(cells: Mapping[Cell, CellErrors]) -> dict[str, Any]:
    ordered = sorted(cells, key=lambda cell: (cell.extractor, cell.model, cell.unit))
    sizes = [cells[cell].error_deg.size for cell in ordered]
    return {
        **{name: np.repeat([getattr(cell, name) for cell in ordered], sizes) for name in _NAMES},
        "unit": np.repeat(np.array([cell.unit for cell in ordered], dtype=np.int8), sizes),
        "sample": np.concatenate([np.arange(size, dtype=np.int16) for size in sizes]),
        "error_deg": np.concatenate([cells[cell].error_deg for cell in ordered]),
        "outcome": np.concatenate([cells[cell].outcome for cell in ordered]),
    }


def _require_samples(cells: Mapping[Cell, CellErrors], count: int) -> None:
    for cell, errors in cells.items():
        if errors.error_deg.size != count:
            raise ValueError(f"{cell} has {errors.error_deg.size} samples; expected {count}")


def _change(
    path: Path, name: str, columns: Mapping[str, Any], types: Mapping[str, str]
) -> dict[str, bytes]:
    """Return a file's new bytes by its name; nothing where it holds these numbers already.

    So that another version of pyarrow does not change a record.
    """
    try:
        held = read_parquet(path, types)
    except FileNotFoundError:
        return {name: parquet_bytes(columns, types)}
    same = len(held) == len(columns["sample"]) and all(
        np.array_equal(held[key].to_numpy(), columns[key], equal_nan=kind == "float")
        for key, kind in types.items()
    )
    return {} if same else {name: parquet_bytes(columns, types)}


#: More rows than a table has; a damaged or hostile file is refused before it fills the memory.
MOST_ROWS = 10_000_000

_ENCODINGS = {"float": "BYTE_STREAM_SPLIT", "int16": "DELTA_BINARY_PACKED", "int8": "PLAIN"}


def read_parquet(
    path: Path, columns: Mapping[str, str], names: Collection[str] = ()
) -> pd.DataFrame:
    """Return a table that has these columns, of these types, and at least one row.

    Columns of text in `names` come as categories.

    FileNotFoundError where there is no file; StoreError for one that is damaged, has other columns
    or types, nulls, no rows or more than `MOST_ROWS`.
    """
    try:
        data = read_bytes(path)
    except FileRefusedError as error:
        raise StoreError(str(error)) from error
    try:
        said, found = _read(data, columns, names)
    except (OSError, ValueError) as error:  # all that Arrow raises for a damaged file
        reason = " ".join(str(error).split())
        raise StoreError(f"{path}: not a whole Parquet file ({reason})") from error
    if found is None:
        raise StoreError(f"{path}: expected {said}")
    return found


def parquet_bytes(columns: Mapping[str, Any], types: Mapping[str, str]) -> bytes:
    """Spell columns as a Parquet file: the same bytes each time, by one version of pyarrow."""
    import pyarrow as pa  # noqa: PLC0415 - as above
    from pyarrow import parquet  # noqa: PLC0415 - as above

    schema = pa.schema(
        [pa.field(name, pa.type_for_alias(kind), nullable=False) for name, kind in types.items()]
    )
    arrays = [pa.array(columns[f.name], type=f.type, from_pandas=False) for f in schema]
    buffer = io.BytesIO()
    parquet.write_table(
        pa.Table.from_arrays(arrays, schema=schema),
        buffer,
        compression="zstd",
        compression_level=19,
        row_group_size=MOST_ROWS,
        use_dictionary=[name for name, kind in types.items() if kind == "string"],
        column_encoding={
            name: _ENCODINGS[kind] for name, kind in types.items() if kind in _ENCODINGS
        },
        write_statistics=False,
        write_page_checksum=True,
        store_schema=False,
    )
    return buffer.getvalue()


def _read(
    data: bytes, columns: Mapping[str, str], names: Collection[str]
) -> tuple[str, pd.DataFrame | None]:
    """Return a table, or what was expected of it and what it is instead."""
    from pyarrow import parquet  # noqa: PLC0415 - a fifth of a second that few commands need

    file = parquet.ParquetFile(io.BytesIO(data))
    held = [(field.name, _type(field.type)) for field in file.schema_arrow]
    rows = file.metadata.num_rows
    if held != list(columns.items()):
        return f"the columns {_list_items(columns.items())}; got {_list_items(held)}", None
    if not 0 < rows <= MOST_ROWS:
        return f"1 to {MOST_ROWS} rows, got {rows}", None
    table = parquet.ParquetFile(
        io.BytesIO(data), read_dictionary=list(names), page_checksum_verification=True
    ).read()
    if any(column.null_count for column in table.columns):
        return "a value in every cell, got nulls", None
    return "", table.to_pandas()


def _type(kind: Any) -> str:
    return str(getattr(kind, "value_type", kind))


def _list_items(columns: Collection[tuple[str, str]]) -> str:
    return ", ".join(f"{name} ({kind})" for name, kind in columns) or "none"
