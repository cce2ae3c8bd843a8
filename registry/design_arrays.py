"""The one table that requirements are put to: designs and their measured pipelines as arrays.

Made once of the designs (`registry.designs`), whose order it keeps. A requirement becomes a mask
over designs. Needs NumPy, so that only modules that answer questions import it.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property, lru_cache, reduce
from operator import or_
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from registry.designs import NOTHING, Candidate, Design, DesignTable, Limits, Place
from registry.measured_pipelines import MeasuredPipeline
from registry.pipelines import PipelineErrors, PipelineTable, begins
from registry.ranking import Sort

Flags = NDArray[np.bool_]
Numbers = NDArray[np.float64]
Positions = NDArray[np.int64]
Words = NDArray[np.uint64]

WORD_BITS = 64
_LARGEST_KEY = 63
_REQUIREMENT_BITS = 32  # more than there are requirements
#: Questions whose best pipelines are kept, some 60 kB each, and sets of studies that are counted.
MOST_BEST, MOST_COUNTED = 128, 256
#: Orders of designs that are kept, some 30 kB each.
MOST_RANKED = 512


class UsedDesigns(NamedTuple):
    """Designs that some studies use.

    Attributes
    ----------
    designs : their positions
    with_model : how many of the studies use the compensations and model of each
    taken : how many of these use its extractor, too
    """

    designs: Positions
    with_model: Positions
    taken: Positions


class BestPipelines:
    """The best pipeline of each design among those that keep limits.

    Attributes
    ----------
    row : position of the pipeline, shape (designs,); -1 where none keeps the limits
    error : its error; infinite where there is none
    rank : of the error among those of all designs; equal errors share a rank
    order : place of each design by error, measured ones first among equals, shape (designs,)
    at_order : the design at each place of that order
    """

    def __init__(self, arrays: DesignArrays, limits: Limits) -> None:
        self.arrays = arrays
        self.limits = limits
        self.errors = arrays.errors(limits.hazards, limits.half_field_deg, limits.draws)
        by_error = self.errors.by_error
        by_error = by_error[self.errors.within_limits(limits)[by_error]]
        designs = arrays.design_of[by_error]
        first = by_error[begins(designs)]
        has = arrays.design_of[first]
        self.row = np.full(len(arrays.designs), -1)
        self.row[has] = first
        self.error = np.full(len(arrays.designs), np.inf)
        self.error[has] = self.errors.error_deg[first]
        self._unbacked = lru_cache(None)(self._unbacked_keys)
        self.rank = np.unique(self.error, return_inverse=True)[1]
        key = ((self.rank << 1 | ~arrays.is_measured) << arrays.design_bits) | arrays.numbers
        key.sort()
        self.at_order = key & ((1 << arrays.design_bits) - 1)
        self.order = np.empty_like(self.at_order)
        self.order[self.at_order] = arrays.numbers

    def rank_designs(self, studies: int, stated: int, sort: Sort) -> tuple[Positions, Positions]:
        """Return all designs by place and rank, and those that a study used by place and use.

        The second are measured ones, those first that most studies used; of these the one with the
        smallest error, then the first.

        What designs are ranked by goes into one number each, the most important part in its
        highest bits: sorting those is many times quicker than sorting by one part after another.
        The cube root of the support, which rises with it, can be left out.

        Parameters
        ----------
        studies, stated : that count (bits) for designs that are measured, and for others
        sort : what comes first
        """
        arrays = self.arrays
        of_place, used, _ = arrays.count_studies(studies)
        others = arrays.count_studies(stated)[2]
        unbacked, shift, place_in = self._unbacked(sort)
        key = unbacked.copy()
        for of in (used, others):
            backing = of_place[arrays.place_of[of.designs]] * of.with_model * of.taken
            key[place_in[of.designs]] -= backing << shift
        key_of_used = key[place_in[used.designs]]
        key.sort(kind="stable")  # most are in order already
        every = self.at_order[key & ((1 << arrays.design_bits) - 1)]
        place_of_used, rank = arrays.place_of[used.designs], self.rank[used.designs]
        by_use = np.lexsort((key_of_used, rank, -used.taken, place_of_used))
        return every, used.designs[by_use]

    def _unbacked_keys(self, sort: Sort) -> tuple[Positions, int, Positions]:
        """Return keys of designs that no study backs, ascending, and the place of each in them.

        A design's support is to be subtracted from its key, shifted by the second of the three.
        """
        arrays = self.arrays
        backed = ((1 << arrays.support_bits) - 1, arrays.support_bits)
        error, advised = (self.rank, arrays.rank_bits), (arrays.not_advised, 1)
        by_error, order = (error, advised), (self.order, arrays.design_bits)
        before, after = {
            "measured": (by_error, (order,)),
            "support": (((arrays.not_specified, 1),), (*by_error, order)),
            "advice": (by_error, (order,)),
        }[sort]
        key = arrays.place_of.astype(np.int64)
        for values, bits in (*before, backed, *after):
            key = (key << bits) | values
        designs = key.argsort()
        place_in = np.empty_like(designs)
        place_in[designs] = arrays.numbers
        return key[designs], sum(bits for _, bits in after), place_in

    @cached_property
    def repeatability_deg(self) -> Numbers:
        """Spread of the answers to one pose, of each design; infinite where it is not judged.

        An answer in steps repeats exactly, which says nothing: the pipelines have none then.
        """
        return self._of_designs(self.arrays.repeatability_deg)

    @cached_property
    def negated_half_field_deg(self) -> Numbers:
        """Half field of each design, negated; infinite where it is not judged."""
        return self._of_designs(-self.arrays.half_fov_deg)

    def _of_designs(self, of_rows: Numbers) -> Numbers:
        known = (self.row >= 0) & np.isfinite(self.error)
        found = np.full(len(self.row), np.inf)
        found[known] = of_rows[self.row[known]]
        found[np.isnan(found)] = np.inf
        return found

    def pipeline(self, design: int) -> MeasuredPipeline | None:
        """Return the best pipeline of a design, given by position; None for none."""
        row = int(self.row[design])
        return None if row < 0 else self.arrays.rows[row]

    def candidate(self, design: int) -> Candidate:
        """Return a design, given by position, with its best pipeline."""
        return self.arrays.candidate(design, int(self.row[design]), self.errors)


class DesignArrays(PipelineTable):
    """Designs and their pipelines as arrays.

    Parameters
    ----------
    places : architectures of the table
    studies : how many studies there are
    """

    def __init__(self, places: Sequence[Place], studies: int) -> None:
        self.places = places
        self.designs: tuple[Design, ...] = tuple(d for place in places for d in place.designs)
        self.numbers = np.arange(len(self.designs))
        self.place_of = _repeat_positions([len(place.designs) for place in places])
        design_of = _repeat_positions([len(design.rows) for design in self.designs])
        rows = tuple(row for design in self.designs for row in design.rows)
        super().__init__(rows, self.place_of[design_of], design_of)
        self.first_row = [0, *itertools.accumulate(len(design.rows) for design in self.designs)]
        self.words = studies // WORD_BITS + 1
        self.users = self.words_of(design.users for design in self.designs)
        self.is_measured = np.array([bool(design.rows) for design in self.designs], bool)
        self.not_advised = np.array([not design.is_advised for design in self.designs], np.int64)
        self.not_specified = np.array(
            [not design.is_specified for design in self.designs], np.int64
        )
        self.is_unmeasured = ~self.is_measured
        self.unmeasured_designs = np.flatnonzero(self.is_unmeasured)
        unmeasured = (self.designs[at] for at in self.unmeasured_designs.tolist())
        self.studies_of_unmeasured = reduce(or_, (d.users | d.with_model for d in unmeasured), 0)
        self.place_studies = self.words_of(place.studies for place in places)
        with_model = self.words_of(design.with_model for design in self.designs)
        sets = np.concatenate((self.place_studies, with_model, self.users), axis=1)
        self._with_studies = np.flatnonzero(sets.any(axis=0))
        self._study_sets = sets[:, self._with_studies]
        self._set_count = sets.shape[1]
        self._unmeasured_users = self.users[:, self.unmeasured_designs]
        self.without_studies = np.array([not place.studies for place in places], bool)
        self.best_pipelines = lru_cache(MOST_BEST)(self._best_pipelines)
        self.rank_designs = lru_cache(MOST_RANKED)(BestPipelines.rank_designs)
        self.count_studies = lru_cache(MOST_COUNTED)(self._count_studies)
        self.unmeasured_designs_of = lru_cache(MOST_COUNTED)(self._unmeasured_designs_of)
        self.untested_architectures = lru_cache(None)(self._untested_architectures)
        self.design_bits = max(1, len(self.designs).bit_length())
        self.rank_bits = len(self.designs).bit_length()
        self.support_bits = max(1, (studies**3).bit_length())
        bits = self.support_bits + self.rank_bits + self.design_bits
        if 2 + len(places).bit_length() + bits > _LARGEST_KEY:
            raise ValueError(
                f"{len(self.designs)} designs of {studies} studies are too many to be ranked"
            )

    @cached_property
    def _designs_with(self) -> Mapping[tuple[str, str], Flags]:
        """Designs with each value of detector, mask, extractor and model."""
        found: dict[tuple[str, str], Flags] = {}
        for at, design in enumerate(self.designs):
            detector, mask = design.architecture
            for key in (
                *(("detector", detector), ("mask", mask), ("extractor", design.extractor)),
                *(("model", stage) for stage in design.stages),
            ):
                found.setdefault(key, np.zeros(len(self.designs), bool))[at] = True
        return _read_only(found)

    @cached_property
    def _advised_places(self) -> Mapping[tuple[str, str], Flags]:
        """Architectures that the survey advises for each value of what is asked of studies."""
        found: dict[tuple[str, str], Flags] = {}
        for at, place in enumerate(self.places):
            for advice in place.advice:
                key = (advice.requirement, advice.value)
                found.setdefault(key, np.zeros(len(self.places), bool))[at] = True
        return _read_only(found)

    def designs_with(self, attribute: str, values: Iterable[str]) -> Flags:
        """Return the designs with one of some values of detector, mask, extractor, model."""
        return _one_of(self._designs_with, attribute, values, len(self.designs))

    def advised_for(self, requirement: str, values: Iterable[str]) -> Flags:
        """Return the architectures that the survey advises for one of some values."""
        return _one_of(self._advised_places, requirement, values, len(self.places))

    def with_one_of(self, studies: int) -> Flags:
        """Return the architectures that one of some studies (bits) has."""
        words = self.place_studies & self.words_of([studies])
        found: Flags = np.bitwise_or.reduce(words, axis=0) != 0
        return found

    def count_places(self, designs: Flags) -> int:
        """Return how many architectures have one of some designs."""
        return int(np.count_nonzero(begins(self.place_of[designs])))

    def words_of(self, sets: Iterable[int]) -> Words:
        """Return sets of studies as words, shape (words, sets)."""
        size = 8 * self.words
        data = b"".join(bits.to_bytes(size, "little") for bits in sets)
        return np.ascontiguousarray(np.frombuffer(data, "<u8").reshape(-1, self.words).T)

    def _count_studies(self, studies: int) -> tuple[Positions, UsedDesigns, UsedDesigns]:
        """Return how many of some studies (bits) have each architecture, and use each design.

        Measured designs come before others; those that none of the studies uses are left out.
        """
        found = np.bitwise_count(self._study_sets & self.words_of([studies]))
        counts = np.zeros(self._set_count, np.int64)
        counts[self._with_studies] = found.sum(axis=0)
        first, second = len(self.places), len(self.places) + len(self.designs)
        with_model, taken = counts[first:second], counts[second:]
        used = taken > 0
        measured, others = (
            UsedDesigns(at, with_model[at], taken[at])
            for at in (
                np.flatnonzero(used & flags) for flags in (self.is_measured, self.is_unmeasured)
            )
        )
        return counts[:first], measured, others

    def _unmeasured_designs_of(self, studies: int) -> Flags:
        """Return the designs that nothing measures and one of some studies (bits) used."""
        found = np.zeros(len(self.designs), bool)
        taken = self._unmeasured_users & self.words_of([studies])
        found[self.unmeasured_designs] = taken.any(axis=0)
        return found

    def candidate(self, design: int, row: int, errors: PipelineErrors) -> Candidate:
        """Return a design with one of its pipelines; both by position, -1 for no pipeline."""
        if row < 0:
            return Candidate(self.designs[design], None, NOTHING)
        return Candidate(self.designs[design], self.rows[row], errors.judgement(row))

    def broken_requirements(self, designs_with: Mapping[int, Flags]) -> Positions:
        """Return for each design the bit set of the requirements that it does not meet.

        `designs_with` maps the bit of a requirement to the mask of the designs that meet it.
        """
        found = np.zeros(len(self.designs), np.int64)
        for bit, designs in designs_with.items():
            found[~designs] |= bit
        return found

    def broken_by_place(
        self, by_design: Positions, by_row: Iterable[tuple[int, Flags]]
    ) -> list[set[int]]:
        """Return for each architecture the bit sets of requirements that its pipelines do not meet.

        Each is the bit set of the design joined with one of its pipeline (`by_row`: pairs of a bit
        set and the mask of the pipelines with it).
        """
        found: list[set[int]] = [set() for _ in self.places]
        for bits, rows in by_row:
            has = np.zeros(len(self.designs), bool)
            has[self.design_of[rows]] = True
            pairs = self.place_of[has] << _REQUIREMENT_BITS | by_design[has] | bits
            for pair in np.unique(pairs).tolist():
                found[pair >> _REQUIREMENT_BITS].add(pair & (1 << _REQUIREMENT_BITS) - 1)
        return found

    def _best_pipelines(self, limits: Limits) -> BestPipelines:
        return BestPipelines(self, limits)

    def _untested_architectures(self, hazard: str) -> tuple[tuple[str, str], ...]:
        """Return the architectures that no data set tries a hazard on."""
        tried = set(self.row_place[self.covers(hazard)].tolist())
        return tuple(p.architecture for at, p in enumerate(self.places) if at not in tried)


def _read_only(masks: dict[tuple[str, str], Flags]) -> dict[tuple[str, str], Flags]:
    """Return masks that answers share, so that none can change what the next one reads."""
    for flags in masks.values():
        flags.setflags(write=False)
    return masks


def _one_of(
    designs_with: Mapping[tuple[str, str], Flags], name: str, values: Iterable[str], size: int
) -> Flags:
    known = [designs_with[name, value] for value in values if (name, value) in designs_with]
    if len(known) == 1:
        return known[0]
    found = np.zeros(size, bool)
    for flags in known:
        found |= flags
    return found


def _repeat_positions(lengths: Sequence[int]) -> Positions:
    return np.repeat(np.arange(len(lengths)), np.array(lengths, int))


def design_arrays(table: DesignTable) -> DesignArrays:
    """Return the designs of a table as arrays, made at the first call."""
    return table.made(_arrays)


def _arrays(table: DesignTable) -> DesignArrays:
    return DesignArrays(table.places, len(table.facts.keys))
