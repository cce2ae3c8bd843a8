"""What is wrong with a file that offers a study: every fault, with its line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from survey_data.json_data import JsonData
from survey_data.problems import SurveyImportError


@dataclass(frozen=True)
class Fault(JsonData):
    """One fault; ``line`` is None where no line is at fault."""

    line: int | None
    message: str


class FaultsError(SurveyImportError):
    """A file cannot be taken; nothing has been written.

    Parameters
    ----------
    file : its name
    faults : all of them; the message has a line for each
    """

    def __init__(self, file: str, faults: Sequence[Fault]) -> None:
        self.file = file
        self.faults = tuple(sorted(faults, key=lambda fault: fault.line or 0))
        super().__init__("\n".join(self.lines))

    @property
    def lines(self) -> list[str]:
        """A line for each fault: file, line, what was expected."""
        return [
            f"{self.file}{'' if each.line is None else f', line {each.line}'}: {each.message}"
            for each in self.faults
        ]
