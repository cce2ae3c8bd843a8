"""Outcomes of experiments as they are published: one JSON file a claim.

A file holds what was measured, never the verdict: that is computed at reading, by the rules as
they stand. It says of what code and of which plan it is the outcome, so that a stale one shows.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmark.canonical import digest
from benchmark.claims.experiment import Experiment, Trial
from benchmark.claims.rules import FIRST_TRIAL, Claim
from benchmark.metrics.score import stored
from benchmark.results import recorded
from benchmark.results.closure import closure_digest
from files.reading import FileRefusedError
from files.strict_json import read_json, refuse_unless, require_members, require_type

#: Where the published ones are.
PUBLISHED = Path(__file__).resolve().parents[1] / "published" / "claims"

Values = Mapping[str, Sequence[float]]


class OutcomeError(ValueError):
    """Trials or a file that do not fit their claim; the message says what was expected."""


@dataclass(frozen=True)
class Curve:
    """One line of the plot: places across; median and extremes over the trials, NaN for none."""

    across: tuple[float | str, ...]
    median: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]


@dataclass(frozen=True)
class Outcome:
    """What was measured of a claim.

    Attributes
    ----------
    claim
        Its id.
    code, plan
        Digests of the code that measured it and of the plan it followed.
    values, second
        By rule, a number a trial: by the experiment, and by the claim's second method.
    lines
        Of the plot.
    """

    claim: str
    code: str
    plan: str
    values: Values
    second: Values
    lines: Mapping[str, Curve]


def plan_digest(claim: Claim) -> str:
    """Digest of what decides: trials, which, what differs between them, rules."""
    rules = [{k: v for k, v in asdict(rule).items() if k != "upper"} for rule in claim.rules]
    uppers = [None if math.isnan(rule.upper) else rule.upper for rule in claim.rules]
    return digest([claim.id, FIRST_TRIAL, claim.trials, claim.replicate, rules, uppers])


def outcome_of(claim: Claim, experiment: Experiment, trials: Sequence[Trial]) -> Outcome:
    """Put the trials of an experiment together.

    Raises
    ------
    OutcomeError
        Where a trial lacks a rule's statistic or has another's, where lines differ in their
        places, or where the second method is announced and missing.
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
    return Outcome(
        claim.id,
        closure_digest(experiment.module),
        plan_digest(claim),
        {rule.name: _numbers(t.values[rule.name] for t in trials) for rule in claim.rules},
        {
            rule.name: _numbers(t.second.get(rule.name, math.nan) for t in trials)
            for rule in claim.rules
            if any(rule.name in t.second for t in trials)
        },
        _curves(claim, trials),
    )


def stale(claim: Claim, experiment: Experiment, outcome: Outcome | None) -> str:
    """Say why an outcome has to be measured again; empty where it need not."""
    if outcome is None:
        return "not measured"
    if outcome.plan != plan_digest(claim):
        return "rules or plan changed"
    if outcome.code != closure_digest(experiment.module):
        return "code changed"
    return ""


def read(directory: Path = PUBLISHED) -> dict[str, Outcome]:
    """Read every outcome of a directory by its claim; OutcomeError for a broken file."""
    return {path.stem: _read(path) for path in sorted(directory.glob("C*.json"))}


def write(outcome: Outcome, directory: Path = PUBLISHED) -> None:
    """Write an outcome, whole or not at all."""
    document = _without_nan(asdict(outcome))
    text = json.dumps(document, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    name = f"{directory.name}/{outcome.claim}.json"
    recorded.write(directory.parent, {name: text.replace('"},', '"},\n') + "\n"})


def _read(path: Path) -> Outcome:
    try:
        document = require_members(read_json(path), path, _MEMBERS)
        named = document["claim"]
        refuse_unless(named == path.stem, path, f"is of claim {named!r}, by its content")
        return Outcome(
            document["claim"],
            document["code"],
            document["plan"],
            {name: _given(path, name, values) for name, values in document["values"].items()},
            {name: _given(path, name, values) for name, values in document["second"].items()},
            {name: _curve(path, name, line) for name, line in document["lines"].items()},
        )
    except (FileRefusedError, FileNotFoundError) as error:
        raise OutcomeError(
            f"{path.name} is no outcome of a claim ({error}); measure it again with "
            "`python -m benchmark.claims.run`"
        ) from error


_MEMBERS = {
    **dict.fromkeys(("claim", "code", "plan"), str),
    **dict.fromkeys(("values", "second", "lines"), dict),
}


def _curve(path: Path, name: str, line: Any) -> Curve:
    require_members(line, path, dict.fromkeys(("across", "median", "low", "high"), list))
    for place in line["across"]:
        require_type(place, (str, int, float), path, f"{name}, across")
    curve = Curve(
        tuple(line["across"]),
        *(_given(path, f"{name}, {k}", line[k]) for k in ("median", "low", "high")),
    )
    lengths = {len(part) for part in (curve.across, curve.median, curve.low, curve.high)}
    refuse_unless(len(lengths) == 1, path, f"{name}: its lists are of different lengths")
    return curve


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
        across = tuple(p if isinstance(p, str) else float(f"{p:.6g}") for p in places[0])
        curves[name] = Curve(across, _numbers(median), _numbers(low), _numbers(high))
    return curves


def _numbers(values: Any) -> tuple[float, ...]:
    rounded = (stored(float(value)) for value in values)
    return tuple(math.nan if value is None else value for value in rounded)


def _given(path: Path, name: str, values: Any) -> tuple[float, ...]:
    for value in require_type(values, list, path, name):
        require_type(value, (int, float, type(None)), path, name)
    return tuple(math.nan if value is None else float(value) for value in values)


def _without_nan(value: Any) -> Any:
    """Spell NaN as null; JSON has no other word for "none"."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {name: _without_nan(item) for name, item in value.items()}
    return [_without_nan(item) for item in value] if isinstance(value, list | tuple) else value
