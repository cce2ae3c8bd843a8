"""Every table in one SQLite file: typed, keyed, with its own dictionary; Datasette opens it.

Names are plain words that need no quotes. `tables_of_the_atlas` and `columns_of_the_atlas` say what
each table and column holds.
"""

from __future__ import annotations

import re
import sqlite3
from collections.abc import Iterable, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import pyarrow as pa

DATABASE = "sun-sensor-atlas.sqlite"
TABLES, COLUMNS = "tables_of_the_atlas", "columns_of_the_atlas"
_TYPES = {
    "string": "TEXT",
    "integer": "INTEGER",
    "year": "INTEGER",
    "number": "REAL",
    "boolean": "INTEGER",
}
#: Words of SQL itself, and what stands for them.
_RENAMED = {"references": "survey_references", "table": "table_name", "group": "group_name"}
_NAME = re.compile(r"[a-z][a-z0-9_]*")

Described = tuple[Mapping[str, Any], pa.Table]
"""A table with its entry in datapackage.json."""


def write_database(tables: Sequence[Described], path: Path) -> None:
    """Write all tables into a new SQLite file; the same bytes each time, by one SQLite.

    Raises
    ------
    ValueError
        For a name that would need quotes.
    sqlite3.IntegrityError
        Where a key is not unique, or refers to nothing.
    OSError
        Where the file cannot be written.
    """
    try:
        with closing(sqlite3.connect(path)) as base:
            _write(base, tables)
            base.commit()
            base.execute("VACUUM")
    except sqlite3.OperationalError as error:
        raise OSError(f"{path}: {error}") from error


def _write(base: sqlite3.Connection, tables: Sequence[Described]) -> None:
    base.execute("PRAGMA journal_mode = OFF")
    base.execute("PRAGMA foreign_keys = OFF")  # tables come before those that they refer to
    for resource, table in tables:
        base.execute(_create(resource))
        _insert(base, sql_name(resource["name"]), zip(*table.to_pydict().values(), strict=True))
    _describe(base, [resource for resource, _ in tables])
    for resource, _ in tables:
        name = sql_name(resource["name"])
        for key in resource["schema"].get("foreignKeys", ()):
            columns = [sql_name(field) for field in key["fields"]]
            index = f"{name}_by_{'_'.join(columns)}"
            base.execute(f"CREATE INDEX {index} ON {name} ({', '.join(columns)})")
    broken = base.execute("PRAGMA foreign_key_check").fetchall()
    if broken:
        raise sqlite3.IntegrityError(f"{broken[0][0]}, row {broken[0][1]}: refers to nothing")


def sql_name(name: str) -> str:
    """Return the name of a table or column in the database; ValueError for no plain word."""
    found = _RENAMED.get(name, name)
    if not _NAME.fullmatch(found):
        raise ValueError(f"{name!r} is no plain name in SQL; give it one in {__name__}")
    return found


def _create(resource: Mapping[str, Any]) -> str:
    schema = resource["schema"]
    keys = schema.get("primaryKey", ())
    parts = [
        f"{sql_name(field['name'])} {_TYPES[field['type']]}"
        + (
            " NOT NULL"
            if field["name"] in keys or field.get("constraints", {}).get("required")
            else ""
        )
        for field in schema["fields"]
    ]
    if keys:
        parts.append(f"PRIMARY KEY ({_names(keys)})")
    for key in schema.get("foreignKeys", ()):
        to = key["reference"]
        parts.append(
            f"FOREIGN KEY ({_names(key['fields'])}) REFERENCES "
            f"{sql_name(to['resource'])} ({_names(to['fields'])})"
        )
    return f"CREATE TABLE {sql_name(resource['name'])} (\n  " + ",\n  ".join(parts) + "\n)"


def _names(names: Iterable[str]) -> str:
    return ", ".join(sql_name(name) for name in names)


def _describe(base: sqlite3.Connection, resources: Sequence[Mapping[str, Any]]) -> None:
    base.execute(
        f"CREATE TABLE {TABLES} (name TEXT NOT NULL PRIMARY KEY, title TEXT NOT NULL, "
        "description TEXT NOT NULL, licence TEXT NOT NULL, file TEXT NOT NULL)"
    )
    base.execute(
        f"CREATE TABLE {COLUMNS} (name TEXT NOT NULL, column_name TEXT NOT NULL, "
        "kind TEXT NOT NULL, description TEXT NOT NULL, PRIMARY KEY (name, column_name), "
        f"FOREIGN KEY (name) REFERENCES {TABLES} (name))"
    )
    for one in resources:
        name = sql_name(one["name"])
        licence = one["licenses"][0]["name"]
        _insert(base, TABLES, [(name, one["title"], one["description"], licence, one["path"])])
        fields = one["schema"]["fields"]
        columns = [(name, sql_name(f["name"]), f["type"], f.get("description", "")) for f in fields]
        _insert(base, COLUMNS, columns)


def _insert(base: sqlite3.Connection, name: str, rows: Iterable[Sequence[Any]]) -> None:
    rows = list(rows)
    if rows:
        places = ", ".join("?" * len(rows[0]))
        base.executemany(f"INSERT INTO {name} VALUES ({places})", rows)  # noqa: S608 - plain names
