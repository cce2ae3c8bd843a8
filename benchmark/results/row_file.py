"""One file of the record: a JSON object a line, sorted by the cell that it is of."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

from benchmark.results import recorded
from benchmark.results.store import PUBLISHED
from benchmark.results.tables import StoreError
from files.reading import FileRefusedError
from files.strict_json import members, read_json

#: Plain JSON values.
Row = dict[str, Any]
#: What a row is of: hashable and ordered.
C = TypeVar("C")


@dataclass(frozen=True)
class RowFile(Generic[C]):
    """How the rows of one experiment are written and read.

    Attributes
    ----------
    name
        Of the file, in the folder of a record.
    listed
        Name of the list that holds the rows.
    schema
        Layout of a row; raised when a member changes its meaning.
    cell_of
        Returns the cell that a row is of.
    require_row
        Raises FileRefusedError for what is no row; is given the path and the row.
    """

    name: str
    listed: str
    schema: int
    cell_of: Callable[[Row], C]
    require_row: Callable[[Path, object], None]

    def read(self, directory: Path | str = PUBLISHED) -> dict[C, Row]:
        """Return rows by cell, sorted; none where there is no file.

        Raises
        ------
        StoreError
            For a file that holds anything else; the message names the row.
        """
        path = Path(directory) / self.name
        try:
            held = members(read_json(path), path, {"schema": int, self.listed: list})
            if held["schema"] != self.schema:
                raise StoreError(f"{path}: expected schema {self.schema}, got {held['schema']!r}")
            found: dict[C, Row] = {}
            for number, row in enumerate(held[self.listed], start=1):
                try:
                    self.require_row(path, row)
                except FileRefusedError as error:
                    said = f"{self.listed}, row {number}: {error.reason}"
                    raise FileRefusedError(path, said) from error
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
        return recorded.write(Path(directory), {self.name: text})
