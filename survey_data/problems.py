"""Errors of the survey's tables: what is refused, with the places."""

from __future__ import annotations

from files.problems import Problem


class SurveyDataError(ValueError):
    """The tables cannot be read; `problems` says where."""

    def __init__(self, problems: tuple[Problem, ...]) -> None:
        self.problems = problems
        more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
        super().__init__(f"{problems[0]}{more}")


class SurveyImportError(ValueError):
    """A table offered for import cannot be taken; nothing has been written.

    Parameters
    ----------
    message : str
        What was expected and what came.
    row : int or None
        Row in the offered table, the first line being 1.
    column : str or None
        Column in the offered table.
    problems : tuple of Problem
        Every problem found, where there are several.
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
