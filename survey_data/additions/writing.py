"""Adding studies the survey does not map, confirming what is said of them, removing them."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from survey_data.additions.offered import (
    Addition,
    Fault,
    FaultsError,
    Row,
    read_addition,
    read_toml,
)
from survey_data.descriptor import DATA_DIRECTORY
from survey_data.editions import EXTENSION_TABLES, FOLDER
from survey_data.importing.bibliography import Entry, read_bibliography
from survey_data.importing.writing import locked_tables, write_valid
from survey_data.nearest import one_of
from survey_data.problems import SurveyImportError
from survey_data.texts import Rows, load_texts

_KEY = re.compile(r"[A-Za-z]+([0-9]{4})[a-z]?")


class UnknownStudyError(SurveyImportError):
    """No study has this key, or one that cannot be taken away."""


def read_study(path: Path, directory: Path = DATA_DIRECTORY) -> Addition:
    """Read a study from its template; FaultsError names every fault with file and line."""
    if path.suffix.casefold() != ".toml":
        expected = "expected a template that ends in .toml; `--init KEY` makes one"
        raise FaultsError(path.name, [Fault(None, expected)])
    return read_addition(read_toml(path), directory)


def add_study(
    addition: Addition, directory: Path = DATA_DIRECTORY, *, apply: bool = False
) -> list[str]:
    """Add a study to the extension of `directory`, whole or not at all.

    Returns the names of the tables that change; without `apply` nothing is written, and the tables
    are only checked. SurveyImportError where the key is taken, or the tables would not be valid or
    cannot be written.
    """

    def changed(held: Mapping[str, Rows]) -> dict[str, Rows]:
        if any(row["key"] == addition.key for row in held["extension_studies"]):
            raise SurveyImportError(f"a study with the key {addition.key} was added already")
        new = {f"extension_{name}": rows for name, rows in addition.rows.items() if rows}
        return {table: _sorted([*held[table], *rows]) for table, rows in new.items()}

    return _change(directory, changed, apply=apply)


def remove_study(key: str, directory: Path = DATA_DIRECTORY, *, apply: bool = False) -> list[str]:
    """Take a study out of the extension, with its confirmations; the survey's own stay.

    Returns and raises as `add_study`; UnknownStudyError where the extension has no such study.
    """
    _require_later(key, directory)

    def changed(held: Mapping[str, Rows]) -> dict[str, Rows]:
        kept = {table: [row for row in rows if _study(row) != key] for table, rows in held.items()}
        return {table: rows for table, rows in kept.items() if len(rows) < len(held[table])}

    return _change(directory, changed, apply=apply)


def verify_study(row: Row, directory: Path = DATA_DIRECTORY, *, apply: bool = False) -> list[str]:
    """Note that somebody confirmed what is said of a study, of either edition.

    `row` has the columns of the table of verifications; the rest as `add_study`.
    """
    tables = load_texts(("studies", "extension_studies"), directory)
    keys = [found["key"] for found in (*tables.studies, *tables.extension_studies)]
    if row["study"] not in keys:
        raise UnknownStudyError(f"study {row['study']!r}: {one_of(row['study'], keys)}")

    def changed(held: Mapping[str, Rows]) -> dict[str, Rows]:
        if row in held["verifications"]:
            raise SurveyImportError(f"this confirmation of {row['study']} stands already")
        return {"verifications": _sorted([*held["verifications"], row])}

    return _change(directory, changed, apply=apply)


def _require_later(key: str, directory: Path) -> None:
    tables = load_texts(("studies", "extension_studies"), directory)
    later = [row["key"] for row in tables.extension_studies]
    if key in later:
        return
    if key in [row["key"] for row in tables.studies]:
        raise UnknownStudyError(f"{key} is a study of the survey, whose tables stay as they are")
    raise UnknownStudyError(
        f"study {key!r}: {one_of(key, later)}" if later else "there is no study beside the survey's"
    )


def _change(
    folder: Path, changed: Callable[[Mapping[str, Rows]], Mapping[str, Rows]], *, apply: bool
) -> list[str]:
    """Change tables of the extension that nobody else writes meanwhile; return their names."""
    with locked_tables(folder):
        tables = changed(vars(load_texts(EXTENSION_TABLES, folder)))
        write_valid(folder, tables, together=FOLDER, apply=apply)
    return list(tables)


def _study(row: Row) -> str:
    return row["key"] if "key" in row else row["study"]


def _sorted(rows: Rows) -> Rows:
    """Order rows by study; those of a study stay as they came."""
    return sorted(rows, key=_study)


def read_publications(path: Path) -> tuple[dict[str, str], ...]:
    """Read the publications of a file, each as columns of the table of studies.

    A key that is no key of ours, or of another year, is made of the first author's surname and the
    year. SurveyImportError where the file cannot be read, or holds no publication.
    """
    return tuple(_publication(entry) for entry in read_bibliography(path))


def choose(publications: Sequence[dict[str, str]], key: str, file: str) -> dict[str, str]:
    """Return the publication of a key, or the only one; FaultsError where that is not clear."""
    keys = [each["key"] for each in publications]
    if key in keys or len(keys) == 1:
        return {**publications[keys.index(key) if key in keys else 0], "key": key}
    message = f"holds {len(keys)} publications; key {key!r}: {one_of(key, keys)}"
    raise FaultsError(file, [Fault(None, message)])


def _publication(entry: Entry) -> dict[str, str]:
    key = entry.key
    known = _KEY.fullmatch(key)
    if known is None or (entry.year and known[1] != entry.year):
        first = entry.authors.split(";")[0].split()
        letters = unicodedata.normalize("NFKD", first[-1]) if first else ""
        surname = re.sub(r"[^A-Za-z]", "", letters)
        key = f"{surname}{entry.year}" if surname and entry.year else key if known else ""
    return {**entry.columns(), "key": key}
