"""A record held against its `files.manifest`: what no command wrote so is named."""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from benchmark.results.csv_tables import StoreError
from benchmark.results.times import MACHINE, TIMES
from files import manifest
from files.reading import FileRefusedError
from survey_data.problems import Problem

#: Takes over what was changed by hand, in the record and in the facts.
COMMAND = "python -m benchmark.suites.manifest_renewal"

#: Suffixes of the files that a record is made of.
_KINDS = frozenset({".csv", ".json", ".md", ".parquet"})


def names(folder: Path) -> tuple[str, ...]:
    """Return the files of a record, relative and POSIX.

    A runner's own, the manifest and what no reader takes for a part of the record are left aside.
    """
    found = (path for path in folder.rglob("*") if path.is_symlink() or not path.is_dir())
    relative = (path.relative_to(folder) for path in found)
    return tuple(
        sorted(
            path.as_posix()
            for path in relative
            if path.suffix in _KINDS
            and path.as_posix() not in {manifest.FILE, TIMES, MACHINE}
            and not any(part.startswith(".") for part in path.parts)
        )
    )


def changes(folder: Path, *, required: bool = False) -> list[Problem]:
    """Say what of a record no command wrote so, by file; an empty list where all holds.

    One without a manifest has nothing to be held against, unless it is `required`.
    """
    if not (required or (folder / manifest.FILE).is_file()):
        return []
    found = manifest.differences(folder, names(folder), required=required)
    return [Problem(file, None, None, said) for file, said in found]


def require_unchanged(folder: Path, *, required: bool = False) -> None:
    """Raise StoreError, naming the first place, where a record is not as commands wrote it."""
    if problems := changes(folder, required=required):
        more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
        said = f"{folder}: {problems[0]}{more}"
        raise StoreError(f"{said}; restore it, or take it over with `{COMMAND}`")


def finish(folder: Path) -> None:
    """Finish what a killed command left half done, as `manifest.finish_interrupted_write`.

    A manifest that cannot be read is left as it is: to be told of by who needs it.
    """
    with suppress(FileRefusedError):
        manifest.finish_interrupted_write(folder)


def is_unfinished(folder: Path) -> bool:
    """Say whether a killed command left some files of a record new and others old."""
    return manifest.is_unfinished(folder)


def write(folder: Path, contents: Mapping[str, str | bytes | None], *, start: bool = False) -> bool:
    """Write files of a record and take them into its manifest, as `manifest.write_recorded`.

    StoreError where the manifest cannot be read; nothing has been written.
    """
    try:
        if start and not os.path.lexists(folder / manifest.FILE) and (there := names(folder)):
            manifest.rewrite_manifest(folder, there)  # a record that is older than manifests
        return manifest.write_recorded(folder, contents, start=start)
    except FileRefusedError as error:
        raise StoreError(str(error)) from error
