"""Writing one table anew: only if all of them stay valid, and whole or not at all."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from survey_data.descriptor import DESCRIPTOR_FILE, file_name, table_names
from survey_data.problems import SurveyImportError
from survey_data.validation.validate import validate
from survey_data.whole_files import replace_file


def write_valid(folder: Path, table: str, text: str) -> None:
    """Replace a table by a text.

    Raises
    ------
    SurveyImportError
        The tables would be invalid, or the file cannot be written; nothing has been written.
    """
    try:
        _require_valid(folder, table, text)
        replace_file(folder / file_name(table), text)
    except OSError as error:
        raise SurveyImportError(f"cannot write in {folder}: {error.strerror or error}") from error


def _require_valid(folder: Path, table: str, text: str) -> None:
    with tempfile.TemporaryDirectory() as scratch:
        for name in (DESCRIPTOR_FILE, *map(file_name, table_names())):
            shutil.copyfile(folder / name, Path(scratch) / name)
        (Path(scratch) / file_name(table)).write_text(text, encoding="utf-8", newline="")
        problems = validate(scratch)
    if problems:
        raise SurveyImportError(
            f"the tables would not be valid: {problems[0]}", problems=tuple(problems)
        )
