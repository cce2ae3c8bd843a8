"""What decides each direction, as it was written down before anything was measured for it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal, cast, get_args

from benchmark.results.csv_tables import StoreError
from survey_data.table_records import read_records

if TYPE_CHECKING:
    from benchmark.datasets.preset import Preset

Kind = Literal["duel", "paper", "trial", "untried"]

NOT_TRIED = "not tried"
FILE = Path(__file__).parent / "rules.csv"
COLUMNS = ("id", "specific", "kind", "question", "first", "second", "boards", "rule")
#: What decides where two families of methods meet on data sets.
DUEL = (
    "Of each family the two that lead on the standard unit are scored on ten units; the better is "
    "chosen on the even ones and quoted on the odd. "
    "It pays where the first family has the smaller error, by more than 3 % and beyond the scatter "
    "of units (5 %), on three quarters of the data sets that tell the two apart, two at least; it "
    "does not pay where the second has; else it depends on the data set, and where fewer than two "
    "tell them apart it is open. Changed after a first outcome of D07: a model behind "
    "compensations counts among all others only, so that filters meet with the same readings."
)


@dataclass(frozen=True)
class Rule:
    """One direction: its question, who meets whom on what, and what decides.

    `first`, `second` and `boards` are selectors: ``field=a|b``, or ``field=!a|b`` for all others;
    of a question on paper `first` names the calculation, of a trial the experiment.
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

    @property
    def families(self) -> tuple[str, str]:
        """Selectors of both families."""
        return self.first, self.second

    def is_on(self, preset: Preset) -> bool:
        """Say whether the two meet on a data set."""
        return selects(
            self.boards,
            {
                "mask": preset.mask,
                "observation": str(preset.observation),
                "context": "flight" if preset.context_columns else "ground",
            },
        )


def selects(selector: str, facts: Mapping[str, str]) -> bool:
    """Say whether ``field=a|b`` names these facts; ``field=!a|b`` all others, "" all."""
    if not selector:
        return True
    field, names = selector.split("=")
    named = facts[field] in names.removeprefix("!").split("|")
    return named != names.startswith("!")


def is_of(family: str, extractor: str, model: str) -> bool:
    """Say whether a pipeline belongs to a family.

    Behind compensations a model counts among all others only: two families by name meet with the
    same readings before them.
    """
    if " + " in model and family.startswith("model=") and "!" not in family:
        return False
    return selects(family, {"extractor": extractor, "model": model.rsplit(" + ", maxsplit=1)[-1]})


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
