"""What decides a claim: `rules.csv` and `trials.csv`.

`claims` joins them with the survey's statements (`survey_data/claims.csv`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Literal, TypeVar, cast, get_args

import survey_data
from files.reading import parse_decimal, parse_integer
from survey_data.table_records import read_records

DIRECTORY = Path(__file__).resolve().parent

#: How the trials of a statistic are averaged: as they are, or their logarithms (ratios, errors).
Scale = Literal["linear", "log"]
Relation = Literal["<", "<=", ">", ">=", "within"]
Verdict = Literal["reproduced", "partly", "not reproduced here", "refuted", "not testable"]
#: Every verdict, best for the survey first.
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)
#: What a trial has of its own: another unit of the sensor, or other random draws.
Replicate = Literal["unit", "seed"]

#: Columns of the two tables.
RULES = ("claim", "rule", "statistic", "scale", "relation", "limit", "upper", "timed")
PLANS = ("claim", "family", "trials", "replicate", "measured_on", "x_label", "y_label", "second")

_Number = TypeVar("_Number", int, float)

#: Fewer trials decide nothing.
FEWEST_TRIALS = 5
#: Number of the first trial. Those from 0 on were looked at while experiments were written and
#: settings settled; verdicts come from other units and random draws.
FIRST_TRIAL = 1000


class RulesError(ValueError):
    """Rules, plans and claims that do not fit each other; the message names where."""


@dataclass(frozen=True)
class Rule:
    """One thing that has to hold for a claim.

    It holds where the statistic of the trials, averaged by `scale`, is so related to the limit;
    `upper` is the other end of ``within``, NaN elsewhere. `timed`: the statistic is a ratio of run
    times, which no other run repeats to the digit.
    """

    name: str
    statistic: str
    scale: Scale
    relation: Relation
    limit: float
    upper: float
    timed: bool

    def __str__(self) -> str:
        if self.relation == "within":
            return f"within {self.limit:g} and {self.upper:g}"
        return f"{self.relation} {self.limit:g}"


@dataclass(frozen=True)
class Claim:
    """One statement of the survey and how it is put to the test.

    Id, section, study (empty where the survey names none), statement and test are as in
    `survey_data/claims.csv`; `family` is the folder of `benchmark.claims.experiments` with the
    experiment, `replicate` what differs between trials, `second` the other method that the outcome
    is checked by, in words; empty for none. All rules have to hold.
    """

    id: str
    section: str
    study: str
    statement: str
    how_to_test: str
    family: str
    trials: int
    replicate: Replicate
    measured_on: str
    x_label: str
    y_label: str
    second: str
    rules: tuple[Rule, ...]

    def rule(self, name: str) -> Rule:
        """Return the rule of this name; RulesError naming the known ones."""
        for rule in self.rules:
            if rule.name == name:
                return rule
        known = ", ".join(rule.name for rule in self.rules)
        raise RulesError(f"claim {self.id} has no rule {name!r}; it has {known}")


@cache
def claims() -> Mapping[str, Claim]:
    """All claims by their ids, in the survey's order.

    RulesError where a claim has no rule or no plan, or a rule or plan no claim.
    """
    table = survey_data.load().claims.set_index("id")
    stated = {
        str(key): dict(zip(table.columns, row, strict=True)) for key, *row in table.itertuples()
    }
    rules: dict[str, list[Rule]] = {}
    for row in rows_of(DIRECTORY / "rules.csv", RULES):
        rules.setdefault(row["claim"], []).append(_rule(row))
    plans: dict[str, Mapping[str, str]] = {}
    for row in rows_of(DIRECTORY / "trials.csv", PLANS):
        if plans.setdefault(row["claim"], row) is not row:
            raise RulesError(f"trials.csv: claim {row['claim']} stands there twice")
    if not set(stated) == set(rules) == set(plans):
        odd = sorted((set(stated) ^ set(rules)) | (set(stated) ^ set(plans)))
        raise RulesError(
            f"every claim needs rules and a plan, and they a claim; not so: {', '.join(odd)}"
        )
    return {key: _claim(key, said, plans[key], tuple(rules[key])) for key, said in stated.items()}


def _claim(
    key: str, said: Mapping[str, object], plan: Mapping[str, str], rules: tuple[Rule, ...]
) -> Claim:
    names = [rule.name for rule in rules]
    if len(set(names)) < len(names):
        raise RulesError(f"claim {key} has two rules of one name among {', '.join(names)}")
    trials = _number(plan["trials"], parse_integer, f"claim {key}, trials")
    if trials < FEWEST_TRIALS:
        raise RulesError(f"claim {key} plans {trials} trials; at least {FEWEST_TRIALS} decide")
    return Claim(
        id=key,
        section=_text(said["section"]),
        study=_text(said["study"]),
        statement=_text(said["claim"]),
        how_to_test=_text(said["how_to_test"]),
        family=plan["family"],
        trials=trials,
        replicate=cast("Replicate", _one_of(plan["replicate"], Replicate, key)),
        measured_on=plan["measured_on"],
        x_label=plan["x_label"],
        y_label=plan["y_label"],
        second=plan["second"],
        rules=rules,
    )


def _rule(row: Mapping[str, str]) -> Rule:
    place = f"{row['claim']} {row['rule']}"
    rule = Rule(
        name=row["rule"],
        statistic=row["statistic"],
        scale=cast("Scale", _one_of(row["scale"], Scale, place)),
        relation=cast("Relation", _one_of(row["relation"], Relation, place)),
        limit=_number(row["limit"], parse_decimal, f"{place}, limit"),
        upper=_number(row["upper"], parse_decimal, f"{place}, upper") if row["upper"] else math.nan,
        timed=_one_of(row["timed"], Literal["yes", ""], place) == "yes",
    )
    if (rule.relation == "within") != (rule.upper > rule.limit):
        raise RulesError(
            f"{place}: `within` needs an upper limit above the lower one, and nothing else has "
            f"one; got {rule.relation} {row['limit']} {row['upper']}"
        )
    return rule


def _one_of(value: str, allowed: object, place: str) -> str:
    known = get_args(allowed)
    if value not in known:
        raise RulesError(f"{place}: expected one of {', '.join(known)}; got {value!r}")
    return value


def _text(value: object) -> str:
    return value if isinstance(value, str) else ""


def rows_of(path: Path, columns: Sequence[str]) -> list[dict[str, str]]:
    """Return the rows of a table by column; RulesError naming file, row and column of a flaw."""
    records = read_records(path, columns)
    if records.problems:
        raise RulesError(str(records.problems[0]))
    return [dict(zip(columns, cells, strict=True)) for _, cells in records.rows]


def _number(text: str, read: Callable[[str], _Number], place: str) -> _Number:
    try:
        return read(text)
    except ValueError as error:
        raise RulesError(f"{place}: {error}") from error
