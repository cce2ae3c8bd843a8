"""Reading what is offered, and writing tables anew: only valid ones, whole or not at all."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from files.atomic import UnreplaceableError, restore, temporary_directory
from files.csv_writing import csv_text
from files.locks import wait_for_lock
from files.manifest import write_recorded
from files.reading import FileRefusedError, read_bytes
from survey_data.descriptor import DESCRIPTOR_FILE, column_types, file_name, table_names
from survey_data.editions import FOLDER
from survey_data.problems import SurveyImportError
from survey_data.texts import Rows
from survey_data.validation.validate import validate


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


@contextmanager
def locked_tables(folder: Path) -> Iterator[None]:
    """Hold the tables from reading to writing; who else would write waits, and reads what is new.

    SurveyImportError where nothing can be written.
    """
    with ExitStack() as stack:
        try:
            with suppress(FileNotFoundError):  # reading says that there are no tables
                stack.enter_context(wait_for_lock(folder / "tables"))
                restore(folder / FOLDER)
        except OSError as error:
            raise _unwritable(folder, error) from error
        yield


def write_valid(
    folder: Path, tables: Mapping[str, Rows], *, together: str | None = None, apply: bool = True
) -> None:
    """Replace tables, by name, by rows; those `together` in a sub-folder change in one step.

    Without `apply` they are only checked. SurveyImportError where they would be invalid or cannot
    be written; nothing has been written.
    """
    texts = {}
    for table, rows in tables.items():
        columns = list(column_types(table))
        texts[file_name(table)] = csv_text(columns, ([row[c] for c in columns] for row in rows))
    try:
        _require_valid(folder, texts)
        if apply:
            write_recorded(folder, texts, together=together)
    except (FileRefusedError, UnreplaceableError) as error:
        raise SurveyImportError(str(error)) from error
    except OSError as error:
        raise _unwritable(folder, error) from error


def _unwritable(folder: Path, error: OSError) -> SurveyImportError:
    return SurveyImportError(f"cannot write in {folder}: {error.strerror or error}")


def _require_valid(folder: Path, texts: Mapping[str, str]) -> None:
    """Raise SurveyImportError where the tables would not be valid with these files."""
    with temporary_directory() as scratch:
        for name in (DESCRIPTOR_FILE, *map(file_name, table_names())):
            (scratch / name).parent.mkdir(exist_ok=True)
            shutil.copyfile(folder / name, scratch / name)
        for name, text in texts.items():
            (scratch / name).write_text(text, encoding="utf-8", newline="")
        problems = tuple(validate(scratch))
    if problems:
        message = f"the tables would not be valid: {problems[0]}"
        raise SurveyImportError(message, problems=problems)
