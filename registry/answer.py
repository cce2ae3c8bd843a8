"""The architectures that meet a question, ranked, each with its evidence and calibrations."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from registry.calibration import Calibration, calibration
from registry.design_table import Flags, Numbers, Positions
from registry.designs import Place
from registry.height_order import HeightOrder, height_order
from registry.judging import MEETS, MISSES, PARTS, Question, States
from registry.ranking import ALIKE, Sort, TaskMeasure, in_words, joint_order, task_measure
from registry.relaxation import Explanation, explain
from registry.reports import Report
from registry.requirements import OF_STUDIES, Level
from survey_data.processors import factor

STATE_NAMES = {MEETS: "meets", 0: "unknown", MISSES: "misses"}


@dataclass(frozen=True, eq=False)
class RankedArchitecture:
    """An architecture of the answer.

    Attributes
    ----------
    question, number : what it is an answer to; its position in the table
    rank, tied : None and False where nothing is asked; equal errors share a rank
    meets : kinds of evidence that meet all requirements: "reported", "measured"
    listed : positions of `reports`
    row : position of the pipeline of `best`; -1 for none
    shown_deg : the error that it is ordered by; infinite where there is none
    calibrations : how many meet the requirements
    measures : the own measures of the tasks asked for
    """

    question: Question
    number: int
    rank: int | None
    tied: bool
    meets: tuple[str, ...]
    listed: Sequence[int]
    row: int
    shown_deg: float
    calibrations: int
    measures: tuple[TaskMeasure, ...]

    @property
    def place(self) -> Place:
        """Its studies, products, designs and advice."""
        return self.question.table.places[self.number]

    @property
    def reports(self) -> tuple[Report, ...]:
        """Reports that meet all requirements, best first, or else the one that comes nearest."""
        return tuple(self.question.table.reports[at] for at in self.listed)

    @cached_property
    def best(self) -> Calibration | None:
        """The most accurate calibration that meets all, or else the one that comes nearest."""
        return None if self.row < 0 else calibration(self.question, self.row)

    @cached_property
    def evidence(self) -> Mapping[str, tuple[str | None, str | None, str | None]]:
        """For each requirement the state of reports, measurements and the survey's advice.

        None where that kind of evidence says nothing about such a requirement.
        """
        report = self.listed[0] if self.listed else -1
        return dict(_evidence(self.question, self.number, report, self.row))

    @property
    def backing(self) -> int:
        """Number of its studies and of products that none of these describes."""
        products = sum(self.place.studies.keys().isdisjoint(p.studies) for p in self.place.products)
        return len(self.place.studies) + products


class Answer:
    """Architectures that meet a question, best first in the order of `sort`.

    `on_the_ground` is the same question put to own errors, where it is not `question` itself.
    """

    def __init__(
        self, question: Question, sort: Sort, on_the_ground: Question | None = None
    ) -> None:
        self.question = question
        self.sort = sort
        self.on_the_ground = on_the_ground or question

    @cached_property
    def architectures(self) -> tuple[RankedArchitecture, ...]:
        """All architectures of the answer, best first."""
        found = [self._architecture(int(n)) for n in np.flatnonzero(self.question.matching_places)]
        keys = self._keys(found)
        ordered = [found[at] for at in sorted(range(len(found)), key=keys.__getitem__)]
        keys.sort()
        return tuple(self._ranked(ordered, keys))

    @property
    def design_count(self) -> int:
        """Number of calibrations that meet the requirements."""
        return int(np.count_nonzero(self.question.matching_designs))

    @property
    def is_asked(self) -> bool:
        """Whether anything is required."""
        return bool(self.question.requirements.names)

    @property
    def level(self) -> Level:
        """Level of error that is judged: own where nothing was flown, whatever was asked for."""
        return "own" if self.question.table is self.on_the_ground.table else "flight"

    @property
    def order(self) -> str:
        """The order as a sentence."""
        tasks = self.question.requirements.include.get("task", ())
        return in_words(self.sort, tasks, asked=self.is_asked, by_class=self._by_class)

    @cached_property
    def height_order(self) -> HeightOrder | None:
        """How far the errors follow 1/height; None where nothing is asked, or of too few."""
        if not self.is_asked:
            return None
        best = ((one.shown_deg, one.best and one.best.pipeline) for one in self.architectures)
        return height_order((error, made.height_mm if made else None) for error, made in best)

    @cached_property
    def explanation(self) -> Explanation | None:
        """Why nothing meets the requirements; None where something does."""
        return None if self.question.matching_places.any() else explain(self.question)

    @cached_property
    def on_better_bench(self) -> tuple[int, float] | None:
        """How many more architectures a better bench lets meet by measurement, and how good it is.

        None where no bench is stated, or the bench stands in the way of none.
        """
        question, asked = self.question, self.question.requirements
        if asked.bench_deg is None or asked.largest_deg is None:
            return None
        without = Question(question.table, replace(asked, bench_deg=None))
        place = question.table.row_place
        more = without.measured & ~question.measured_places[place]
        found = _nearest(more, {}, without.shown_deg, place)
        bench = without.bench_for(list(found.values()))
        return None if bench is None else (len(found), bench)

    def calibrations(self, one: RankedArchitecture) -> Iterator[Calibration]:
        """Yield the calibrations of an architecture that meet the requirements, best first."""
        table, best = self.question.table, self._best_row
        designs = np.flatnonzero(
            self.question.matching_designs & (table.design_place == one.number)
        )
        rows = best[designs]
        errors = np.full(len(rows), np.inf)
        errors[rows >= 0] = self.question.shown_deg[rows[rows >= 0]]
        users = table.used[designs].sum(axis=1)
        by = (~table.is_specified[designs], -users, ~table.is_advised[designs], errors)
        order = np.lexsort((errors, -users) if self.sort == "studies" else by)
        for at in order.tolist():
            design = table.designs[int(designs[at])]
            row = int(rows[at])
            yield calibration(self.question, row) if row >= 0 else Calibration(design, None)

    @cached_property
    def _best_row(self) -> Positions:
        """The most accurate pipeline of each design that meets the requirements; -1 for none."""
        question, table = self.question, self.question.table
        rows = np.flatnonzero(question.measured)
        order = rows[np.lexsort((question.shown_deg[rows], table.row_design[rows]))]
        found = np.full(len(table.designs), -1)
        found[table.row_design[order][::-1]] = order[::-1]
        return found

    @cached_property
    def _nearest_row(self) -> Mapping[int, int]:
        """Of each architecture the pipeline that misses fewest requirements, then errs least."""
        question, table = self.question, self.question.table
        among = question.candidates & np.isfinite(question.errors.own_error_deg)
        if not among.any():
            among = question.candidates
        shown, own = question.shown_deg, question.errors.own_error_deg
        values = np.where(np.isfinite(shown), shown, own)
        return _nearest(among, question.by_pipeline, values, table.row_place)

    @cached_property
    def _nearest_report(self) -> Mapping[int, int]:
        question, table = self.question, self.question.table
        among = np.ones(len(table.reports), bool)
        rms = table.report_numbers["rms_deg"]
        return _nearest(among, question.by_report, rms, table.report_place)

    @cached_property
    def _reporting(self) -> Mapping[int, list[int]]:
        """Of each architecture the reports that meet all requirements, best first."""
        question, table = self.question, self.question.table
        found: dict[int, list[int]] = {}
        by_rms = np.argsort(table.report_numbers["rms_deg"], kind="stable")
        for at in by_rms[question.reported[by_rms]].tolist():
            found.setdefault(int(table.report_place[at]), []).append(at)
        return found

    def _architecture(self, number: int) -> RankedArchitecture:
        question, table = self.question, self.question.table
        asked, place = question.requirements, table.places[number]
        listed = self._reporting.get(number, [])
        row = self._nearest_row.get(number, -1)
        is_measured = bool(row >= 0 and question.measured[row])
        shown = float(question.shown_deg[row]) if is_measured else math.inf
        if math.isinf(shown) and listed:
            rms = float(table.report_numbers["rms_deg"][listed[0]])
            shown = shown if math.isnan(rms) else rms
        pipeline = None if row < 0 else table.rows[row]
        nearest = [self._nearest_report[number]] if number in self._nearest_report else []
        return RankedArchitecture(
            question=question,
            number=number,
            rank=None,
            tied=False,
            meets=("reported",) * bool(listed) + ("measured",) * is_measured,
            listed=listed or nearest,
            row=row,
            shown_deg=shown,
            calibrations=int(self._design_counts[number]),
            measures=tuple(
                task_measure(task, place, pipeline, shown, factor(asked.processor))
                for task in asked.include.get("task", ())
            ),
        )

    @cached_property
    def _design_counts(self) -> Positions:
        of = self.question.table.design_place[self.question.matching_designs]
        return np.bincount(of, minlength=len(self.question.table.places))

    def _keys(self, found: Sequence[RankedArchitecture]) -> list[tuple[float, ...]]:
        """Return what each architecture is ordered by; equal numbers keep the taxonomy's order."""
        tasks = self.question.requirements.include.get("task", ())
        by: list[tuple[float, ...]] = [(one.shown_deg,) for one in found]
        if not self.is_asked or self.sort == "studies":
            by = [(-one.backing,) for one in found]
        elif self.sort == "evidence" and self._by_class:
            by = [(-self._class_reports(one),) for one in found]
        elif self.sort == "evidence" and len(tasks) == 1:
            by = [self._by_task(one, 0) for one in found]
        elif self.sort == "evidence" and tasks and found:
            costs = [[self._by_task(one, at) for one in found] for at in range(len(tasks))]
            by = [(total,) for total in joint_order(costs)]
        tiered = self.is_asked and self.sort == "evidence"
        return [
            (not one.place.is_built, _tier(one) if tiered else 0, *key, at)
            for at, (one, key) in enumerate(zip(found, by, strict=True))
        ]

    @property
    def _by_class(self) -> bool:
        """Whether an accuracy class is asked for without an error limit.

        Within a class none is better for a smaller error.
        """
        asked = self.question.requirements
        return "accuracy" in asked.include and asked.max_error_deg is None

    @staticmethod
    def _class_reports(one: RankedArchitecture) -> int:
        """Return how many distinct studies and products report all that is asked."""
        return len({report.family for report in one.reports}) * ("reported" in one.meets)

    def _by_task(self, one: RankedArchitecture, at: int) -> tuple[float, ...]:
        measure = one.measures[at]
        if math.isfinite(measure.cost):
            return (measure.cost, 0.0)
        studies = sum(measure.task in study.of("task") for study in one.place.studies.values())
        return (measure.cost, -studies)

    def _ranked(
        self, ordered: Sequence[RankedArchitecture], keys: Sequence[tuple[float, ...]]
    ) -> Iterator[RankedArchitecture]:
        """Give ranks: architectures with errors alike share one, those with more evidence first."""
        if not self.is_asked:
            yield from ordered
            return
        at = 0
        while at < len(ordered):
            end = at + 1
            while end < len(ordered) and self._alike(ordered, keys, at, end):
                end += 1
            group = sorted(ordered[at:end], key=lambda one: -one.backing)
            for one in group:
                yield replace(one, rank=at + 1, tied=len(group) > 1)
            at = end

    def _alike(
        self,
        ordered: Sequence[RankedArchitecture],
        keys: Sequence[tuple[float, ...]],
        first: int,
        other: int,
    ) -> bool:
        """Say whether an architecture shares the rank of the first of its group."""
        if keys[first][:2] != keys[other][:2]:
            return False
        tasks = self.question.requirements.include.get("task", ())
        of_numbers = self.sort == "evidence" and (
            self._by_class or tasks not in {(), ("Accuracy",)}
        )
        if self.sort == "studies" or of_numbers:
            return keys[first][2:-1] == keys[other][2:-1]
        one, two = ordered[first], ordered[other]
        if math.isinf(one.shown_deg):
            return math.isinf(two.shown_deg)
        spread = 0.0
        if self.question.requirements.bench_deg is None:
            spread = math.hypot(_log_error(one), _log_error(two))
        return two.shown_deg <= one.shown_deg * max(ALIKE, math.exp(2.0 * spread))


def _evidence(
    question: Question, number: int, report: int, row: int
) -> Iterator[tuple[str, tuple[str | None, str | None, str | None]]]:
    """Yield for each requirement but detector and mask the states of the kinds of evidence."""
    table, asked = question.table, question.requirements
    for name in asked.names:
        if name.removeprefix("exclude_") in {"detector", "mask"}:
            continue
        reported = _name_of(question.by_report, name, report)
        measured = _name_of(question.by_pipeline, name, row)
        if measured is None and row >= 0 and name in PARTS:
            measured = "meets"  # only pipelines of the required parts are candidates
        advised = None
        if name in {*OF_STUDIES, "accuracy"}:
            advised = "unknown"
            if table.places[number].is_advised_for(name, asked.include[name]):
                advised = "meets"
        yield name, (reported, measured, advised)


def _tier(one: RankedArchitecture) -> int:
    return {("reported", "measured"): 0, ("reported",): 1, ("measured",): 2}[one.meets]


def _log_error(one: RankedArchitecture) -> float:
    """Return the standard error of the log of the error shown; 0 for a reported one."""
    return float(one.question.table.log_error[one.row]) if "measured" in one.meets else 0.0


def _nearest(
    among: Flags, states: Mapping[str, States], values: Numbers, place: Positions
) -> dict[int, int]:
    """Return of each architecture the row that misses fewest requirements, then the least value."""
    rows = np.flatnonzero(among)
    failed = np.zeros(len(rows), int)
    for one in states.values():
        failed += one[rows] != MEETS
    order = rows[np.lexsort((values[rows], failed, place[rows]))]
    places, first = np.unique(place[order], return_index=True)
    return dict(zip(places.tolist(), order[first].tolist(), strict=True))


def _name_of(states: Mapping[str, States], name: str, at: int) -> str | None:
    """Return the state of a requirement in words; None where this kind says nothing of it."""
    if name not in states:
        return None
    return "unknown" if at < 0 else STATE_NAMES[int(states[name][at])]
