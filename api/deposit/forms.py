"""Tables of a bundle in other forms, Parquet and SQLite: written, and held against the CSV.

Checksums are made by whoever made the bundle. What can be seen in it alone is seen here: the other
forms are made again of the tables in CSV, and the licences stand where they belong.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator, Mapping
from contextlib import closing
from pathlib import Path
from typing import Any

from api.deposit.crate import CRATE, licence_address
from api.deposit.database import DATABASE, write_database
from api.deposit.package import CC_BY, MIT
from api.deposit.parquet import write_parquet
from api.deposit.terms import FACTS, terms
from api.deposit.typed_tables import typed_tables
from api.metadata.identity import identity
from files.atomic import temporary_directory

Problem = tuple[str, str]
FOLDER = "parquet"


def write_other_forms(bundle: Path, descriptor: Mapping[str, Any], out: Path | None = None) -> None:
    """Write the tables of a bundle as Parquet and SQLite, too; into `out`, the bundle by default.

    Raises
    ------
    CellError, NameNotPlainError, sqlite3.Error
        Where the tables are not what the descriptor says, or their keys do not hold.
    """
    tables = typed_tables(bundle, descriptor)
    for table in tables:
        write_parquet(table, (out or bundle) / FOLDER / f"{table.name}.parquet")
    write_database(tables, (out or bundle) / DATABASE)


def of_forms(bundle: Path, package: Mapping[str, Any], listed: Mapping[str, str]) -> list[Problem]:
    """Say where Parquet and SQLite hold other than the tables: (file, what is wrong with it).

    Parameters
    ----------
    bundle : its directory, whose tables are valid
    package : its descriptor
    listed : checksums by path
    """
    with temporary_directory() as made:
        try:
            write_other_forms(bundle, package, made)
        except (ValueError, LookupError, TypeError, ArithmeticError, sqlite3.Error) as error:
            said = str(error).removeprefix(f"{bundle}/")
            return [("datapackage.json", f"no other form can be made of the tables ({said})")]
        expected = {f"{FOLDER}/{path.name}" for path in (made / FOLDER).iterdir()} | {DATABASE}
        there = {name for name in listed if name.startswith(f"{FOLDER}/") or name == DATABASE}
        wrong = [(name, "no table of this bundle") for name in sorted(there - expected)]
        wrong += [(name, "missing") for name in sorted(expected - there)]
        wrong += [
            (name, text)
            for name in sorted(there & expected)
            if (text := unlike(bundle / name, made / name))
        ]
    return wrong + list(_of_measurements(bundle, package))


def unlike(path: Path, made: Path) -> str:
    """Say in what a Parquet file or a database differs from one made here; "" where it does not."""
    if path.read_bytes() == made.read_bytes():
        return ""
    try:
        same = (_same_tables if path.suffix == ".sqlite" else _same_parquet)(path, made)
    except Exception as error:  # noqa: BLE001 - whatever a mangled file leads its reader to
        return f"cannot be read to its end ({_one_line(error)})"
    return "" if same else "holds other tables than the CSV of this bundle"


def _same_parquet(path: Path, made: Path) -> bool:
    from pyarrow import parquet  # noqa: PLC0415 - half a second

    one, other = parquet.read_table(path), parquet.read_table(made)
    if not one.schema.equals(other.schema, check_metadata=True):
        return False
    # As text where they are not equal: NaN never is, not even to itself.
    return bool(one.equals(other)) or repr(one.to_pylist()) == repr(other.to_pylist())


def _same_tables(path: Path, made: Path) -> bool:
    with closing(_opened(path)) as theirs, closing(_opened(made)) as ours:
        schema = "SELECT type, name, tbl_name, sql FROM sqlite_schema ORDER BY type, name"
        wanted = ours.execute(schema).fetchall()
        if theirs.execute(schema).fetchall() != wanted:
            return False
        if theirs.execute("PRAGMA integrity_check(1)").fetchone()[0] != "ok":
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
    base.execute("PRAGMA cell_size_check = ON")
    return base


def _of_measurements(bundle: Path, package: Mapping[str, Any]) -> Iterator[Problem]:
    """Read the Parquet files to the end that have no other form."""
    from pyarrow import parquet  # noqa: PLC0415 - half a second

    for resource in package["resources"]:
        if not resource["path"].endswith(".parquet"):
            continue
        try:
            with parquet.ParquetFile(bundle / resource["path"]) as file:
                counted = sum(batch.num_rows for batch in file.iter_batches())
                named, said = file.schema_arrow.names, file.metadata.num_rows
        except Exception as error:  # noqa: BLE001 - whatever a mangled file leads its reader to
            yield resource["path"], f"cannot be read to its end ({_one_line(error)})"
            continue
        if counted != said:
            yield resource["path"], f"has {counted} rows, its own head says {said}"
        for name in named:
            if f" {name}: " not in str(resource.get("description")):
                yield resource["path"], f"column {name} is not described"


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
