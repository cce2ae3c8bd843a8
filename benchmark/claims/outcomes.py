"""Outcomes of claims as they are published: a row each.

A row holds what was measured, never the verdict: that is computed at reading, by the rules as they
stand. It says of what code and of which plan it is the outcome, so that a stale one shows.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np
from pydantic import BaseModel, model_validator

from benchmark.canonical import digest
from benchmark.claims.experiment import Trial
from benchmark.claims.rules import FIRST_TRIAL, Claim
from benchmark.metrics.separation import store
from benchmark.results.row_file import Row, RowFile
from benchmark.results.store import PUBLISHED

Values = Mapping[str, Sequence[float]]


class OutcomeError(ValueError):
    """Trials that do not fit their claim; the message says what was expected."""


@dataclass(frozen=True)
class Curve:
    """One line of the plot: places across; median and extremes over the trials, NaN for none."""

    x: tuple[float | str, ...]
    median: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]


@dataclass(frozen=True)
class ClaimOutcome:
    """What was measured of a claim: by rule a number a trial, and the lines of the plot.

    `second` is by the claim's second method; plan and code are digests of what it followed and of
    what measured it, empty before it is kept.
    """

    claim: str
    values: Values
    second: Values
    lines: Mapping[str, Curve]
    plan: str = ""
    code: str = ""


def plan_digest(claim: Claim) -> str:
    """Digest of what decides: trials, which, what differs between them, rules."""
    rules = [{k: v for k, v in asdict(rule).items() if k != "upper"} for rule in claim.rules]
    uppers = [None if math.isnan(rule.upper) else rule.upper for rule in claim.rules]
    return digest([claim.id, FIRST_TRIAL, claim.trials, claim.replicate, rules, uppers])


def outcome_of(claim: Claim, trials: Sequence[Trial]) -> ClaimOutcome:
    """Put the trials of a claim together.

    OutcomeError where they do not fit it, or each other.
    """
    names = {rule.name for rule in claim.rules}
    for number, trial in enumerate(trials):
        if set(trial.values) != names:
            raise OutcomeError(
                f"{claim.id}: trial {number} must give {', '.join(sorted(names))}; "
                f"it gives {', '.join(sorted(trial.values)) or 'nothing'}"
            )
        if not set(trial.second) <= names:
            raise OutcomeError(
                f"{claim.id}: the second method gives {sorted(set(trial.second) - names)}, which "
                "no rule asks for"
            )
    if claim.second and not all(trial.second for trial in trials):
        raise OutcomeError(f"{claim.id}: expected numbers by the second method ({claim.second})")
    return ClaimOutcome(
        claim.id,
        {rule.name: _numbers(t.values[rule.name] for t in trials) for rule in claim.rules},
        {
            rule.name: _numbers(t.second.get(rule.name, math.nan) for t in trials)
            for rule in claim.rules
            if any(rule.name in t.second for t in trials)
        },
        _curves(claim, trials),
    )


def row_of(outcome: ClaimOutcome) -> Row:
    """Return what the record keeps of an outcome, but for its digests; NaN is None."""
    row: Row = _without_nan(
        {
            "claim": outcome.claim,
            "values": outcome.values,
            "second": outcome.second,
            "lines": {name: asdict(line) for name, line in outcome.lines.items()},
        }
    )
    return row


def outcome_of_row(row: Row) -> ClaimOutcome:
    """Return the outcome that a row of the record keeps."""
    plan, _, code = row["key"].partition(" ")
    return ClaimOutcome(
        row["claim"],
        {name: _given(values) for name, values in row["values"].items()},
        {name: _given(values) for name, values in row["second"].items()},
        {
            name: Curve(
                tuple(line["x"]), *(_given(line[part]) for part in ("median", "low", "high"))
            )
            for name, line in row["lines"].items()
        },
        plan,
        code,
    )


def read_outcomes(directory: Path | str = PUBLISHED) -> dict[str, ClaimOutcome]:
    """Return every outcome of a record by its claim; StoreError for a broken file."""
    return {name: outcome_of_row(row) for name, row in RECORD.read(directory).items()}


class _Line(BaseModel, extra="forbid"):
    x: list[str | float]
    median: list[float | None]
    low: list[float | None]
    high: list[float | None]

    @model_validator(mode="after")
    def _is_of_one_length(self) -> Self:
        if not len(self.x) == len(self.median) == len(self.low) == len(self.high):
            raise ValueError("its lists are of different lengths")
        return self


class _Row(BaseModel, extra="forbid"):
    claim: str
    values: dict[str, list[float | None]]
    second: dict[str, list[float | None]]
    lines: dict[str, _Line]
    key: str


def _claim(row: Row) -> str:
    return str(row["claim"])


RECORD = RowFile("claims.json", "claims", 1, _claim, _Row)


def _curves(claim: Claim, trials: Sequence[Trial]) -> dict[str, Curve]:
    curves = {}
    for name in trials[0].lines:
        places = [tuple(trial.lines[name][0]) for trial in trials]
        if len(set(places)) > 1:
            raise OutcomeError(f"{claim.id}: trials place the points of {name!r} differently")
        up = np.array([trial.lines[name][1] for trial in trials], dtype=np.float64)
        if up.shape != (len(trials), len(places[0])):
            raise OutcomeError(
                f"{claim.id}: line {name!r} has {len(places[0])} places and {up.shape[1:]} values"
            )
        seen = ~np.isnan(up).all(axis=0)
        low, median, high = np.full((3, up.shape[1]), math.nan)
        low[seen], high[seen] = np.nanmin(up[:, seen], 0), np.nanmax(up[:, seen], 0)
        median[seen] = np.nanmedian(up[:, seen], 0)
        x = tuple(p if isinstance(p, str) else float(f"{p:.6g}") for p in places[0])
        curves[name] = Curve(x, _numbers(median), _numbers(low), _numbers(high))
    return curves


def _numbers(values: Any) -> tuple[float, ...]:
    rounded = (store(float(value)) for value in values)
    return tuple(math.nan if value is None else value for value in rounded)


def _given(values: Sequence[float | None]) -> tuple[float, ...]:
    return tuple(math.nan if value is None else float(value) for value in values)


def _without_nan(value: Any) -> Any:
    """Spell NaN as null; JSON has no other word for "none"."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {name: _without_nan(item) for name, item in value.items()}
    return [_without_nan(item) for item in value] if isinstance(value, list | tuple) else value
