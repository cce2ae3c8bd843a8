"""The project's own tables, held against their manifest: ``python -m survey_data.facts_manifest``.

`survey import --apply` writes table and manifest. Who edits a table by hand validates it and takes
it over with this command; until then whatever reads the facts names the cell and stops.
"""

from __future__ import annotations

import sys
from pathlib import Path

from files import manifest
from survey_data.descriptor import DATA_DIRECTORY, DESCRIPTOR_FILE, file_name, table_names
from survey_data.problems import Problem, SurveyDataError

COMMAND = "python -m survey_data.facts_manifest"


def names() -> tuple[str, ...]:
    """Return the files that are facts: the descriptor and every table."""
    return (DESCRIPTOR_FILE, *map(file_name, table_names()))


def changes(directory: Path | str = DATA_DIRECTORY) -> list[Problem]:
    """Say what no command wrote so, by file; an empty list where all holds.

    Our own tables must have a manifest; others without one have nothing to be held against.
    """
    folder = Path(directory)
    found = manifest.differences(folder, names(), required=folder == DATA_DIRECTORY)
    return [Problem(file, None, None, said) for file, said in found]


def require_unchanged(directory: Path | str = DATA_DIRECTORY) -> None:
    """Raise SurveyDataError where the tables are not as commands wrote them, in some 20 ms."""
    if problems := changes(directory):
        first = problems[0]
        raise SurveyDataError(
            (
                Problem(
                    *(first.file, first.row, first.column),
                    f"{first.message}; restore it, or take it over with `{COMMAND}`",
                ),
                *problems[1:],
            )
        )


def renew(directory: Path | str = DATA_DIRECTORY) -> list[str]:
    """Take changes by hand into the manifest; return the files that had any.

    Raises
    ------
    SurveyDataError
        The tables are not valid; the manifest is left as it is.
    """
    from survey_data.validation.validate import validate  # noqa: PLC0415 - frictionless, half a second

    if problems := validate(directory):
        raise SurveyDataError(tuple(problems))
    return manifest.rewrite_manifest(Path(directory), names())


def main() -> int:
    """Take over what was changed by hand, or say why it cannot be."""
    try:
        for name in renew():
            sys.stderr.write(f"{name} taken over\n")
    except SurveyDataError as error:
        sys.stderr.write(f"{error}\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
