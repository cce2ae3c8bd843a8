"""Tables as Parquet, for whoever reads columns."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from api.deposit.typed_tables import TypedTable


def write_parquet(table: TypedTable, path: Path) -> None:
    """Write a table; the same bytes each time, by one version of pyarrow."""
    from pyarrow import parquet  # noqa: PLC0415 - half a second that only building takes

    path.parent.mkdir(parents=True, exist_ok=True)
    parquet.write_table(arrow_table(table), path, compression="zstd")


def arrow_table(table: TypedTable) -> Any:
    """Return a table as pyarrow has it, with what its columns mean (pyarrow.Table)."""
    import pyarrow as pa  # noqa: PLC0415 - as above

    types = {
        "string": pa.string(),
        "integer": pa.int64(),
        "year": pa.int64(),
        "number": pa.float64(),
        "boolean": pa.bool_(),
    }
    fields = [
        pa.field(
            field["name"],
            types[field["type"]],
            metadata={"description": field.get("description", "")},
        )
        for field in table.fields
    ]
    arrays = [
        pa.array(column, type=field.type)
        for column, field in zip(table.columns.values(), fields, strict=True)
    ]
    described = {"title": table.resource["title"], "description": table.resource["description"]}
    return pa.Table.from_arrays(arrays, schema=pa.schema(fields, metadata=described))
