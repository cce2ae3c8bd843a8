"""Tables as Parquet, for whoever reads columns."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import cast

from api.deposit.typed import TypedTable


class MissingLibraryError(ImportError):
    """A library that only the deposit needs is not installed; the message says how."""


def write_parquet(table: TypedTable, path: Path) -> None:
    """Write a table; the same bytes each time, by one version of pyarrow.

    Raises
    ------
    MissingLibraryError
        Where pyarrow is not installed.
    """
    arrow = _arrow()
    from pyarrow import parquet  # noqa: PLC0415 - half a second that only building takes

    types = {
        "string": arrow.string(),
        "integer": arrow.int64(),
        "year": arrow.int64(),
        "number": arrow.float64(),
        "boolean": arrow.bool_(),
    }
    fields = [
        arrow.field(
            field["name"],
            types[field["type"]],
            metadata={"description": field.get("description", "")},
        )
        for field in table.fields
    ]
    arrays = [
        arrow.array(column, type=field.type)
        for column, field in zip(table.columns.values(), fields, strict=True)
    ]
    described = {"title": table.resource["title"], "description": table.resource["description"]}
    path.parent.mkdir(parents=True, exist_ok=True)
    made = arrow.Table.from_arrays(arrays, schema=arrow.schema(fields, metadata=described))
    parquet.write_table(made, path, compression="zstd")


def _arrow() -> ModuleType:
    try:
        import pyarrow as pa  # noqa: PLC0415 - as above
    except ImportError as error:
        raise MissingLibraryError(
            "building the bundle needs pyarrow: pip install 'sun-sensor-atlas[deposit]'"
        ) from error
    return cast("ModuleType", pa)
