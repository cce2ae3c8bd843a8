"""Every table in one SQLite file: typed, keyed, with its own dictionary; Datasette opens it.

Names are plain words that need no quotes. `tables_of_the_atlas` and `columns_of_the_atlas` say what
each table and column holds.
"""

from __future__ import annotations

import errno
import os
import re
import sqlite3
from collections.abc import Iterable, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

from api.deposit.typed_tables import TypedTable, Value

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
#: What SQLite says of a disk that is full or fails, and what the system calls it.
_CANNOT_WRITE = {sqlite3.SQLITE_FULL: errno.ENOSPC, sqlite3.SQLITE_IOERR: errno.EIO}
_NAME = re.compile(r"[a-z][a-z0-9_]*")


class NameNotPlainError(ValueError):
    """A table or column has a name that SQL reads as something else."""


def write_database(tables: Sequence[TypedTable], path: Path) -> None:
    """Write all tables into a new SQLite file; the same bytes each time.

    Raises
    ------
    NameNotPlainError
        For a name that would need quotes.
    sqlite3.IntegrityError
        Where a key is not unique, or refers to nothing.
    OSError
        Where the disk is full.
    """
    try:
        _write(tables, path)
    except sqlite3.OperationalError as error:
        if error.sqlite_errorcode & 0xFF not in _CANNOT_WRITE:
            raise
        number = _CANNOT_WRITE[error.sqlite_errorcode & 0xFF]
        raise OSError(number, os.strerror(number), str(path)) from error
    _without_version(path)


def _write(tables: Sequence[TypedTable], path: Path) -> None:
    with closing(sqlite3.connect(path)) as base:
        base.execute("PRAGMA journal_mode = OFF")
        base.execute("PRAGMA foreign_keys = OFF")  # tables come before those that they refer to
        for table in tables:
            base.execute(_create(table))
            _insert(base, sql_name(table.name), table.rows)
        _describe(base, tables)
        for table in tables:
            for key in table.resource["schema"].get("foreignKeys", ()):
                _index(base, table, key["fields"])
        broken = base.execute("PRAGMA foreign_key_check").fetchall()
        if broken:
            raise sqlite3.IntegrityError(f"{broken[0][0]}, row {broken[0][1]}: refers to nothing")
        base.commit()
        base.execute("VACUUM")


def sql_name(name: str) -> str:
    """Return the name of a table or column in the database.

    Raises
    ------
    NameNotPlainError
        Where it is no plain word.
    """
    found = _RENAMED.get(name, name)
    if _NAME.fullmatch(found):
        with closing(sqlite3.connect(":memory:")) as base:
            try:
                base.execute(f"CREATE TABLE {found} ({found})")
            except sqlite3.OperationalError:
                pass
            else:
                return found
    raise NameNotPlainError(f"{name!r} is no plain name in SQL; give it one in {__name__}")


def _create(table: TypedTable) -> str:
    schema = table.resource["schema"]
    required = {f["name"] for f in table.fields if f.get("constraints", {}).get("required")}
    required |= set(schema.get("primaryKey", ()))
    parts = [
        f"{sql_name(field['name'])} {_TYPES[field['type']]}"
        + (" NOT NULL" if field["name"] in required else "")
        for field in table.fields
    ]
    if schema.get("primaryKey"):
        parts.append(f"PRIMARY KEY ({_name_of(schema['primaryKey'])})")
    for key in schema.get("foreignKeys", ()):
        to = key["reference"]
        parts.append(
            f"FOREIGN KEY ({_name_of(key['fields'])}) REFERENCES "
            f"{sql_name(to['resource'])} ({_name_of(to['fields'])})"
        )
    return f"CREATE TABLE {sql_name(table.name)} (\n  " + ",\n  ".join(parts) + "\n)"


def _name_of(names: Iterable[str]) -> str:
    return ", ".join(sql_name(name) for name in names)


def _index(base: sqlite3.Connection, table: TypedTable, fields: Sequence[str]) -> None:
    name = sql_name(table.name)
    columns = [sql_name(field) for field in fields]
    base.execute(f"CREATE INDEX {name}_by_{'_'.join(columns)} ON {name} ({', '.join(columns)})")


def _describe(base: sqlite3.Connection, tables: Sequence[TypedTable]) -> None:
    base.execute(
        f"CREATE TABLE {TABLES} (name TEXT NOT NULL PRIMARY KEY, title TEXT NOT NULL, "
        "description TEXT NOT NULL, licence TEXT NOT NULL, file TEXT NOT NULL)"
    )
    base.execute(
        f"CREATE TABLE {COLUMNS} (name TEXT NOT NULL, column_name TEXT NOT NULL, "
        "kind TEXT NOT NULL, description TEXT NOT NULL, PRIMARY KEY (name, column_name), "
        f"FOREIGN KEY (name) REFERENCES {TABLES} (name))"
    )
    _insert(base, TABLES, [_table_row(table.resource) for table in tables])
    _insert(
        base,
        COLUMNS,
        [
            (sql_name(table.name), sql_name(f["name"]), f["type"], f.get("description", ""))
            for table in tables
            for f in table.fields
        ],
    )


def _table_row(resource: Mapping[str, Any]) -> tuple[Value, ...]:
    licence = resource["licenses"][0]["name"]
    row = (resource["title"], resource["description"], licence, resource["path"])
    return (sql_name(resource["name"]), *row)


def _insert(base: sqlite3.Connection, name: str, rows: Sequence[Sequence[Value]]) -> None:
    if rows:
        places = ", ".join("?" * len(rows[0]))
        base.executemany(f"INSERT INTO {name} VALUES ({places})", rows)  # noqa: S608 - plain names


def _without_version(path: Path) -> None:
    # Which SQLite wrote the file stands in bytes 96 to 99 of its header, for people to read only
    # (sqlite.org/fileformat.html, 1.3.1): another patch level would make other bytes.
    with path.open("r+b") as file:
        file.seek(96)
        file.write(bytes(4))
