"""Tables of numbers as Parquet: read strictly, and spelt the same each time.

Types are spelt as Arrow spells them: ``string``, ``bool``, ``int8``, ``int16``, ``float``.
"""

from __future__ import annotations

import io
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from benchmark.results.tables import StoreError
from survey_data.file_bytes import FileRefusedError, read_bytes

if TYPE_CHECKING:
    import pandas as pd

#: More rows than a table has; a damaged or hostile file is refused before it fills the memory.
MOST_ROWS = 10_000_000


def read(path: Path, columns: Mapping[str, str], names: Collection[str] = ()) -> pd.DataFrame:
    """Return a table that has these columns, of these types, and at least one row.

    Parameters
    ----------
    path
        Of the file.
    columns
        Type by name, in order.
    names
        Columns of text that repeat, to be returned as categories.

    Raises
    ------
    FileNotFoundError
        Where there is no file.
    StoreError
        For a file that is damaged, has other columns or types, nulls, no rows or more than
        `MOST_ROWS`.
    """
    import pyarrow as pa  # noqa: PLC0415 - a fifth of a second that few commands need
    from pyarrow import parquet  # noqa: PLC0415 - as above

    try:
        data = read_bytes(path)
    except FileRefusedError as error:
        raise StoreError(str(error)) from error
    try:
        file = parquet.ParquetFile(
            io.BytesIO(data), read_dictionary=list(names), page_checksum_verification=True
        )
        held = [(field.name, _type(field.type)) for field in file.schema_arrow]
        if held != list(columns.items()):
            raise StoreError(
                f"{path}: expected the columns {_listed(columns.items())}; got {_listed(held)}"
            )
        if not 0 < file.metadata.num_rows <= MOST_ROWS:
            raise StoreError(
                f"{path}: expected 1 to {MOST_ROWS} rows, got {file.metadata.num_rows}"
            )
        table = file.read()
        if any(column.null_count for column in table.columns):
            raise StoreError(f"{path}: expected a value in every cell, got nulls")
        return table.to_pandas()
    except (pa.ArrowException, OSError) as error:
        reason = " ".join(str(error).split())
        raise StoreError(f"{path}: not a whole Parquet file ({reason})") from error


def spelt(columns: Mapping[str, Any], types: Mapping[str, str]) -> bytes:
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
        compression_level=9,
        row_group_size=MOST_ROWS,
        use_dictionary=[name for name, kind in types.items() if kind == "string"],
        column_encoding={
            name: "BYTE_STREAM_SPLIT" if kind == "float" else "DELTA_BINARY_PACKED"
            for name, kind in types.items()
            if kind in {"float", "int8", "int16"}
        },
        write_statistics=False,
        write_page_checksum=True,
        store_schema=False,
    )
    return buffer.getvalue()


def _type(kind: Any) -> str:
    return str(getattr(kind, "value_type", kind))


def _listed(columns: Collection[tuple[str, str]]) -> str:
    return ", ".join(f"{name} ({kind})" for name, kind in columns) or "none"
