"""The designs that meet requirements, ranked: all of them at once, as columns.

`RankedDesigns` is what every answer is made of, as objects (`registry.recommendation`) and as
bytes (`api.http.recommended`). Two questions often differ in few places: an architecture that is
left with the same designs and the same studies is ranked once, and kept for the next question.
Only who answers imports this module: it needs NumPy.
"""

from __future__ import annotations

import weakref
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from registry.designs import DesignTable, Kept
from registry.judging import KeptPlace, Question
from registry.kept_answers import KeptAnswers
from registry.ranking import Sort, TaskMeasure, joint_cost, key_of, task_measures

Numbers = NDArray[np.float64]
Positions = NDArray[np.int64]

#: Architectures that are kept as they were ranked, of a kilobyte or two each.
MOST_PLACES = 4096


@dataclass(frozen=True, eq=False)
class RankedPlace(KeptPlace):
    """An architecture among the ranked, the same object for all questions that leave it the same.

    Attributes
    ----------
    number : its position in the table
    meeting : its designs (bits) that meet the requirements
    designs : their positions, best first
    measures : the own measures of the tasks asked for
    key : what it is ranked by among others
    """

    number: int
    meeting: int
    designs: Positions
    measures: tuple[TaskMeasure, ...]
    key: tuple[float, ...]

    @cached_property
    def usual(self) -> Kept | None:
        """The measured calibration that most studies stand for; None for none.

        Of several the one that errs least, then the first.
        """
        columns, rank = self.judged.columns, self.judged.rank
        backed = [
            (-taken, rank[design], at)
            for at, design in enumerate(self.designs.tolist())
            if columns.measured[design]
            and (taken := (columns.designs[design].taken & self.studies).bit_count())
        ]
        return self.judged.kept(int(self.designs[min(backed)[-1]])) if backed else None

    @cached_property
    def repeatability(self) -> tuple[float, int]:
        """The least repeatability in degrees, and the position of the design that has it.

        Of measured designs that answer often enough to be judged; infinite where none has any.
        """
        return self._least(self.judged.repeatability_deg)

    @cached_property
    def field(self) -> tuple[float, int]:
        """The widest full field in degrees, negated; else as the repeatability."""
        half_deg, design = self._least(self.judged.negated_half_field_deg)
        return 2 * half_deg, design

    def _least(self, of_designs: Numbers) -> tuple[float, int]:
        values = of_designs[self.designs]
        least = values.min()
        order = self.judged.order[self.designs[values == least]].min()
        return float(least), int(self.judged.at_order[order])


_PLACES: weakref.WeakKeyDictionary[DesignTable, KeptAnswers[RankedPlace]] = (
    weakref.WeakKeyDictionary()
)


def kept_places(table: DesignTable) -> KeptAnswers[RankedPlace]:
    """Return the architectures of a table as questions had them ranked."""
    found = _PLACES.get(table)
    if found is None:
        found = _PLACES[table] = KeptAnswers(MOST_PLACES)
    return found


class RankedDesigns:
    """Designs (bits) that meet a question, best first; equals in the order of the table.

    A calibration whose extractor or model has no name in the taxonomy comes last, but by what is
    measured.

    Attributes
    ----------
    places : the architectures, best first
    count : how many designs they have together
    """

    def __init__(self, question: Question, designs: int, sort: Sort) -> None:
        self.question = question
        self.sort = sort
        self.count = designs.bit_count()
        self._meeting = designs
        self.places: Sequence[RankedPlace] = sorted(self._places(), key=attrgetter("key"))

    def _places(self) -> Iterator[RankedPlace]:
        """Yield the architectures in the order of the table."""
        question, meeting, sort = self.question, self._meeting, self.sort
        best, studies, all_stated = question.best, question.studies, question.all_stated
        advising = question.advising
        kept = kept_places(question.table)
        for number, (place, of_place) in enumerate(
            zip(question.table.places, question.columns.of_place, strict=True)
        ):
            designs = meeting & of_place
            if designs:
                has = (place.studies & studies, place.studies & all_stated)
                # All that its ranking depends on.
                key = (best, sort, advising, number, designs, *has)
                yield kept.find(key) or kept.keep(key, self._ranked(number, designs, *has))

    def _ranked(self, number: int, meeting: int, studies: int, stated: int) -> RankedPlace:
        question, best = self.question, self.question.best
        positions, segments = self._by_key
        start, end = segments[number : number + 2]
        designs = positions[start:end].copy()  # the rest of the positions need not be kept
        least = int(best.at_order[best.order[designs].min()])
        error = float(best.error[least])
        advice, tasks = question.advice[number]
        of_errors = "error" in question.asked.include
        backing = studies.bit_count()
        place = question.table.places[number]
        asked_tasks = question.asked.include.get("task", ())
        measures = task_measures(asked_tasks, place.architecture, best, least)
        own = joint_cost(measures) if measures else None
        key = key_of(self.sort, bool(advice), backing, error, own, of_errors=of_errors)
        return RankedPlace(
            place,
            *(studies, stated, advice, tasks, best, least, error),
            *(number, meeting, designs, measures, key),
        )

    @cached_property
    def _by_key(self) -> tuple[Positions, list[int]]:
        """All designs by place and rank, and where each place of the table begins.

        What designs are ranked by goes into one number each, the most important part in its
        highest bits: sorting those is many times quicker than sorting by one part after another.
        The cube root of the support, which rises with it, can be left out.
        """
        question, best = self.question, self.question.best
        columns, places = question.columns, question.table.places
        at = np.flatnonzero(columns.flags(self._meeting))
        of = columns.place_of[at]
        many = np.array([(place.studies & question.studies).bit_count() for place in places], int)
        with_model, taken = self._standing(at)
        most = (1 << columns.support_bits) - 1
        backing = (most - many[of] * with_model * taken, columns.support_bits)
        error = (best.rank[at], columns.design_bits)
        advised = (columns.not_advised[at], 1)
        parts = {
            "measured": (error, advised, backing),
            "support": ((columns.not_stated[at], 1), backing, error, advised),
            "advice": (error, advised, backing),
        }[self.sort]
        key = of.astype(np.int64)
        for values, bits in (*parts, (best.order[at], columns.design_bits)):
            key = (key << bits) | values
        key.sort()
        order = key & ((1 << columns.design_bits) - 1)
        return best.at_order[order], np.searchsorted(of, np.arange(len(places) + 1)).tolist()

    def _standing(self, at: Positions) -> tuple[Positions, Positions]:
        """Return how many studies stand for the stages of designs, and for their extractor too."""
        columns, question = self.question.columns, self.question
        every = columns.words_of([question.studies])
        if question.all_stated != question.studies:
            stated = columns.words_of([question.all_stated])
            every = np.where(columns.measured[at], every, stated)
        with_model = np.bitwise_count(columns.with_model[:, at] & every).sum(axis=0, dtype=np.int64)
        taken = np.bitwise_count(columns.taken[:, at] & every).sum(axis=0, dtype=np.int64)
        return with_model, taken

    def first(self) -> Kept | None:
        """Return the first calibration of the first architecture."""
        return self.question.kept(int(self.places[0].designs[0])) if self.places else None
