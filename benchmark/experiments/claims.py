"""The survey's claims: every trial of each, by the rules and plans of `benchmark.claims.rules`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from algorithms.threads import one_thread
from benchmark.claims.experiment import find_experiments
from benchmark.claims.outcomes import (
    RECORD,
    outcome_of,
    outcome_of_row,
    plan_digest,
    row_of,
)
from benchmark.claims.plots import file_of, picture
from benchmark.claims.rules import FIRST_TRIAL, claims
from benchmark.results.modules import modules_digest
from benchmark.results.row_file import Row
from benchmark.running.experiment import RecordedExperiment


class Claims(RecordedExperiment[str]):
    """Results of the experiments that test the survey's claims.

    A row holds what was measured, never the verdict: that is computed at reading, by the rules as
    they stand.
    """

    name = "claims"
    title = "Claims of the survey"
    record = RECORD

    def keys(self) -> Mapping[str, str]:
        """Return the digests of plan and code, apart so that it shows which has changed."""
        return {
            name: f"{plan_digest(claims()[name])} {modules_digest(one.module)}"
            for name, one in find_experiments().items()
        }

    def why_outdated(self, row: Row, key: str) -> str:
        """Say whether plan or code has changed."""
        plan, _, code = key.partition(" ")
        outcome = outcome_of_row(row)
        if outcome.plan != plan:
            return "rules or plan changed"
        return "code changed" if outcome.code != code else ""

    def pictures(self) -> Mapping[str, Callable[[], str]]:
        """Draw each claim that has lines: median and extremes over its trials."""
        return {
            file_of(name): partial(self._draw, name)
            for name, row in self.record.read(self.directory).items()
            if row["lines"]
        }

    def _draw(self, name: str) -> str:
        outcome = outcome_of_row(self.record.read(self.directory)[name])
        return picture(claims()[name], outcome, find_experiments()[name].sketch)

    def tasks(self, cells: Sequence[str]) -> Sequence[str]:
        """Make a task of each claim."""
        return cells

    @staticmethod
    def measure(task: str) -> list[tuple[str, Row]]:
        """Make every trial of a claim, one after the other."""
        with one_thread():
            last = FIRST_TRIAL + claims()[task].trials
            trials = [find_experiments()[task].trial(number) for number in range(FIRST_TRIAL, last)]
        return [(task, row_of(outcome_of(claims()[task], trials)))]

    def comparable_members(self, row: Row) -> Row:
        """Leave out ratios of run times, and the lines of claims that have any."""
        timed = {rule.name for rule in claims()[row["claim"]].rules if rule.timed}
        kept = {
            member: {name: values for name, values in row[member].items() if name not in timed}
            for member in ("values", "second")
        }
        return {**kept, "lines": {} if timed else row["lines"]}
