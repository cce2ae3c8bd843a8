"""What is wrong with a file that offers a study: every fault, with its line."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from files.json_data import JsonData
from files.reading import LARGEST, FileRefusedError, read_bytes
from survey_data.nearest import nearest_name
from survey_data.problems import SurveyImportError

_MOST_LISTED = 12


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


def one_of(
    value: object, words: Iterable[str], near: Iterable[str] = (), *, guess: bool = True
) -> str:
    """Say of which words a value should have been, and which of them is most like it.

    Parameters
    ----------
    value : what was given
    words : what is allowed
    near : further spellings, written ``spelling=word``
    guess : whether to name the most alike
    """
    allowed = list(words)
    spelt = dict(each.rsplit("=", 1) for each in near)
    meant = nearest_name(str(value), [*allowed, *spelt], cutoff=0.5)
    hint = f", did you mean {spelt.get(meant, meant)}?" if meant and guess else ""
    listed = ", ".join(allowed[:_MOST_LISTED]) + (", ..." if len(allowed) > _MOST_LISTED else "")
    return f"expected one of {listed}{hint}"


def read_text(path: Path, largest: int = LARGEST) -> str:
    """Read a text file of at most so many bytes; FaultsError where that cannot be."""
    try:
        return read_bytes(path, largest).decode("utf-8-sig")
    except FileNotFoundError as error:
        raise FaultsError(path.name, [Fault(None, "there is no such file")]) from error
    except FileRefusedError as error:
        raise FaultsError(path.name, [Fault(None, error.reason)]) from error
    except UnicodeDecodeError as error:
        raise FaultsError(path.name, [Fault(None, "expected UTF-8 text")]) from error
