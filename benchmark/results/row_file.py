"""Files of the record with a row for each cell: a JSON object a line, or a line of a table."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

from pydantic import BaseModel

from benchmark.results import record_manifest
from benchmark.results.csv_tables import Reader, StoreError, read_csv, text_of
from benchmark.results.store import PUBLISHED
from files.reading import FileRefusedError, read_json, require_type

#: Plain JSON values.
Row = dict[str, Any]
#: What a row is of: hashable and ordered.
C = TypeVar("C")


@dataclass(frozen=True)
class RowFile(Generic[C]):
    """How the rows of one experiment are written and read.

    A file in the folder of a record with one list of rows; the schema is raised when a member
    changes its meaning. `row` is what a row is, as a type that Pydantic checks.
    """

    name: str
    listed: str
    schema: int
    cell_of: Callable[[Row], C]
    row: Any

    def read(self, directory: Path | str = PUBLISHED) -> dict[C, Row]:
        """Return rows by cell, sorted; none where there is no file.

        StoreError for a file that holds anything else; the message names the row.
        """
        path = Path(directory) / self.name
        try:
            held = read_json(path)
            schema = held.pop("schema", None) if isinstance(held, dict) else None
            if schema != self.schema or held.keys() != {self.listed}:
                said = f"expected schema {self.schema} and {self.listed}, got {schema!r}"
                raise StoreError(f"{path}: {said}")
            require_type(held, dict[str, list[self.row]], path)  # type: ignore[name-defined]
            found: dict[C, Row] = {}
            for number, row in enumerate(held[self.listed], start=1):
                cell = self.cell_of(row)
                if cell in found:
                    raise StoreError(f"{path}, row {number}: {cell} is there twice")
                found[cell] = row
        except FileNotFoundError:
            return {}
        except FileRefusedError as error:
            raise StoreError(str(error)) from error
        return {cell: found[cell] for cell in sorted(found)}  # type: ignore[type-var]

    def write(self, rows: Mapping[C, Row], directory: Path | str = PUBLISHED) -> bool:
        """Write the file, whole or not at all; True when it changed."""
        lines = ",\n".join(
            json.dumps(rows[cell], allow_nan=False, ensure_ascii=False, separators=(",", ":"))
            for cell in sorted(rows)  # type: ignore[type-var]
        )
        text = f'{{"schema":{self.schema},"{self.listed}":[\n{lines}\n]}}\n'
        return record_manifest.write(Path(directory), {self.name: text})


@dataclass(frozen=True)
class TableFile(Generic[C]):
    """How the rows of an experiment are kept as a table, where there are many of them.

    What all rows of a group share stands once, in a file of JSON beside the table: a change of
    code that leaves the numbers as they are is a change of a few lines.

    The file beside the table ends in ``.json``; `shared` is what stands once a group, ``key`` among
    it. `place_of` returns what rows are sorted by.
    """

    name: str
    columns: Mapping[str, Reader]
    shared: type[BaseModel]
    cell_of: Callable[[Row], C]
    group_of: Callable[[Row], str]
    place_of: Callable[[Row], Any]

    @property
    def shared_name(self) -> str:
        """Return the name of the file of JSON."""
        return str(Path(self.name).with_suffix(".json"))

    def read(self, directory: Path | str = PUBLISHED) -> dict[C, Row]:
        """As `RowFile.read`."""
        path, groups = Path(directory) / self.name, self._groups(Path(directory))
        found: dict[C, Row] = {}
        for line, row in read_csv(path, self.columns):
            cell, group = self.cell_of(row), self.group_of(row)
            if cell in found:
                raise StoreError(f"{path}, line {line}: {cell} is there twice")
            if group not in groups:
                raise StoreError(f"{path}, line {line}: {group!r} is not in {self.shared_name}")
            found[cell] = {**row, **groups[group]}
        return found

    def write(self, rows: Mapping[C, Row], directory: Path | str = PUBLISHED) -> bool:
        """As `RowFile.write`; a row of another key than the last one of its group is left out."""
        groups = {
            self.group_of(row): {name: row[name] for name in self.shared.model_fields}
            for row in rows.values()
        }
        kept: list[Row] = [
            row for row in rows.values() if row["key"] == groups[self.group_of(row)]["key"]
        ]
        ordered: list[Row] = sorted(kept, key=self.place_of)
        lines = ",\n".join(
            f"{json.dumps(group)}:{json.dumps(groups[group], separators=(',', ':'))}"
            for group in sorted(groups)
        )
        contents = {
            self.name: text_of(list(self.columns), ordered),
            self.shared_name: f"{{\n{lines}\n}}\n",
        }
        return record_manifest.write(Path(directory), contents)

    def _groups(self, directory: Path) -> dict[str, Row]:
        path = directory / self.shared_name
        try:
            held: dict[str, Row] = read_json(path)
            require_type(held, dict[str, self.shared], path)  # type: ignore[name-defined]
        except FileNotFoundError:
            return {}
        except FileRefusedError as error:
            raise StoreError(str(error)) from error
        return held
