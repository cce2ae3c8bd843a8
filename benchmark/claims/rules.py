"""What decides a claim: `rules.csv` and `trials.csv`.

`claims` joins them with the survey's statements (`survey_data/claims.csv`).
"""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import Any, Literal, get_args

from pydantic.dataclasses import dataclass as pydantic_dataclass

import survey_data

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

#: Fewer trials decide nothing.
FEWEST_TRIALS = 5
#: Number of the first trial. Those from 0 on were looked at while experiments were written and
#: settings settled; verdicts come from other units and random draws.
FIRST_TRIAL = 1000


@pydantic_dataclass(frozen=True)
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


@pydantic_dataclass(frozen=True)
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
        """Return the rule of this name."""
        return next(rule for rule in self.rules if rule.name == name)


@cache
def claims() -> Mapping[str, Claim]:
    """All claims by their ids, in the survey's order."""
    rules: dict[str, list[Rule]] = {}
    for row in rows_of(DIRECTORY / "rules.csv", RULES):
        upper, timed = row["upper"] or math.nan, row["timed"] == "yes"
        given: dict[str, Any] = {**row, "name": row["rule"], "upper": upper, "timed": timed}
        made = Rule(**{field.name: given[field.name] for field in fields(Rule)})
        rules.setdefault(row["claim"], []).append(made)
    plans = {row["claim"]: row for row in rows_of(DIRECTORY / "trials.csv", PLANS)}
    found = {}
    for said in survey_data.load().claims.fillna("").to_dict("records"):
        name = said["id"]
        given = {**plans[name], **{str(k): v for k, v in said.items()}}
        given |= {"statement": said["claim"], "rules": tuple(rules[name])}
        found[name] = Claim(**{field.name: given[field.name] for field in fields(Claim)})
    return found


def rows_of(path: Path, columns: Sequence[str]) -> list[dict[str, str]]:
    """Return the rows of a table by column."""
    with path.open(encoding="utf-8", newline="") as file:
        header, *rows = csv.reader(file)
    if tuple(header) != tuple(columns):
        raise ValueError(f"{path.name}: expected the columns {', '.join(columns)}")
    return [dict(zip(columns, cells, strict=True)) for cells in rows]
