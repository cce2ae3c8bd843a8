"""Tables of a bundle in other forms, Parquet and SQLite: written, and held against the CSV.

They are made of the CSV and the descriptor that the bundle holds, so that the three cannot differ.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Mapping
from contextlib import closing
from pathlib import Path
from typing import Any

import pyarrow as pa
from pyarrow import csv, parquet

from api.deposit.database import DATABASE, write_database
from files.atomic import temporary_directory
from files.checksums import contents

Problem = tuple[str, str]
FOLDER = "parquet"
_TYPES = {
    "string": pa.string(),
    "integer": pa.int64(),
    "year": pa.int64(),
    "number": pa.float64(),
    "boolean": pa.bool_(),
}


class CellError(ValueError):
    """A table is not what its descriptor says; the message names file, row and column."""


def typed_table(bundle: Path, resource: Mapping[str, Any]) -> pa.Table:
    """Read a table of a bundle with types and meanings of its columns, null where a cell is empty.

    Raises
    ------
    CellError
        Where columns are others than the descriptor's, or a cell is not of its column's type.
    """
    path = bundle / resource["path"]
    fields = [
        pa.field(
            field["name"],
            _TYPES[field["type"]],
            metadata={"description": field.get("description", "")},
        )
        for field in resource["schema"]["fields"]
    ]
    described = {"title": resource["title"], "description": resource["description"]}
    schema = pa.schema(fields, metadata=described)
    try:
        read = csv.read_csv(
            path,
            read_options=csv.ReadOptions(use_threads=False),  # or an error names no row
            parse_options=csv.ParseOptions(newlines_in_values=True),
            convert_options=csv.ConvertOptions(
                column_types=schema,
                null_values=[""],
                strings_can_be_null=True,
                true_values=["true"],
                false_values=["false"],
            ),
        )
    except pa.ArrowInvalid as error:
        raise CellError(f"{path}: {error}") from error
    if read.column_names != schema.names:
        raise CellError(f"{path}: columns are {read.column_names}, described are {schema.names}")
    return pa.Table.from_arrays(read.combine_chunks().columns, schema=schema)


def write_other_forms(bundle: Path, descriptor: Mapping[str, Any], out: Path | None = None) -> None:
    """Write the tables of a bundle as Parquet and SQLite, too; into `out`, the bundle by default.

    Raises
    ------
    CellError, ValueError, sqlite3.Error
        Where the tables are not what the descriptor says, or their keys do not hold.
    """
    resources = [one for one in descriptor["resources"] if one.get("type") == "table"]
    tables = [(resource, typed_table(bundle, resource)) for resource in resources]
    folder = (out or bundle) / FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    for resource, table in tables:
        parquet.write_table(table, folder / f"{resource['name']}.parquet", compression="zstd")
    write_database(tables, (out or bundle) / DATABASE)


def of_forms(bundle: Path, package: Mapping[str, Any], listed: Mapping[str, str]) -> list[Problem]:
    """Say where Parquet and SQLite hold other than the tables: (file, what is wrong with it)."""
    with temporary_directory() as made:
        try:
            write_other_forms(bundle, package, made)
        except (ValueError, LookupError, TypeError, OSError, sqlite3.Error) as error:
            said = str(error).removeprefix(f"{bundle}/")
            return [("datapackage.json", f"no other form can be made of the tables ({said})")]
        expected = set(contents(made))
        there = {name for name in listed if name.startswith(f"{FOLDER}/") or name == DATABASE}
        wrong = [(name, "no table of this bundle") for name in sorted(there - expected)]
        wrong += [(name, "missing") for name in sorted(expected - there)]
        wrong += [
            (name, text)
            for name in sorted(there & expected)
            if (text := unlike(bundle / name, made / name))
        ]
    return wrong


def unlike(path: Path, made: Path) -> str:
    """Say in what a Parquet file or a database differs from one made here; "" where it does not."""
    if path.read_bytes() == made.read_bytes():
        return ""
    try:
        same = (_same_tables if path.suffix == ".sqlite" else _same_parquet)(path, made)
    except Exception as error:  # noqa: BLE001 - whatever a mangled file leads its reader to
        return f"cannot be read to its end ({' '.join(str(error).split())[:160]!r})"
    return "" if same else "holds other tables than the CSV of this bundle"


def _same_parquet(path: Path, made: Path) -> bool:
    one, other = parquet.read_table(path), parquet.read_table(made)
    return bool(one.schema.equals(other.schema, check_metadata=True)) and bool(one.equals(other))


def _same_tables(path: Path, made: Path) -> bool:
    with closing(_opened(path)) as theirs, closing(_opened(made)) as ours:
        schema = "SELECT type, name, tbl_name, sql FROM sqlite_schema ORDER BY type, name"
        wanted = ours.execute(schema).fetchall()
        if theirs.execute(schema).fetchall() != wanted:
            return False
        rows = (
            f'SELECT * FROM "{name}" ORDER BY rowid'  # noqa: S608 - a name of our own
            for kind, name, *_ in wanted
            if kind == "table"
        )
        return all(theirs.execute(row).fetchall() == ours.execute(row).fetchall() for row in rows)


def _opened(path: Path) -> sqlite3.Connection:
    """Open a database to be read, whatever it is: nothing in it is run, nothing beside it read."""
    base = sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro&immutable=1", uri=True)
    base.execute("PRAGMA trusted_schema = OFF")
    return base
