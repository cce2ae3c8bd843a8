"""Which works the survey's keys are: its own bibliography compared with ours, and taken over."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import pandas as pd

from files.csv_writing import csv_text
from files.json_data import JsonData
from files.strict_csv import read_records
from survey_data.descriptor import DATA_DIRECTORY, column_types, file_name
from survey_data.importing.bibliography import Entry, read_bibliography
from survey_data.importing.text_similarity import normalise, similarity
from survey_data.importing.writing import locked_tables, write_valid
from survey_data.problems import SurveyImportError
from survey_data.sources import fault
from survey_data.tables import SurveyTables, load

_TABLE = "studies"
_COLUMNS = ("title", "authors", "venue", "type", "doi", "url")
_ALIKE = 0.9
#: Identities that a bibliography settles; what a page has confirmed is a person's to change.
_OPEN = ("unknown", "ambiguous", "recalled")

Kind = Literal["new", "changed", "conflict", "kept"]


@dataclass(frozen=True)
class IdentityDifference(JsonData):
    """A cell of a study that the bibliography says otherwise.

    ``new``: ours is empty. ``changed``: the identity was not confirmed, or the study was named to
    be replaced, so that theirs is taken. ``conflict``: it was confirmed, and ours stays. ``kept``:
    the year, which stays as the key has it. ``line`` is where their entry starts.
    """

    study: str
    column: str
    kind: Kind
    ours: str
    theirs: str
    identity: str
    line: int


@dataclass(frozen=True)
class BibliographyPlan(JsonData):
    """What a bibliography changes in the table of studies.

    ``settled`` are the studies whose identity it confirms; ``left_aside`` its keys that are no
    study of ours, with the reason; ``missing`` our studies that it does not name.
    """

    source: str
    entries: int
    differences: tuple[IdentityDifference, ...]
    settled: tuple[str, ...]
    left_aside: tuple[tuple[str, str], ...]
    missing: tuple[str, ...]
    written: int = 0

    @property
    def edits(self) -> tuple[IdentityDifference, ...]:
        """The cells to be written."""
        return tuple(d for d in self.differences if d.kind in ("new", "changed"))

    @property
    def conflicts(self) -> tuple[str, ...]:
        """The studies of which ours stays, though the bibliography says otherwise."""
        return tuple(dict.fromkeys(d.study for d in self.differences if d.kind == "conflict"))

    def to_dict(self) -> dict[str, Any]:
        """Return it as JSON data."""
        aside = [{"key": key, "reason": reason} for key, reason in self.left_aside]
        return {**super().to_dict(), "left_aside": aside}


def import_bibliography(
    path: str | Path,
    directory: str | Path | None = None,
    *,
    replace_studies: Iterable[str] = (),
    apply: bool = False,
) -> BibliographyPlan:
    """Compare the survey's bibliography with our table of studies, and take it over when asked.

    Parameters
    ----------
    path : str or Path
        BibTeX or .bbl, UTF-8, with the survey's keys.
    directory : str or Path, optional
        Our tables; by default the package's own data.
    replace_studies : iterable of str
        Keys of studies whose confirmed identity is replaced where the bibliography contradicts it.
    apply : bool
        Write. Applying the same file twice changes nothing the second time.

    Returns
    -------
    BibliographyPlan
        What would be written, or has been.

    Raises
    ------
    SurveyImportError
        The file is no bibliography, it says nothing of a study named to be replaced, or (with
        `apply`) the tables would be invalid or cannot be written; nothing has been written.
    SurveyDataError
        Our own tables cannot be read.
    """
    folder = DATA_DIRECTORY if directory is None else Path(directory)
    entries = read_bibliography(path)
    with locked_tables(folder) if apply else nullcontext():
        plan = plan_identities(load(folder), entries, Path(path).name, frozenset(replace_studies))
        if not apply or not (plan.edits or plan.settled):
            return plan
        write_valid(folder, {_TABLE: _edit(folder, plan)})
        return replace(plan, written=len(plan.edits))


def plan_identities(
    tables: SurveyTables,
    entries: Iterable[Entry],
    source: str,
    replaced: frozenset[str] = frozenset(),
) -> BibliographyPlan:
    """Compare entries with the table of studies; `replaced` are studies that they may contradict.

    Raises
    ------
    SurveyImportError
        The entries say nothing of one of `replaced`.
    """
    rows = {str(row["key"]): row for row in tables.studies.to_dict("records")}
    meant = tables.references.dropna(subset=["mapped_key"])
    also = dict(zip(meant["key"], meant["mapped_key"], strict=True))
    other = {str(key) for key in tables.references["key"]} - {str(key) for key in also}
    differences: list[IdentityDifference] = []
    settled: list[str] = []
    left: list[tuple[str, str]] = []
    seen: set[str] = set()
    count = 0
    for entry in entries:
        count += 1
        key = str(also.get(entry.key, entry.key))
        reason = _refusal(entry, key, rows, seen)
        if reason:
            if entry.key not in other:
                left.append((entry.key, reason))
            continue
        seen.add(key)
        row = {name: _text(rows[key][name]) for name in (*_COLUMNS, "year", "identity")}
        found = _differences(key, row, entry, by_hand=key in replaced)
        differences += found
        if row["identity"] in _OPEN or (key in replaced and found):
            settled.append(key)
    if unsaid := sorted(replaced - seen):
        raise SurveyImportError(f"{source} says nothing of {', '.join(unsaid)}, to be replaced")
    missing = tuple(key for key in rows if key not in seen)
    return BibliographyPlan(source, count, tuple(differences), tuple(settled), tuple(left), missing)


def _refusal(entry: Entry, key: str, rows: Mapping[str, object], seen: set[str]) -> str:
    """Say why an entry tells nothing of a study; empty where it does."""
    if key not in rows:
        return "no study has this key"
    if key in seen:
        return "stands twice in the bibliography; the first is taken"
    if not entry.title:
        return "no title can be read"
    return ""


def _differences(
    key: str, row: Mapping[str, str], entry: Entry, *, by_hand: bool
) -> list[IdentityDifference]:
    theirs = {
        "title": entry.title,
        "authors": entry.authors,
        "venue": entry.venue,
        "type": "" if entry.kind == "unknown" else entry.kind,
        "doi": entry.doi,
        "url": _address(entry, row),
    }
    found = []
    for column, said in theirs.items():
        ours = row[column]
        if not said or _same(column, ours, said):
            continue
        empty = not ours or (column == "type" and ours == "unknown")
        open_to_change = by_hand or row["identity"] in _OPEN
        kind: Kind = "new" if empty else "changed" if open_to_change else "conflict"
        found.append(IdentityDifference(key, column, kind, ours, said, row["identity"], entry.line))
    if entry.year not in ("", row["year"]):
        found.append(
            IdentityDifference(
                key, "year", "kept", row["year"], entry.year, row["identity"], entry.line
            )
        )
    return found


def _address(entry: Entry, row: Mapping[str, str]) -> str:
    """Return an entry's address where ours has none and it can be linked to; empty elsewhere."""
    repeats = bool(entry.doi) and entry.url.endswith(entry.doi)
    return "" if row["url"] or repeats or fault(entry.url) else entry.url


def _same(column: str, ours: str, theirs: str) -> bool:
    """Say whether two texts mean the same, spelling and abbreviation aside."""
    if column in {"doi", "type"}:
        return ours.casefold() == theirs.casefold()
    if column == "authors":
        return _surnames(ours) == _surnames(theirs)
    one, two = normalise(ours), normalise(theirs)
    if column == "venue":  # one may have volume and pages, the other not
        one, two = (normalise(text.partition(", vol. ")[0]) for text in (ours, theirs))
    if column == "venue" and one and two and (one in two or two in one):
        return True
    return similarity(one, two) >= _ALIKE


def _surnames(authors: str) -> list[str]:
    return [normalise(name).split()[-1] for name in authors.split(";") if normalise(name)]


def _text(cell: object) -> str:
    return "" if pd.isna(cell) else str(cell)  # type: ignore[call-overload]


def _edit(folder: Path, plan: BibliographyPlan) -> str:
    """Return the text of studies.csv with the plan's cells in it."""
    header = list(column_types(_TABLE))
    rows = [list(c) for _, c in read_records(folder / file_name(_TABLE), header).rows]
    at = {name: index for index, name in enumerate(header)}
    by_key = {row[at["key"]]: row for row in rows}
    for edit in plan.edits:
        by_key[edit.study][at[edit.column]] = edit.theirs
    years = {d.study: f"which says {d.theirs}" for d in plan.differences if d.kind == "kept"}
    for key in plan.settled:
        row = by_key[key]
        said = (
            f"identified by the survey's bibliography ({plan.source}), {row[at['identity']]} before"
        )
        row[at["note"]] = "; ".join(filter(None, (row[at["note"]], said, years.get(key))))
        row[at["identity"]] = "confirmed"
    return csv_text(header, rows)
