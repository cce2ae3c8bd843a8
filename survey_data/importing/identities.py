"""Which works the survey's keys are: its own bibliography compared with ours, and taken over."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Literal

from pydantic import BaseModel

from survey_data.descriptor import DATA_DIRECTORY
from survey_data.importing.bibliography import Entry, read_bibliography
from survey_data.importing.values import normalise, similarity
from survey_data.importing.writing import locked_tables, write_valid
from survey_data.problems import SurveyImportError
from survey_data.sources import fault
from survey_data.tables import SurveyTables, load
from survey_data.texts import load_texts

_TABLE = "studies"
_COLUMNS = ("title", "authors", "venue", "type", "doi", "url")
_ALIKE = 0.9
#: Identities that a bibliography settles; what a page has confirmed is a person's to change.
_OPEN = ("unknown", "ambiguous", "recalled")

Kind = Literal["new", "changed", "conflict", "kept"]


class IdentityDifference(BaseModel, frozen=True):
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


class LeftAside(BaseModel, frozen=True):
    """A key of the bibliography that is no study of ours, or not read, and why."""

    key: str
    reason: str


class BibliographyPlan(BaseModel, frozen=True):
    """What a bibliography changes in the table of studies.

    ``settled`` are the studies whose identity it confirms; ``missing`` ours that it does not name.
    """

    source: str
    entries: int
    differences: tuple[IdentityDifference, ...]
    settled: tuple[str, ...]
    left_aside: tuple[LeftAside, ...]
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
        BibTeX, UTF-8, with the survey's keys.
    directory : str or Path, optional
        Our tables; by default the package's own data.
    replace_studies : iterable of str
        Keys of studies whose confirmed identity is replaced where the bibliography contradicts it.
    apply : bool
        Write. Applying the same file twice changes nothing the second time.

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
        plan = _plan(load(folder), entries, Path(path).name, frozenset(replace_studies))
        if not apply or not (plan.edits or plan.settled):
            return plan
        write_valid(folder, {_TABLE: _edited(folder, plan)})
        return plan.model_copy(update={"written": len(plan.edits)})


def _plan(
    tables: SurveyTables, entries: Sequence[Entry], source: str, replaced: frozenset[str]
) -> BibliographyPlan:
    """Compare entries with the table of studies, of which they may contradict those `replaced`."""
    rows = {row["key"]: row for row in tables.studies.astype(object).fillna("").to_dict("records")}
    references = tables.references.fillna("")
    also = dict(zip(references["key"], references["mapped_key"], strict=True))
    differences: list[IdentityDifference] = []
    settled: list[str] = []
    left: list[LeftAside] = []
    seen: set[str] = set()
    for entry in entries:
        key = str(also.get(entry.key) or entry.key)
        reason = ""
        if key not in rows:
            reason = "no study has this key"
        elif key in seen:
            reason = "stands twice in the bibliography; the first is taken"
        elif not entry.title:
            reason = "no title can be read"
        if reason:
            if also.get(entry.key) != "":  # a work that the survey cites beside its studies
                left.append(LeftAside(key=entry.key, reason=reason))
            continue
        seen.add(key)
        row = {str(name): str(cell) for name, cell in rows[key].items()}
        found = _differences(row, entry, by_hand=key in replaced)
        differences += found
        if row["identity"] in _OPEN or (key in replaced and found):
            settled.append(key)
    if unsaid := sorted(replaced - seen):
        raise SurveyImportError(f"{source} says nothing of {', '.join(unsaid)}, to be replaced")
    return BibliographyPlan(
        source=source,
        entries=len(entries),
        differences=tuple(differences),
        settled=tuple(settled),
        left_aside=tuple(left),
        missing=tuple(key for key in rows if key not in seen),
    )


def _differences(
    row: Mapping[str, str], entry: Entry, *, by_hand: bool
) -> list[IdentityDifference]:
    theirs = entry.columns()
    theirs["type"] = "" if entry.kind == "unknown" else entry.kind
    theirs["url"] = _address(entry, row)
    found = []
    for column in (*_COLUMNS, "year"):
        ours, said = row[column], theirs[column]
        if not said or _same(column, ours, said):
            continue
        kind: Kind = "conflict"
        if column == "year":
            kind = "kept"
        elif not ours or (column == "type" and ours == "unknown"):
            kind = "new"
        elif by_hand or row["identity"] in _OPEN:
            kind = "changed"
        found.append(
            IdentityDifference(
                study=row["key"],
                column=column,
                kind=kind,
                ours=ours,
                theirs=said,
                identity=row["identity"],
                line=entry.line,
            )
        )
    return found


def _address(entry: Entry, row: Mapping[str, str]) -> str:
    """Return an entry's address where ours has none and it can be linked to; empty elsewhere."""
    repeats = bool(entry.doi) and entry.url.endswith(entry.doi)
    return "" if row["url"] or repeats or fault(entry.url) else entry.url


def _same(column: str, ours: str, theirs: str) -> bool:
    """Say whether two texts mean the same, spelling and abbreviation aside."""
    if column in {"doi", "type", "year"}:
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


def _edited(folder: Path, plan: BibliographyPlan) -> list[dict[str, str]]:
    """Return the rows of studies.csv with the plan's cells in them."""
    rows = {row["key"]: dict(row) for row in load_texts((_TABLE,), folder).studies}
    for edit in plan.edits:
        rows[edit.study][edit.column] = edit.theirs
    years = {d.study: f"which says {d.theirs}" for d in plan.differences if d.kind == "kept"}
    for key in plan.settled:
        row = rows[key]
        said = f"identified by the survey's bibliography ({plan.source}), {row['identity']} before"
        row["note"] = "; ".join(filter(None, (row["note"], said, years.get(key))))
        row["identity"] = "confirmed"
    return list(rows.values())
