"""What decides each direction, as it was written down before anything was measured for it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Literal, cast, get_args

from benchmark.results.csv_tables import StoreError
from survey_data.table_records import read_records

Kind = Literal["duel", "paper", "untried"]

FILE = Path(__file__).parent / "rules.csv"
COLUMNS = ("id", "specific", "kind", "question", "first", "second", "boards", "rule")
#: What decides where two families of methods meet on data sets.
DUEL = (
    "Of each family the best is chosen on half of the units of a data set and quoted on the other. "
    "It pays where the first family has the smaller error, by more than 3 % and beyond the scatter "
    "of units (5 %), on three quarters of the data sets that tell the two apart, two at least; it "
    "does not pay where the second has; else it depends on the data set."
)


@dataclass(frozen=True)
class Rule:
    """One direction: its question, who meets whom on what, and what decides.

    `first`, `second` and `boards` are selectors: ``field=a|b``, or ``field=!a|b`` for all others;
    of a question on paper `first` names the calculation.
    """

    id: str
    specific: str
    kind: Kind
    question: str
    first: str
    second: str
    boards: str
    rule: str

    @property
    def text(self) -> str:
        """The rule in words."""
        return DUEL if self.kind == "duel" else self.rule


@cache
def rules(path: Path = FILE) -> Mapping[str, Rule]:
    """Return the rules by id, in the order of the survey's table; StoreError for a broken file."""
    records = read_records(path, list(COLUMNS))
    if records.problems:
        raise StoreError("; ".join(map(str, records.problems)))
    found = {}
    for _, cells in records.rows:
        if cells[2] not in get_args(Kind):
            raise StoreError(f"{path.name}: {cells[0]}: expected a kind; got {cells[2]!r}")
        found[cells[0]] = Rule(cells[0], cells[1], cast("Kind", cells[2]), *cells[3:])
    return MappingProxyType(found)
