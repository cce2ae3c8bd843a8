"""What can be wrong with a file, and where: file, row and column."""

from __future__ import annotations

from dataclasses import dataclass

from files.json_data import JsonData


@dataclass(frozen=True, order=True)
class Problem(JsonData):
    """One thing wrong with the data.

    Parameters
    ----------
    file : str
        Name of the file, e.g. ``attributes.csv``.
    row : int or None
        Row as counted in the file, the header being 1; None where no row is at fault.
    column : str or None
        Name of the column; None where no column is at fault.
    message : str
        What was expected and what came.
    """

    file: str
    row: int | None
    column: str | None
    message: str

    def __str__(self) -> str:
        place = self.file
        if self.row is not None:
            place += f", row {self.row}"
        if self.column is not None:
            place += f", column {self.column}"
        return f"{place}: {self.message}"
