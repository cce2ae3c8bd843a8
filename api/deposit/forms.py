"""Whether the other forms of a bundle's tables hold what its CSV do, and its terms those stated.

Checksums are made by whoever made the bundle. What can be seen in it alone is seen here: every
Parquet file and the database are read to the end and compared with the tables, and the licences
stand where they belong.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

from api.deposit.crate import CRATE, licence_address
from api.deposit.database import DATABASE, write_database
from api.deposit.package import CC_BY, MIT
from api.deposit.parquet import arrow_table
from api.deposit.terms import FACTS, terms
from api.deposit.typed_tables import TypedTable, typed_tables
from api.metadata.identity import identity
from files.temporary import temporary_directory

Problem = tuple[str, str]
FOLDER = "parquet"
#: To what a mangled Parquet file leads its reader, beside Arrow's own errors.
_UNREADABLE = (OSError, ValueError, LookupError, TypeError, NotImplementedError, MemoryError)


def of_forms(bundle: Path, package: Mapping[str, Any], listed: Mapping[str, str]) -> list[Problem]:
    """Say where Parquet and SQLite hold other than the tables: (file, what is wrong with it).

    Parameters
    ----------
    bundle : its directory, whose tables are valid
    package : its descriptor
    listed : checksums by path
    """
    try:
        return _of_forms(bundle, package, listed)
    except (ValueError, LookupError, TypeError, AttributeError, ArithmeticError) as error:
        said = str(error).removeprefix(f"{bundle}/")
        return [("datapackage.json", f"no other form can be made of the tables ({said})")]


def _of_forms(bundle: Path, package: Mapping[str, Any], listed: Mapping[str, str]) -> list[Problem]:
    tables = typed_tables(bundle, package)
    expected = {f"{FOLDER}/{table.name}.parquet": table for table in tables}
    there = {name for name in listed if name.startswith(f"{FOLDER}/")}
    wrong = [(name, "no table of this bundle") for name in sorted(there - expected.keys())]
    for name, table in expected.items():
        text = _of_parquet(bundle / name, table) if name in there else "missing"
        wrong += [(name, text)] if text else []
    wrong += list(_of_measurements(bundle, package))
    text = _of_database(bundle / DATABASE, tables) if DATABASE in listed else "missing"
    return wrong + ([(DATABASE, text)] if text else [])


def _of_parquet(path: Path, table: TypedTable) -> str | None:
    from pyarrow import ArrowException, parquet  # noqa: PLC0415 - half a second

    wanted = arrow_table(table)
    try:
        with parquet.ParquetFile(path) as file:
            if file.metadata.num_rows != wanted.num_rows:
                return f"has {file.metadata.num_rows} rows, the table in CSV has {wanted.num_rows}"
            found = file.read()
    except (*_UNREADABLE, ArrowException) as error:
        return f"cannot be read to its end ({_one_line(error)})"
    if not found.schema.equals(wanted.schema, check_metadata=True):
        return "has other columns than the table in CSV, or says other things of them"
    for name in wanted.column_names:
        one, other = found.column(name), wanted.column(name)
        # As text where they are not equal: NaN never is, not even to itself.
        if not one.equals(other) and repr(one.to_pylist()) != repr(other.to_pylist()):
            return f"column {name} holds other values than the table in CSV"
    return None


def _of_measurements(bundle: Path, package: Mapping[str, Any]) -> Iterator[Problem]:
    """Read the Parquet files to the end that have no other form."""
    from pyarrow import ArrowException, parquet  # noqa: PLC0415

    for resource in package["resources"]:
        if not resource["path"].endswith(".parquet"):
            continue
        try:
            with parquet.ParquetFile(bundle / resource["path"]) as file:
                counted = sum(batch.num_rows for batch in file.iter_batches())
                named, said = file.schema_arrow.names, file.metadata.num_rows
        except (*_UNREADABLE, ArrowException) as error:
            yield resource["path"], f"cannot be read to its end ({_one_line(error)})"
            continue
        if counted != said:
            yield resource["path"], f"has {counted} rows, its own head says {said}"
        for name in named:
            if f" {name}: " not in str(resource.get("description")):
                yield resource["path"], f"column {name} is not described"


def _of_database(path: Path, tables: Sequence[TypedTable]) -> str | None:
    with temporary_directory() as temporary:
        made = temporary / DATABASE
        try:
            write_database(tables, made)
        except sqlite3.Error as error:
            return f"cannot be made of the tables in CSV ({error})"
        if made.read_bytes() == path.read_bytes():
            return None
        try:
            return _unlike(path, made)
        except (sqlite3.Error, sqlite3.Warning, OverflowError, UnicodeDecodeError) as error:
            return f"cannot be read to its end ({_one_line(error)})"


def _unlike(path: Path, made: Path) -> str | None:
    """Say in what one database differs from another, whose tables are trusted."""
    with closing(_open_record(path)) as theirs, closing(_open_record(made)) as ours:
        schema = "SELECT type, name, tbl_name, sql FROM sqlite_schema ORDER BY type, name"
        if theirs.execute(schema).fetchall() != (wanted := ours.execute(schema).fetchall()):
            return "has other tables than the tables in CSV make"
        whole = theirs.execute("PRAGMA integrity_check(1)").fetchone()[0]
        if whole != "ok":
            return f"is damaged ({_one_line(whole)})"
        for kind, name, *_ in wanted:
            if kind != "table":
                continue
            rows = f'SELECT * FROM "{name}" ORDER BY rowid'  # noqa: S608 - a name of our own
            found, held = theirs.execute(rows), ours.execute(rows)
            for number, row in enumerate(held, start=1):
                if found.fetchone() != row:
                    return f"table {name}, row {number} is another than in CSV"
            if found.fetchone() is not None:
                return f"table {name} has more rows than the table in CSV"
    return None


def _open_record(path: Path) -> sqlite3.Connection:
    """Open a database to be read, whatever it is: nothing in it is run, nothing beside it read."""
    base = sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro&immutable=1", uri=True)
    base.execute("PRAGMA trusted_schema = OFF")
    base.execute("PRAGMA cell_size_check = ON")
    return base


def of_terms(
    bundle: Path, package: Mapping[str, Any], crate: Mapping[str, Any], listed: Mapping[str, str]
) -> Iterator[Problem]:
    """Name what stands under other terms than a bundle's: code under MIT, facts under CC BY 4.0.

    The texts are held against those of this code, but for who holds the copyright and since when.
    """
    who = identity()
    texts = {"LICENSE": who.code_licence} | {f"{part}/LICENSE": who.data_licence for part in FACTS}
    for name, text in texts.items():
        if name not in listed:
            yield name, "missing; a bundle goes out with its terms"
        elif _without_holder((bundle / name).read_text("utf-8", "replace")) != _without_holder(
            text
        ):
            yield name, f"is another text than {terms(name)} as this code states it"
    for of, stated, expected in _stated(package):
        if stated != expected:
            yield (
                "datapackage.json",
                f"{of} is under {_one_line(stated)}, expected {_one_line(expected)}",
            )
    for entity in crate["@graph"]:
        if not isinstance(entity, dict) or entity.get("@id") not in listed.keys() - {CRATE}:
            continue
        path, said = str(entity["@id"]), entity.get("license")
        if said != {"@id": licence_address(terms(path))}:
            yield CRATE, f"{path} is under {_one_line(said)}, expected {terms(path)}"


def _stated(package: Mapping[str, Any]) -> Iterator[tuple[str, Any, Any]]:
    known = {"CC-BY-4.0": CC_BY, "MIT": MIT}
    yield "the package", package.get("licenses"), [CC_BY, MIT]
    for resource in package["resources"]:
        yield resource["path"], resource.get("licenses"), [known[terms(resource["path"])]]


def _without_holder(text: str) -> list[str]:
    lines = (" ".join(line.split()) for line in text.splitlines())
    return [line for line in lines if line and not line.startswith("Copyright (c)")]


def _one_line(value: object) -> str:
    text = "".join(c if c.isprintable() else " " for c in str(value))
    return " ".join(text.split())[:160]
