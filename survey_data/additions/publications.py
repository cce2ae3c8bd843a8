"""The publication of a study, read from BibTeX, RIS or CSL JSON."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from pathlib import Path

from survey_data.additions.faults import Fault, FaultsError
from survey_data.importing.bibliography import SUFFIXES, Entry, read_bibliography
from survey_data.nearest import one_of

Publication = dict[str, str]
"""Columns of the table of studies."""

_KEY = re.compile(r"[A-Za-z]+([0-9]{4})[a-z]?")


def read_publications(path: Path) -> tuple[Publication, ...]:
    """Read the publications of a file, each as columns of the table of studies.

    A key that is no key of ours, or of another year, is made of the first author's surname and the
    year.

    Raises
    ------
    SurveyImportError
        The file cannot be read, or holds no publication.
    """
    if path.suffix.casefold() not in SUFFIXES:
        expected = ".toml, " + ", ".join(SUFFIXES)
        raise FaultsError(path.name, [Fault(None, f"expected a file that ends in {expected}")])
    return tuple(_publication(entry) for entry in read_bibliography(path))


def choose(publications: Sequence[Publication], key: str | None, file: str) -> Publication:
    """Return the publication of a key, or the only one; FaultsError where that is not clear."""
    keys = [each["key"] for each in publications]
    if key in keys:
        return publications[keys.index(key)]
    if len(publications) == 1:
        return {**publications[0], "key": key or keys[0]}
    message = f"holds {len(keys)} publications: choose one with --key ({', '.join(keys[:12])})"
    if key:
        message = f"key {key!r}: {one_of(key, keys)}"
    raise FaultsError(file, [Fault(None, message)])


def _publication(entry: Entry) -> Publication:
    key = entry.key
    known = _KEY.fullmatch(key)
    if known is None or (entry.year and known[1] != entry.year):
        first = entry.authors.split(";")[0].split()
        letters = unicodedata.normalize("NFKD", first[-1]) if first else ""
        surname = re.sub(r"[^A-Za-z]", "", letters)
        key = f"{surname}{entry.year}" if surname and entry.year else key if known else ""
    return {**entry.columns(), "key": key}
