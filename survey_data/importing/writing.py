"""Writing tables anew: only if all of them stay valid, and whole or not at all."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from files.atomic import restore
from files.locks import wait_for_lock
from files.manifest import write_recorded
from files.reading import FileRefusedError
from files.temporary import temporary_directory
from survey_data.descriptor import DESCRIPTOR_FILE, file_name, table_names
from survey_data.editions import FOLDER
from survey_data.problems import SurveyImportError
from survey_data.validation.validate import validate


@contextmanager
def locked_tables(folder: Path) -> Iterator[None]:
    """Hold the tables from reading to writing; who else would write waits, and reads what is new.

    Raises
    ------
    SurveyImportError
        Nothing can be written there.
    """
    with ExitStack() as stack:
        try:
            with suppress(FileNotFoundError):  # reading says that there are no tables
                stack.enter_context(wait_for_lock(folder / "tables"))
                restore(folder / FOLDER)
        except OSError as error:
            raise _unwritable(folder, error) from error
        yield


def write_valid(folder: Path, texts: Mapping[str, str], *, together: str | None = None) -> None:
    """Replace tables, by name, by texts.

    Parameters
    ----------
    folder
        Of the tables.
    texts
        New text of each table.
    together
        Sub-folder that all of them stand in: they then change in one step.

    Raises
    ------
    SurveyImportError
        The tables would be invalid, or the file cannot be written; nothing has been written.
    """
    try:
        require_valid(folder, texts)
        contents = {file_name(table): text for table, text in texts.items()}
        write_recorded(folder, contents, together=together)
    except FileRefusedError as error:
        raise SurveyImportError(str(error)) from error
    except OSError as error:
        raise _unwritable(folder, error) from error


def _unwritable(folder: Path, error: OSError) -> SurveyImportError:
    return SurveyImportError(f"cannot write in {folder}: {error.strerror or error}")


def require_valid(folder: Path, texts: Mapping[str, str]) -> None:
    """Raise SurveyImportError where the tables would not be valid with these texts."""
    with temporary_directory() as scratch:
        for name in (DESCRIPTOR_FILE, *map(file_name, table_names())):
            (scratch / name).parent.mkdir(exist_ok=True)
            shutil.copyfile(folder / name, scratch / name)
        for table, text in texts.items():
            (scratch / file_name(table)).write_text(text, encoding="utf-8", newline="")
        problems = validate(scratch)
    if problems:
        raise SurveyImportError(
            f"the tables would not be valid: {problems[0]}", problems=tuple(problems)
        )
