"""Reading a file that somebody offers; what cannot be read is refused by one sentence."""

from __future__ import annotations

from pathlib import Path

from files.reading import FileRefusedError, read_bytes
from survey_data.problems import SurveyImportError


def offered_bytes(path: Path, largest: int) -> bytes:
    """Return the bytes of a file; SurveyImportError where it cannot be read or is larger."""
    try:
        return read_bytes(path, largest)
    except FileNotFoundError as error:
        raise SurveyImportError(f"cannot read {path}: {error.strerror}") from error
    except FileRefusedError as error:
        raise SurveyImportError(f"cannot read {path}: {error.reason}") from error


def offered_text(path: Path, largest: int) -> str:
    """Return the text of a UTF-8 file; raises as `offered_bytes`."""
    try:
        return offered_bytes(path, largest).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise SurveyImportError(f"{path.name} is not UTF-8 text") from error
