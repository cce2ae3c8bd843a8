"""A cell of a spreadsheet as its file has it."""

from __future__ import annotations

from dataclasses import dataclass

#: Kinds of a cell that has no value of its own.
FORMULA, ERROR = "f", "e"


@dataclass(frozen=True)
class Cell:
    """A cell as the file has it; of kind `FORMULA` where a formula has no value, or `ERROR`."""

    row: int
    column: int
    value: object
    kind: str
