"""The designs that meet requirements, ranked: all of them at once, as columns.

`RankedDesigns` is what every answer is made of, as objects (`registry.recommendation`) and as
bytes (`api.http.recommended`). Only who answers imports this module: it needs NumPy.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from registry.designs import Kept
from registry.judging import KeptPlace, Question
from registry.ranking import Sort, key_of

Numbers = NDArray[np.float64]
Positions = NDArray[np.int64]

_NONE = np.iinfo(np.int64).max


@dataclass(frozen=True, eq=False)
class RankedPlace(KeptPlace):
    """An architecture among the ranked; ``designs`` are the positions of its calibrations.

    ``number`` is its position in the table, ``segment`` that among those that meet requirements.
    """

    number: int
    segment: int
    designs: Positions  # best first


class RankedDesigns:
    """Designs (bits) that meet a question, best first; equals in the order of the table.

    A calibration whose extractor or model has no name in the taxonomy comes last, but by what is
    measured.

    Attributes
    ----------
    places : the architectures, best first
    at : positions of the designs, in the order of the table
    """

    def __init__(self, question: Question, designs: int, sort: Sort) -> None:
        self.question = question
        self.sort = sort
        columns = question.columns
        self.at = np.flatnonzero(columns.flags(designs))
        of = columns.place_of[self.at]
        self._starts = np.flatnonzero(np.diff(of, prepend=-1))
        self._numbers: list[int] = of[self._starts].tolist()
        self._order = question.best.order[self.at]
        self.places: Sequence[RankedPlace] = self._ranked() if len(self.at) else ()

    @cached_property
    def _standing(self) -> tuple[Positions, Positions]:
        """How many studies stand for the stages of each design, and for its extractor too."""
        columns, question = self.question.columns, self.question
        every = columns.words_of([question.studies])
        if question.all_stated != question.studies:
            stated = columns.words_of([question.all_stated])
            every = np.where(columns.measured, every, stated)
        with_model = np.bitwise_count(columns.with_model & every).sum(axis=0, dtype=np.int64)
        taken = np.bitwise_count(columns.taken & every).sum(axis=0, dtype=np.int64)
        return with_model, taken

    def _ranked(self) -> list[RankedPlace]:
        question, sort = self.question, self.sort
        table, best = question.table, question.best
        numbers = self._numbers
        studies = [table.places[number].studies & question.studies for number in numbers]
        many = np.zeros(len(table.places), np.int64)
        many[numbers] = [bits.bit_count() for bits in studies]
        designs, segments = self._by_key(many)
        least_at = best.at_order[np.minimum.reduceat(self._order, self._starts)]
        least, errors = least_at.tolist(), best.error[least_at].tolist()
        found = [
            RankedPlace(
                table.places[number],
                bits,
                table.places[number].studies & question.all_stated,
                *question.advice[number],
                question,
                least[segment],
                errors[segment],
                number,
                segment,
                designs[segments[segment] : segments[segment + 1]],
            )
            for segment, (number, bits) in enumerate(zip(numbers, studies, strict=True))
        ]
        found.sort(
            key=lambda place: key_of(
                sort, bool(place.advice), place.studies.bit_count(), place.error_deg
            )
        )
        return found

    def _by_key(self, many: Positions) -> tuple[Positions, list[int]]:
        """Return all designs by place and rank, and where each place begins.

        What designs are ranked by goes into one number each, the most important part in its
        highest bits: sorting those is many times quicker than sorting by one part after another.
        The cube root of the support, which rises with it, can be left out.
        """
        columns, at, best = self.question.columns, self.at, self.question.best
        with_model, taken = self._standing
        of = columns.place_of[at]
        most = (1 << columns.support_bits) - 1
        backing = (most - many[of] * with_model[at] * taken[at], columns.support_bits)
        error = (best.rank[at], columns.design_bits)
        advised = (columns.not_advised[at], 1)
        parts = {
            "measured": (error, advised, backing),
            "support": ((columns.not_stated[at], 1), backing, error, advised),
            "advice": ((columns.not_stated[at], 1), advised, backing, error),
        }[self.sort]
        key = of.astype(np.int64)
        for values, bits in (*parts, (self._order, columns.design_bits)):
            key = (key << bits) | values
        key.sort()
        order = key & ((1 << columns.design_bits) - 1)
        return best.at_order[order], [*self._starts.tolist(), len(at)]

    def first(self) -> Kept | None:
        """Return the first calibration of the first architecture."""
        return self.question.kept(int(self.places[0].designs[0])) if self.places else None

    def usual(self, place: RankedPlace) -> Kept | None:
        """Return the measured calibration that most studies stand for; None for none.

        Of several the one that errs least, then the first.
        """
        taken = self._standing[1][place.designs]
        backed = np.flatnonzero((taken > 0) & self.question.columns.measured[place.designs])
        if not len(backed):
            return None
        rank = self.question.best.rank[place.designs[backed]]
        first = np.lexsort((rank, -taken[backed]))[0]
        return self.question.kept(int(place.designs[backed[first]]))

    def least(self, number: str) -> list[tuple[float, int]]:
        """Return the least of a number on each architecture, in ranked order, and who has it.

        Infinite where none has it; the design by its position.

        Parameters
        ----------
        number : "repeatability" (deg; more than 0, since an answer in steps says nothing) or
            "field" (full, deg, negated: the largest is the best); of measured designs that answer
            often enough to be judged
        """
        if not self.places:
            return []
        columns, best = self.question.columns, self.question.best
        row = best.row[self.at]
        of_rows = {
            "repeatability": columns.repeatability_deg,
            "field": -2 * columns.half_fov_deg,
        }[number]
        values = np.full(len(row), np.inf)
        known = (row >= 0) & np.isfinite(best.error[self.at])
        values[known] = of_rows[row[known]]
        values[np.isnan(values)] = np.inf
        least = np.minimum.reduceat(values, self._starts)
        reached = values == np.repeat(least, np.diff(self._starts, append=len(row)))
        order = np.minimum.reduceat(np.where(reached, self._order, _NONE), self._starts)
        found = list(zip(least.tolist(), best.at_order[order].tolist(), strict=True))
        return [found[place.segment] for place in self.places]
