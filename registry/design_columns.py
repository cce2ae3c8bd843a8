"""Designs and their measured pipelines as columns: what makes many of them one step each.

Built once of a table of designs (`registry.designs`), whose order they keep. Sets of designs are
integers, one bit a design, as sets of studies are; numbers are arrays over designs or pipelines.
Only who answers imports this module: it needs NumPy.
"""

from __future__ import annotations

import itertools
import weakref
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from registry.designs import NOTHING, Design, DesignTable, Kept, Limits, Place
from registry.judged_columns import Judgements, PipelineColumns, begins
from registry.kept_answers import KeptAnswers
from registry.measured import Measured

Flags = NDArray[np.bool_]
Numbers = NDArray[np.float64]
Positions = NDArray[np.int64]
Words = NDArray[np.uint64]

WORD_BITS = 64
_LARGEST_KEY = 63


@dataclass(frozen=True, eq=False)
class Best:
    """The best pipeline of each design among those that keep some limits.

    Attributes
    ----------
    columns : the designs
    judgements : what their pipelines are judged by
    limits : that they keep
    row : position of the pipeline, shape (designs,); -1 where none keeps them
    error : the error it is judged by; infinite where there is none
    order : of the designs, the least error first, measured ones first of the same, shape (designs,)
    rank : of the error, equal errors alike
    at_order : the design at each place of that order
    keeping : designs (bits) of which one keeps them
    """

    columns: DesignColumns
    judgements: Judgements
    limits: Limits
    row: Positions
    error: Numbers
    order: Positions
    rank: Positions
    at_order: Positions
    keeping: int
    _finest: KeptAnswers[Mapping[int, int]] = field(default_factory=lambda: KeptAnswers(16))

    @cached_property
    def repeatability_deg(self) -> Numbers:
        """Spread of the answers to one pose, of each design; infinite where it is not judged.

        An answer in steps repeats exactly, which says nothing: the pipelines have none then.
        """
        return self._of_designs(self.columns.repeatability_deg)

    @cached_property
    def negated_half_field_deg(self) -> Numbers:
        """Half field of each design, the widest the least; infinite where it is not judged."""
        return self._of_designs(-self.columns.half_fov_deg)

    def _of_designs(self, of_rows: Numbers) -> Numbers:
        known = (self.row >= 0) & np.isfinite(self.error)
        found = np.full(len(self.row), np.inf)
        found[known] = of_rows[self.row[known]]
        found[np.isnan(found)] = np.inf
        return found

    def finest(self, designs: int) -> Mapping[int, int]:
        """Return what errs least of the pipelines that answer too seldom, by place.

        Of some designs (bits); both by position.
        """
        return self._finest.get(
            designs, lambda: self.judgements.finest(self.limits, self.columns.flags(designs))
        )

    def pipeline(self, design: int) -> Measured | None:
        """Return the best pipeline of a design, given by position; None for none."""
        row = int(self.row[design])
        return None if row < 0 else self.columns.rows[row]

    def kept(self, design: int) -> Kept:
        """Return a design, given by position, with what it is judged by."""
        row, columns = int(self.row[design]), self.columns
        pipeline = self.pipeline(design)
        judged = NOTHING if pipeline is None else self.judgements.of(row)
        return Kept(design, row, columns.designs[design], pipeline, judged)


class DesignColumns(PipelineColumns):
    """Columns of the designs of a table.

    Parameters
    ----------
    places : of the table
    studies : how many there are
    """

    def __init__(self, places: Sequence[Place], studies: int) -> None:
        self.places = places
        self.designs: tuple[Design, ...] = tuple(d for place in places for d in place.designs)
        self.words = studies // WORD_BITS + 1
        self.everyone = (1 << studies) - 1
        self.every = (1 << len(self.designs)) - 1
        self.place_of = _repeated([len(place.designs) for place in places])
        design_of = _repeated([len(design.rows) for design in self.designs])
        rows = tuple(row for design in self.designs for row in design.rows)
        super().__init__(rows, self.place_of[design_of], design_of)
        self.first_row = np.cumsum([0, *(len(design.rows) for design in self.designs)])
        first = [0, *itertools.accumulate(len(place.designs) for place in places)]
        self.of_place = tuple(
            ((1 << end) - 1) ^ ((1 << start) - 1) for start, end in itertools.pairwise(first)
        )
        self.taken = self.words_of(design.taken for design in self.designs)
        self.with_model = self.words_of(design.with_model for design in self.designs)
        self.measured = np.array([bool(design.rows) for design in self.designs], bool)
        self.not_advised = np.array([not design.advised for design in self.designs], np.int64)
        self.not_stated = np.array([not design.stated for design in self.designs], np.int64)
        self.unmeasured = np.flatnonzero(~self.measured)
        self._unmeasured_taken = self.taken[:, self.unmeasured]
        self._having = self._values()
        self._untried: dict[str, tuple[tuple[str, str], ...]] = {}
        self._best: KeptAnswers[Best] = KeptAnswers()
        self._stated: KeptAnswers[int] = KeptAnswers()
        self.design_bits = max(1, len(self.designs).bit_length())
        self.support_bits = max(1, (studies**3).bit_length())
        place_bits = max(1, len(places).bit_length())
        if 2 + place_bits + 2 * self.design_bits + self.support_bits > _LARGEST_KEY:
            raise ValueError(
                f"{len(self.designs)} designs of {studies} studies are too many to be ranked"
            )

    def _values(self) -> dict[tuple[str, str], int]:
        found: dict[tuple[str, str], int] = {}
        for at, design in enumerate(self.designs):
            detector, mask = design.architecture
            for key in (
                *(("detector", detector), ("mask", mask), ("extractor", design.extractor)),
                *(("model", stage) for stage in dict.fromkeys(design.stages)),
            ):
                found[key] = found.get(key, 0) | 1 << at
        return found

    def having(self, attribute: str, values: Iterable[str]) -> int:
        """Return the designs (bits) with one of some values of detector, mask, extractor, model."""
        return self._bits_of(self._having, attribute, values)

    @staticmethod
    def _bits_of(having: Mapping[tuple[str, str], int], name: str, values: Iterable[str]) -> int:
        found = 0
        for value in values:
            found |= having.get((name, value), 0)
        return found

    @cached_property
    def _advised(self) -> dict[tuple[str, str], int]:
        found: dict[tuple[str, str], int] = {}
        for place, bits in zip(self.places, self.of_place, strict=True):
            for key in {(advice.requirement, advice.value) for advice in place.advice}:
                found[key] = found.get(key, 0) | bits
        return found

    @cached_property
    def without_studies(self) -> int:
        """The designs (bits) of places that no study has."""
        bare = (bits for p, bits in zip(self.places, self.of_place, strict=True) if not p.studies)
        return sum(bare)

    def advised_for(self, requirement: str, values: Iterable[str]) -> int:
        """Return the designs (bits) of places that the survey advises for one of some values."""
        return self._bits_of(self._advised, requirement, values)

    def words_of(self, sets: Iterable[int]) -> Words:
        """Return sets of studies as words, shape (words, sets)."""
        size = 8 * self.words
        data = b"".join(bits.to_bytes(size, "little") for bits in sets)
        return np.ascontiguousarray(np.frombuffer(data, "<u8").reshape(-1, self.words).T)

    def flags(self, bits: int) -> Flags:
        """Return a set of designs as one flag a design."""
        size = len(self.designs) // 8 + 1
        data = np.frombuffer(bits.to_bytes(size, "little"), np.uint8)
        return np.unpackbits(data, count=len(self.designs), bitorder="little").view(bool)

    @staticmethod
    def bits(flags: Flags) -> int:
        """Return one flag a design as a set of designs."""
        return int.from_bytes(np.packbits(flags, bitorder="little").tobytes(), "little")

    def stated(self, studies: int) -> int:
        """Return the designs (bits) that nothing measures and one of some studies stands for."""
        return self._stated.get(studies, lambda: self._standing_for(studies))

    def _standing_for(self, studies: int) -> int:
        words = self.words_of([studies])
        found = np.zeros(len(self.designs), bool)
        found[self.unmeasured] = (self._unmeasured_taken & words).any(axis=0)
        return self.bits(found)

    @cached_property
    def not_measured(self) -> int:
        """The designs (bits) that nothing measures."""
        return self.bits(~self.measured)

    def rows_of(self, designs: int) -> Flags:
        """Say of each pipeline whether it is of some designs (bits)."""
        return self.flags(designs)[self.design_of]

    def broken(self, having: Mapping[int, int]) -> Positions:
        """Return, of each design, the requirements (bits) that it breaks.

        `having` maps a requirement's bit to the designs (bits) that meet it.
        """
        found = np.zeros(len(self.designs), np.int64)
        for bit, designs in having.items():
            found[~self.flags(designs)] |= bit
        return found

    def broken_by_place(
        self, by_design: Positions, by_row: Iterable[tuple[int, Flags]]
    ) -> list[set[int]]:
        """Return, of each place, the sets of requirements (bits) that its pipelines break.

        Each breaks those of its design, beside one of the sets that it is among the flags of.
        """
        found: list[set[int]] = [set() for _ in self.places]
        for bits, rows in by_row:
            designs = np.unique(self.design_of[rows])
            for place, of_design in zip(
                self.place_of[designs].tolist(), by_design[designs].tolist(), strict=True
            ):
                found[place].add(of_design | bits)
        return found

    def best(self, limits: Limits) -> Best:
        """Return the best pipeline of each design that keeps limits; kept for the next question."""
        half = self.half_field(limits.half_field_deg)
        key = (
            *(limits.hazards, half, limits.min_availability, limits.max_latency_us),
            *(limits.draws, limits.exclude_needs),
        )
        return self._best.get(key, lambda: self._least(limits))

    def _least(self, limits: Limits) -> Best:
        judged = self.judgements(limits.hazards, limits.half_field_deg, limits.draws)
        by_error = judged.by_error[judged.keeping(limits)[judged.by_error]]
        designs = self.design_of[by_error]
        first = by_error[begins(designs)]
        row = np.full(len(self.designs), -1)
        row[self.design_of[first]] = first
        error = np.full(len(self.designs), np.inf)
        error[self.design_of[first]] = judged.error_deg[first]
        at_order = np.lexsort((~self.measured, error))
        order = np.empty_like(at_order)
        order[at_order] = np.arange(len(at_order))
        _, rank = np.unique(error, return_inverse=True)
        return Best(self, judged, limits, row, error, order, rank, at_order, self.bits(row >= 0))

    def untried(self, hazard: str) -> tuple[tuple[str, str], ...]:
        """Return the architectures that no data set tries a hazard on."""
        found = self._untried.get(hazard)
        if found is None:
            tried = set(self.row_place[self.tried(hazard)].tolist())
            found = self._untried[hazard] = tuple(
                place.architecture for at, place in enumerate(self.places) if at not in tried
            )
        return found


def _repeated(lengths: Sequence[int]) -> Positions:
    return np.repeat(np.arange(len(lengths)), np.array(lengths, int))


_COLUMNS: weakref.WeakKeyDictionary[DesignTable, DesignColumns] = weakref.WeakKeyDictionary()


def design_columns(table: DesignTable) -> DesignColumns:
    """Return the designs of a table as columns, laid out at the first call."""
    found = _COLUMNS.get(table)
    if found is None:
        found = _COLUMNS[table] = DesignColumns(table.places, len(table.facts.keys))
    return found
