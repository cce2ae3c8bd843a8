"""The designs that meet a question, ranked: all of them at once, as arrays.

`registry.answer_json` writes an answer as JSON. Needs NumPy, so that only modules that answer
questions import it.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache
from operator import attrgetter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from registry.designs import Candidate, DesignTable, Place
from registry.judging import Question, advice_for
from registry.mapping.advice import Advice
from registry.pipelines import PipelineErrors, begins
from registry.ranking import (
    Regret,
    Sort,
    TaskMeasure,
    joint_cost,
    key_of,
    pareto,
    regret,
    task_measures,
)
from registry.relaxation import BlockingConstraint, explain

Numbers = NDArray[np.float64]
Positions = NDArray[np.int64]

#: Tasks and accuracies whose advice is kept, and architectures whose measures are.
MOST_ADVISING, MOST_PLACES = 128, 4096


class RankedPlace(NamedTuple):
    """An architecture that meets the requirements.

    Attributes
    ----------
    key : what it is ranked by
    number, at : its position in the table, and among those that meet the requirements
    studies : its studies (bits) that have what is asked of studies
    stated : those of them by which designs that are not measured are judged
    start, end : its part of `Answer.designs`
    best, row : the design with the smallest error and its pipeline, by position; -1 for none
    rank_of_best : of that design on the architecture
    advice : the survey's advice for what is asked
    advised_tasks : tasks of that advice
    measures : the own measures of the tasks asked for
    """

    key: tuple[float, ...]
    number: int
    at: int
    place: Place
    studies: int
    stated: int
    start: int
    end: int
    best: int
    row: int
    rank_of_best: int
    error_deg: float
    advice: tuple[Advice, ...]
    advised_tasks: frozenset[str]
    measures: tuple[TaskMeasure, ...]


class Answer:
    """Designs that meet a question, best first; equals in the order of the table.

    A calibration whose extractor or model has no name in the taxonomy comes last, but by what is
    measured.

    Attributes
    ----------
    designs : positions of the designs, by architecture and then best first
    places : the architectures, best first
    """

    def __init__(self, question: Question, sort: Sort) -> None:
        self.question = question
        self.sort = sort
        self.best = question.best_pipelines
        counting = question.studies, question.stated_of_unmeasured
        every, used = question.arrays.rank_designs(self.best, *counting, sort)
        self.designs: Positions = every[question.matching_designs.take(every)]
        self._used = used
        self._of = question.arrays.place_of.take(self.designs)
        self._starts = np.flatnonzero(begins(self._of)) if len(self._of) else self._of
        self.places: Sequence[RankedPlace] = sorted(self._places(), key=attrgetter("key"))

    @property
    def count(self) -> int:
        """How many designs meet the question."""
        return len(self.designs)

    def _places(self) -> list[RankedPlace]:
        """Return the architectures in the order of the table."""
        if not self.count:
            return []
        question, best, sort = self.question, self.best, self.sort
        include, advising = question.requirements.include, question.advice_key
        tasks, of_errors = include.get("task", ()), "error" in include
        studies, stated = question.studies, question.stated_of_unmeasured
        facts = question.table.made(_PlaceFacts)
        advice_of = facts.advice(advising)
        starts: list[int] = self._starts.tolist()
        ends = (*starts[1:], self.count)
        # Of each architecture the design that comes first by error, and its place among all.
        numbers = question.arrays.numbers[: self.count]
        bits = question.arrays.design_bits
        first = np.minimum.reduceat(best.order.take(self.designs) << bits | numbers, self._starts)
        places_of_best = first & ((1 << bits) - 1)
        least = self.designs.take(places_of_best)
        found = []
        for number, at, start, end, best_at, design, row, error in zip(
            self._of.take(self._starts).tolist(),
            range(len(starts)),
            starts,
            ends,
            places_of_best.tolist(),
            least.tolist(),
            best.row.take(least).tolist(),
            best.error.take(least).tolist(),
            strict=True,
        ):
            place = question.table.places[number]
            has = place.studies & studies
            advice, advised_tasks = advice_of[number]
            own: float | None = None
            measures: tuple[TaskMeasure, ...] = ()
            if tasks:
                own, measures = facts.measures(number, tasks, best.errors, row, error)
            backing = has.bit_count()
            key = key_of(sort, bool(advice), backing, error, own, of_errors=of_errors)
            within = place.studies & stated
            rank = best_at - start + 1
            found.append(
                RankedPlace(
                    key,
                    number,
                    at,
                    place,
                    has,
                    within,
                    start,
                    end,
                    design,
                    row,
                    rank,
                    error,
                    advice,
                    advised_tasks,
                    measures,
                )
            )
        return found

    @cached_property
    def usual(self) -> dict[int, tuple[int, int, float]]:
        """The measured calibration that most studies used, by architecture, its pipeline and error.

        Of several the one with the smallest error, then the first. All by position.
        """
        used = self._used[self.question.matching_designs.take(self._used)]
        places = self.question.arrays.place_of.take(used)
        first = begins(places)
        designs = used[first]
        rows, errors = self.best.row.take(designs), self.best.error.take(designs)
        found = zip(designs.tolist(), rows.tolist(), errors.tolist(), strict=True)
        return dict(zip(places[first].tolist(), found, strict=True))

    def candidate(self, design: int) -> Candidate:
        """Return a design, given by position, with its best pipeline."""
        return self.best.candidate(design)

    def least_by_place(self, values: Numbers) -> list[float]:
        """Return the least of some values of designs on each architecture, best first."""
        if values is self.best.error:
            return [place.error_deg for place in self.places]
        least: list[float] = np.minimum.reduceat(values.take(self.designs), self._starts).tolist()
        return [least[place.at] for place in self.places]

    def design_with_least(self, place: RankedPlace, values: Numbers) -> int:
        """Return the design on an architecture that reaches the least of some values."""
        if values is self.best.error:
            return place.best
        designs = self.designs[place.start : place.end]
        found = values[designs]
        order = self.best.order[designs[found == found.min()]].min()
        return int(self.best.at_order[order])

    @property
    def regret(self) -> Regret | None:
        """Error of the first calibration beside the best one's; None if none is measured."""
        if not self.places:
            return None
        least = min(self.places, key=attrgetter("error_deg"))
        first = self.candidate(int(self.designs[self.places[0].start]))
        return regret(first, self.candidate(least.best))

    @property
    def pareto(self) -> frozenset[int]:
        """Positions of the architectures that none beats in both studies and error."""
        return pareto([(-one.studies.bit_count(), one.error_deg) for one in self.places])

    @property
    def untested_architectures(self) -> dict[str, tuple[tuple[str, str], ...]]:
        """Architectures that no data set tries a hazard on, by the hazards asked for."""
        question = self.question
        return {
            hazard: question.arrays.untested_architectures(hazard)
            for hazard in question.requirements.survive
        }

    @property
    def untimed_count(self) -> int:
        """How many measured pipelines a limit on latency cannot judge; 0 where none is asked."""
        if self.question.requirements.max_latency_us is None:
            return 0
        return int(np.isinf(self.question.arrays.latency_us).sum())

    @cached_property
    def blocking_constraint(self) -> BlockingConstraint | None:
        """Why nothing meets the requirements, if nothing does."""
        return None if self.places else explain(self.question)


class _PlaceFacts:
    """Advice and measures of the architectures of a table, kept for the next question."""

    def __init__(self, table: DesignTable) -> None:
        self._table = table
        self.advice = lru_cache(MOST_ADVISING)(self._advice)
        self.measures = lru_cache(MOST_PLACES)(self._measures)

    def _advice(
        self, advising: tuple[tuple[str, ...] | None, ...]
    ) -> list[tuple[tuple[Advice, ...], frozenset[str]]]:
        return [advice_for(place, advising) for place in self._table.places]

    def _measures(
        self, number: int, tasks: tuple[str, ...], errors: PipelineErrors, row: int, error: float
    ) -> tuple[float, tuple[TaskMeasure, ...]]:
        pipeline = None if row < 0 else errors.table.rows[row]
        architecture = self._table.places[number].architecture
        measures = task_measures(tasks, architecture, pipeline, error)
        return joint_cost(measures), measures
