"""Tables of numbers as Parquet: read strictly, and spelt the same each time.

Types are spelt as Arrow spells them: ``string``, ``bool``, ``int8``, ``int16``, ``float``.
"""

from __future__ import annotations

import io
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from benchmark.results.csv_tables import StoreError
from files.reading import FileRefusedError, read_bytes

if TYPE_CHECKING:
    import pandas as pd

#: More rows than a table has; a damaged or hostile file is refused before it fills the memory.
MOST_ROWS = 10_000_000

_ENCODINGS = {"float": "BYTE_STREAM_SPLIT", "int16": "DELTA_BINARY_PACKED", "int8": "PLAIN"}


def read_parquet(
    path: Path, columns: Mapping[str, str], names: Collection[str] = ()
) -> pd.DataFrame:
    """Return a table that has these columns, of these types, and at least one row.

    Columns of text in `names` come as categories.

    Raises
    ------
    FileNotFoundError
        Where there is no file.
    StoreError
        For a file that is damaged, has other columns or types, nulls, no rows or more than
        `MOST_ROWS`.
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
