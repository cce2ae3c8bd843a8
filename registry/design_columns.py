"""Designs and their measured pipelines as columns: what makes many of them one step each.

Built once of a table of designs (`registry.designs`), whose order they keep. Sets of designs are
integers, one bit a design, as sets of studies are; numbers are arrays over designs or pipelines.
Only who answers imports this module: it needs NumPy.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from registry.designs import Design, Limits, Place
from registry.kept_answers import KeptAnswers
from registry.measured import Judged, Measured, Score

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
    row : position of the pipeline, shape (designs,); -1 where none keeps them
    error : the error it is judged by; infinite where there is none
    order : of the designs, the least error first, measured ones first of the same, shape (designs,)
    rank : of the error, equal errors alike
    at_order : the design at each place of that order
    kept : designs (bits) of which one keeps them
    """

    row: Positions
    error: Numbers
    order: Positions
    rank: Positions
    at_order: Positions
    kept: int


class DesignColumns:
    """Columns of the designs of a table.

    Parameters
    ----------
    places : of the table
    studies : how many there are
    """

    def __init__(self, places: Sequence[Place], studies: int) -> None:
        self.places = places
        self.designs: tuple[Design, ...] = tuple(d for place in places for d in place.designs)
        self.rows: tuple[Measured, ...] = tuple(row for d in self.designs for row in d.rows)
        self.words = studies // WORD_BITS + 1
        self.everyone = (1 << studies) - 1
        self.every = (1 << len(self.designs)) - 1
        self.place_of = _repeated([len(place.designs) for place in places])
        self.design_of = _repeated([len(design.rows) for design in self.designs])
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
        self._of_hazards: dict[str, _Scores] = {}
        self._overs: dict[tuple[str, float | None], Numbers] = {}
        self._judgements: KeptAnswers[Judgements] = KeptAnswers()
        self._best: KeptAnswers[Best] = KeptAnswers()
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
        found = 0
        for value in values:
            found |= self._having.get((attribute, value), 0)
        return found

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

    def half_field(self, half_field_deg: float | None) -> float | None:
        """Return the least half field that tells apart the same pipelines as one asked for does.

        A field is only ever held against the edges of cones and data sets: between two of them
        all questions are the same question.
        """
        if half_field_deg is None:
            return None
        at = int(np.searchsorted(self._edges, half_field_deg))
        return float(self._edges[at]) if at < len(self._edges) else math.inf

    @cached_property
    def _edges(self) -> Numbers:
        halves = {half for row in self.rows for s in _scores(row) for half, _ in s.cones}
        halves |= {row.half_fov_deg for row in self.rows if row.half_fov_deg is not None}
        return np.array(sorted(halves), float)

    @cached_property
    def half_fov_deg(self) -> Numbers:
        """Half field of view of the data set of each pipeline; NaN where it has none."""
        return _numbers(row.half_fov_deg for row in self.rows)

    @cached_property
    def latency_us(self) -> Numbers:
        """Latency of each pipeline; infinite where it was not timed."""
        found = _numbers(row.latency_us for row in self.rows)
        return np.where(np.isnan(found), np.inf, found)

    @cached_property
    def repeatability_deg(self) -> Numbers:
        """Spread of the answers of each pipeline to one pose; NaN where there is none."""
        return _numbers(row.nominal.repeatability_deg or None for row in self.rows)

    @cached_property
    def cone_edges(self) -> tuple[tuple[float, Flags], ...]:
        """Half fields over which a pipeline has a nominal error, widest first, and which do."""
        having: dict[float, list[int]] = {}
        for at, row in enumerate(self.rows):
            halves = {half for half, error in row.nominal.cones if error is not None}
            if row.half_fov_deg is not None:
                halves.add(row.half_fov_deg)
            for half in halves:
                having.setdefault(half, []).append(at)
        found = []
        for half in sorted(having, reverse=True):
            flags = np.zeros(len(self.rows), bool)
            flags[having[half]] = True
            found.append((half, flags))
        return tuple(found)

    def judgements(self, hazards: tuple[str, ...], half_field_deg: float | None) -> Judgements:
        """Return what pipelines are judged by; kept for the next question."""
        half = self.half_field(half_field_deg)
        return self._judgements.get((hazards, half), lambda: Judgements(self, hazards, half))

    def best(self, limits: Limits) -> Best:
        """Return the best pipeline of each design that keeps limits; kept for the next question."""
        half = self.half_field(limits.half_field_deg)
        key = (limits.hazards, half, limits.min_availability, limits.max_latency_us)
        return self._best.get(key, lambda: self._least(limits))

    def _least(self, limits: Limits) -> Best:
        judged = self.judgements(limits.hazards, limits.half_field_deg)
        by_error = judged.by_error[judged.keeping(limits)[judged.by_error]]
        designs = self.design_of[by_error]
        first = by_error[np.diff(designs, prepend=-1) != 0]
        row = np.full(len(self.designs), -1)
        row[self.design_of[first]] = first
        error = np.full(len(self.designs), np.inf)
        error[self.design_of[first]] = judged.error_deg[first]
        at_order = np.lexsort((~self.measured, error))
        order = np.empty_like(at_order)
        order[at_order] = np.arange(len(at_order))
        _, rank = np.unique(error, return_inverse=True)
        return Best(row, error, order, rank, at_order, self.bits(row >= 0))

    def over(self, hazard: str, half: float | None) -> Numbers:
        """Return the error of every score under a hazard ("" for nominal), by `Measured.over`."""
        found = self._overs.get((hazard, half))
        if found is None:
            found = self._overs[hazard, half] = self.scores(hazard).over(half)
        return found

    def scores(self, hazard: str) -> _Scores:
        """Return the scores of all pipelines under a hazard; "" for the nominal ones."""
        found = self._of_hazards.get(hazard)
        if found is None:
            pairs = [
                (at, score)
                for at, row in enumerate(self.rows)
                for score in (row.hazards.get(hazard, ()) if hazard else (row.nominal,))
            ]
            found = self._of_hazards[hazard] = _Scores(pairs, self.half_fov_deg)
        return found

    def untried(self, hazard: str) -> tuple[tuple[str, str], ...]:
        """Return the architectures that no data set tries a hazard on."""
        found = self._untried.get(hazard)
        if found is None:
            tried = set(self.place_of[self.design_of[self.tried(hazard)]].tolist())
            found = self._untried[hazard] = tuple(
                place.architecture for at, place in enumerate(self.places) if at not in tried
            )
        return found

    def tried(self, hazard: str) -> Flags:
        """Say of each pipeline whether a condition of its data set tries a hazard."""
        return self.scores(hazard).tried


class Judgements:
    """What every pipeline is judged by under some hazards over a field.

    Attributes
    ----------
    error_deg : as `Measured.judged` has it, shape (pipelines,)
    nominal_deg : the nominal error over that field
    by_error : positions of pipelines by design, of each the least error first
    """

    def __init__(
        self, columns: DesignColumns, hazards: tuple[str, ...], half: float | None
    ) -> None:
        self.columns = columns
        self.hazards = hazards
        self.half = half
        self.nominal_deg = columns.over("", half)
        self.error_deg = self.nominal_deg.copy()
        for hazard in hazards:
            scores = columns.scores(hazard)
            np.maximum.at(self.error_deg, scores.rows, columns.over(hazard, half))
        self.by_error = np.lexsort((self.error_deg, columns.design_of))
        self._kept: dict[int, Judged] = {}

    @cached_property
    def tried(self) -> Flags:
        """Whether the data set of a pipeline tries all of the hazards."""
        found = np.ones(len(self.columns.rows), bool)
        for hazard in self.hazards:
            found &= self.columns.tried(hazard)
        return found

    @cached_property
    def availability(self) -> Numbers:
        """Least answered share, as `Measured.availability`; NaN where one is unknown."""
        found = self.columns.scores("").share.copy()
        for hazard in self.hazards:
            scores = self.columns.scores(hazard)
            with np.errstate(invalid="ignore"):  # an unknown share makes the least unknown
                np.minimum.at(found, scores.rows, scores.share)
        return found

    def of(self, row: int) -> Judged:
        """Return what one pipeline is judged by, with condition and field."""
        found = self._kept.get(row)
        if found is None:
            half = self.half
            found = self._kept[row] = self.columns.rows[row].judged(self.hazards, half)
        return found

    def keeping(self, limits: Limits, max_error_deg: float | None = None) -> Flags:
        """Say of each pipeline whether it keeps limits, which are of these hazards and field."""
        found = np.ones(len(self.error_deg), bool)
        if limits.half_field_deg is not None:
            found &= ~np.isinf(self.nominal_deg)
        if self.hazards:
            found &= self.tried & ~np.isinf(self.error_deg)
        if limits.min_availability is not None:
            found &= self.availability >= limits.min_availability
        if limits.max_latency_us is not None:
            found &= self.columns.latency_us <= limits.max_latency_us
        if max_error_deg is not None:
            found &= self.error_deg <= max_error_deg
        return found


class _Scores:
    """Scores as columns; ``rows`` are the pipelines that they are of."""

    def __init__(self, pairs: Sequence[tuple[int, Score]], half_fov_deg: Numbers) -> None:
        self.rows = np.array([at for at, _ in pairs], int)
        scores = [score for _, score in pairs]
        self.tried = np.zeros(len(half_fov_deg), bool)
        self.tried[self.rows] = True
        self.whole = half_fov_deg[self.rows]
        rms = _numbers(score.rms_deg for score in scores)
        available = np.array([score.available for score in scores], bool)
        self.error = np.where(available & ~np.isnan(rms), rms, np.inf)
        self.share = np.where(np.isnan(rms), 0.0, _numbers(score.availability for score in scores))
        most = max((len(score.cones) for score in scores), default=0)
        self.cones = [
            (
                _numbers(s.cones[at][0] if at < len(s.cones) else None for s in scores),
                _numbers(s.cones[at][1] if at < len(s.cones) else None for s in scores),
            )
            for at in range(most)
        ]

    def over(self, half: float | None) -> Numbers:
        """Return the error of each over a field, as `Measured.over` finds it."""
        if half is None:
            return self.error
        found = np.where(self.whole >= half, self.error, np.inf)
        for edge, error in reversed(self.cones):
            found = np.where((edge >= half) & ~np.isnan(error), error, found)
        return found


def _scores(row: Measured) -> Iterable[Score]:
    return itertools.chain((row.nominal,), *row.hazards.values())


def _numbers(values: Iterable[float | None]) -> Numbers:
    return np.array([math.nan if value is None else value for value in values], float)


def _repeated(lengths: Sequence[int]) -> Positions:
    return np.repeat(np.arange(len(lengths)), np.array(lengths, int))
