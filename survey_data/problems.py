"""What can be wrong with tables, and where; errors that refuse them."""

from __future__ import annotations

from dataclasses import dataclass

from survey_data.json_data import JsonData


@dataclass(frozen=True, order=True)
class Problem(JsonData):
    """One thing wrong with the data: the file, the place, what was expected and what came.

    `row` is counted in the file, the header being 1; it or `column` is None where none is at fault.
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


class SurveyDataError(ValueError):
    """The tables cannot be read; `problems` says where."""

    def __init__(self, problems: tuple[Problem, ...]) -> None:
        self.problems = problems
        more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
        super().__init__(f"{problems[0]}{more}")


class SurveyImportError(ValueError):
    """A table offered for import cannot be taken; nothing has been written.

    `row` (the first line is 1) and `column` are places in the offered table; `problems` are all,
    where there are several.
    """

    def __init__(
        self,
        message: str,
        *,
        row: int | None = None,
        column: str | None = None,
        problems: tuple[Problem, ...] = (),
    ) -> None:
        self.message = message
        self.row = row
        self.column = column
        self.problems = problems
        places = [f"row {row}"] if row is not None else []
        places += [f"column {column}"] if column is not None else []
        super().__init__(": ".join([", ".join(places), message] if places else [message]))
