"""Measured pipelines as arrays: the errors, shares and times that requirements limit.

`registry.measured_pipelines` judges one pipeline by the same rules. Needs NumPy, so that only
modules that answer questions import it.
"""

from __future__ import annotations

import bisect
import itertools
import math
from collections.abc import Iterable, Sequence
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from registry.designs import Limits
from registry.draws import at_confidence, unit_errors
from registry.measured_pipelines import (
    LEAST_ANSWERED,
    Draws,
    MeasuredPipeline,
    PartialAnswer,
    PipelineJudgement,
    Score,
)
from registry.requirements import UNITS
from registry.score_columns import Scores, numbers

Flags = NDArray[np.bool_]
Numbers = NDArray[np.float64]
Positions = NDArray[np.int64]


NOT_COUNTED = 255
"""Value in place of a number of units where there is no limit on the error."""

#: Fields and sets of hazards whose errors are kept, some 200 kB each.
MOST_ERRORS = 128
#: Benches and shares whose errors are drawn only where another field has others, and such fields.
MOST_DRAWS, MOST_FIELDS = 16, 16


class PipelineTable:
    """Measured pipelines as arrays.

    Parameters
    ----------
    rows : the pipelines
    places : position of the architecture of each
    design_of : position of the design of each
    """

    def __init__(
        self, rows: tuple[MeasuredPipeline, ...], places: Positions, design_of: Positions
    ) -> None:
        self.rows = rows
        self.row_place = places
        self.design_of = design_of
        self.scores = lru_cache(None)(self._scores_under)
        self.needs_input = lru_cache(None)(self._needs_input)
        self._errors = lru_cache(MOST_ERRORS)(self._errors_under)
        self._confident = lru_cache(MOST_DRAWS)(_nothing_drawn)

    def half_field(self, half_field_deg: float | None) -> float | None:
        """Round a half field up to the next edge of a cone or data set.

        All half fields between two edges select the same pipelines.
        """
        if half_field_deg is None:
            return None
        at = bisect.bisect_left(self.edges, half_field_deg)
        return self.edges[at] if at < len(self.edges) else math.inf

    @cached_property
    def edges(self) -> list[float]:
        """Half fields of cones and data sets, ascending."""
        halves = {half for row in self.rows for s in _scores(row) for half, _ in s.cones}
        halves |= {row.half_fov_deg for row in self.rows if row.half_fov_deg is not None}
        return sorted(map(float, halves))

    @cached_property
    def half_fov_deg(self) -> Numbers:
        """Half field of view of the data set of each pipeline; NaN where it has none."""
        return numbers(row.half_fov_deg for row in self.rows)

    @cached_property
    def latency_us(self) -> Numbers:
        """Latency of each pipeline; infinite where it was not timed."""
        found = numbers(row.latency_us for row in self.rows)
        return np.where(np.isnan(found), np.inf, found)

    @cached_property
    def repeatability_deg(self) -> Numbers:
        """Spread of the answers of each pipeline to one pose; NaN where there is none."""
        return numbers(row.nominal.repeatability_deg or None for row in self.rows)

    @cached_property
    def cone_edges(self) -> tuple[tuple[float, Flags], ...]:
        """Half fields over which a pipeline has a nominal error, widest first, and which do."""
        designs_with: dict[float, list[int]] = {}
        for at, row in enumerate(self.rows):
            halves = {half for half, error in row.nominal.cones if error is not None}
            if row.half_fov_deg is not None:
                halves.add(row.half_fov_deg)
            for half in halves:
                designs_with.setdefault(half, []).append(at)
        found = []
        for half in sorted(designs_with, reverse=True):
            flags = np.zeros(len(self.rows), bool)
            flags[designs_with[half]] = True
            found.append((half, flags))
        return tuple(found)

    @cached_property
    def unit_ratios(self) -> Numbers:
        """Errors of ten units over their geometric mean, shape (pipelines, 10)."""
        return np.array([row.unit_ratios for row in self.rows], float).reshape(-1, UNITS)

    @cached_property
    def bench_deg(self) -> Numbers:
        """Fixed error of the standard bench of each pipeline's data set."""
        return numbers(row.bench_deg for row in self.rows)

    def _needs_input(self, need: str) -> Flags:
        """Return the mask of the pipelines that read an input beside the sensor."""
        return np.array([need in row.needs for row in self.rows], bool)

    def errors(
        self,
        hazards: tuple[str, ...],
        half_field_deg: float | None,
        draws: Draws | None = None,
    ) -> PipelineErrors:
        """Return the errors of all pipelines under hazards, over a field, at a confidence."""
        return self._errors(hazards, self.half_field(half_field_deg), draws)

    def at_confidence(self, own_deg: Numbers, bench_deg: Numbers, draws: Draws) -> Numbers:
        """Return the errors that a share of the draws keeps within (`draws.at_confidence`).

        Another field leaves many of the own errors as they are: those are not drawn again.
        """
        known = self._confident(draws)
        found = np.full(len(own_deg), np.nan)
        for before_deg, errors_deg in known:
            same = own_deg == before_deg
            found[same] = errors_deg[same]
        left = np.isnan(found)
        of_left = own_deg[left], self.unit_ratios[left], bench_deg[left]
        found[left] = at_confidence(*of_left, draws[1])
        if len(known) < MOST_FIELDS:
            known.append((own_deg, found))
        return found

    def _errors_under(
        self, hazards: tuple[str, ...], half: float | None, draws: Draws | None
    ) -> PipelineErrors:
        return PipelineErrors(self, hazards, half, draws)

    def _scores_under(self, hazard: str) -> Scores:
        """Return the scores of all pipelines under a hazard; "" for the nominal ones."""
        pairs = [
            (at, score)
            for at, row in enumerate(self.rows)
            for score in (row.hazards.get(hazard, ()) if hazard else (row.nominal,))
        ]
        return Scores(pairs, self.half_fov_deg)

    def covers(self, hazard: str) -> Flags:
        """Return the mask of the pipelines whose data set has a condition with a hazard."""
        return self.scores(hazard).has_score


class PipelineErrors:
    """Errors of all pipelines under hazards, over a field, at a confidence.

    Attributes
    ----------
    own_deg : largest error with true directions, shape (pipelines,); infinite where a pipeline
        answers too seldom or its data set lacks the field
    error_deg : the same on calibration benches, as `MeasuredPipeline.judged` computes it
    nominal_deg : error of the first condition alone
    by_error : positions of the pipelines, by design and then by error
    """

    def __init__(
        self,
        table: PipelineTable,
        hazards: tuple[str, ...],
        half: float | None,
        draws: Draws | None,
    ) -> None:
        self.table = table
        self.hazards = hazards
        self.half = half
        self.draws = draws
        self.nominal_deg = table.scores("").over(half)
        self.own_deg = self.nominal_deg.copy()
        for hazard in hazards:
            scores = table.scores(hazard)
            np.maximum.at(self.own_deg, scores.rows, scores.over(half))
        self.error_deg = self.own_deg
        if draws is not None:
            self.error_deg = table.at_confidence(self.own_deg, self.bench_deg, draws)
        self.by_error = np.lexsort((self.error_deg, table.design_of))
        self.judgement = lru_cache(None)(self._judgement)
        self.partial_answer = lru_cache(None)(self._partial_answer)

    @property
    def bench_deg(self) -> Numbers:
        """Fixed error of the bench of each pipeline: the one asked for, or its data set's."""
        bench = None if self.draws is None else self.draws[0]
        own = self.table.bench_deg
        return own if bench is None else np.full(len(own), bench)

    def _judgement(self, row: int) -> PipelineJudgement:
        """Return the error of one pipeline, with its condition and field."""
        return self._on_benches(row, self._own_judgement(row))

    def _own_judgement(self, row: int) -> PipelineJudgement:
        """Return the error of one pipeline with true directions, with its condition and field."""
        return self.table.rows[row].judge(self.hazards, self.half)

    def _on_benches(self, row: int, own: PipelineJudgement) -> PipelineJudgement:
        """Return the error of one pipeline on calibration benches, of that with true directions."""
        if self.draws is None or math.isinf(own.error_deg):
            return own
        return PipelineJudgement(float(self.error_deg[row]), own.condition, own.field_deg)

    @cached_property
    def ranked_unit_errors(self) -> tuple[Numbers, NDArray[np.unsignedinteger[Any]]]:
        """Errors that units keep at the confidence, ascending, and how many are smaller than each.

        The second is of shape (10, pipelines), in small integers: a limit is compared with those in
        a tenth of the time.
        """
        assert self.draws is not None  # noqa: S101 - without draws no unit is counted
        ratios, share = self.table.unit_ratios, self.draws[1]
        found = unit_errors(self.own_deg, ratios, self.bench_deg, share)
        errors_deg, ranks = np.unique(found.T, return_inverse=True)
        return errors_deg, ranks.reshape(found.T.shape).astype(np.min_scalar_type(len(errors_deg)))

    def units_within(self, limit_deg: float | None) -> NDArray[np.uint8]:
        """Return how many of ten units of each pipeline keep a limit on the error.

        `NOT_COUNTED` where no limit is asked for, and where a pipeline has no error.
        """
        if limit_deg is None or self.draws is None:
            return np.full(len(self.own_deg), NOT_COUNTED, np.uint8)
        errors_deg, ranks = self.ranked_unit_errors
        smaller = ranks.dtype.type(errors_deg.searchsorted(limit_deg, side="right"))
        found: NDArray[np.uint8] = (ranks < smaller).view(np.uint8).sum(axis=0, dtype=np.uint8)
        found[self._without_error] = NOT_COUNTED
        return found

    @cached_property
    def _without_error(self) -> Positions:
        return np.flatnonzero(np.isinf(self.own_deg))

    @cached_property
    def covers_hazards(self) -> Flags:
        """Mask of the pipelines whose data set has conditions with all hazards."""
        found = np.ones(len(self.table.rows), bool)
        for hazard in self.hazards:
            found &= self.table.covers(hazard)
        return found

    @cached_property
    def availability(self) -> Numbers:
        """Least answered share, as `MeasuredPipeline.availability`; NaN where one is unknown."""
        found = self.table.scores("").share.copy()
        for hazard in self.hazards:
            scores = self.table.scores(hazard)
            with np.errstate(invalid="ignore"):  # an unknown share makes the least unknown
                np.minimum.at(found, scores.rows, scores.share)
        return found

    @cached_property
    def _seldom(self) -> tuple[Positions, Positions, Positions]:
        """Pipelines below the availability limit, by architecture and error.

        With their architectures and designs. As `MeasuredPipeline.partial_answer`, without those
        that answer less than `LEAST_ANSWERED`.
        """
        table, half = self.table, self.half
        known, judged = self.covers_hazards.copy(), np.ones(len(table.rows), bool)
        if half is not None:
            known &= table.half_fov_deg >= half
        largest = np.zeros(len(table.rows))
        for hazard in ("", *self.hazards):
            scores = table.scores(hazard)
            over = scores.over(half)
            seldom = np.isinf(over)
            error = np.where(seldom, scores.rms, over)
            known[scores.rows[np.isnan(error)]] = False
            judged[scores.rows[seldom]] = False
            with np.errstate(invalid="ignore"):  # those are left out
                np.maximum.at(largest, scores.rows, error)
        named = np.flatnonzero(known & ~judged & (self.availability >= LEAST_ANSWERED))
        places = table.row_place[named]
        order = np.lexsort((largest[named], places))
        named = named[order]
        return named, places[order], table.design_of[named]

    def finest(self, limits: Limits, designs: Sequence[Flags]) -> dict[int, int]:
        """Return the most accurate pipeline below the availability limit, by architecture.

        Both are positions.

        Parameters
        ----------
        limits : limits with the hazards and field of these errors
        designs : masks over designs; a pipeline is returned only of one that is in all of them
        """
        table, (rows, places, designs_of_rows) = self.table, self._seldom
        if not len(rows):
            return {}
        among = np.ones(len(rows), bool)
        for mask in designs:
            among &= mask.take(designs_of_rows)
        if limits.min_availability is not None:
            among &= self.availability[rows] >= limits.min_availability
        if limits.max_latency_us is not None:
            among &= table.latency_us[rows] <= limits.max_latency_us
        rows, places = rows[among], places[among]
        first = begins(places)
        return dict(zip(places[first].tolist(), rows[first].tolist(), strict=True))

    def document(self, row: int) -> dict[str, object]:
        """Return the members of a pipeline in the HTTP answer that a question decides."""
        own = self._own_judgement(row)
        return self.table.rows[row].judged(
            *(self._on_benches(row, own), own, self.hazards, self.half),
            bench_deg=None if self.draws is None else self.draws[0],
        )

    def _partial_answer(self, row: int) -> PartialAnswer[MeasuredPipeline] | None:
        """Return the error of a pipeline below the availability limit over what it answers."""
        return self.table.rows[row].partial_answer(self.hazards, self.half)

    def within_limits(self, limits: Limits, max_error_deg: float | None = None) -> Flags:
        """Return the mask of the pipelines within limits, which have these hazards and field."""
        found = np.ones(len(self.error_deg), bool)
        if limits.half_field_deg is not None:
            found &= ~np.isinf(self.nominal_deg)
        if self.hazards:
            found &= self.covers_hazards & ~np.isinf(self.error_deg)
        if limits.min_availability is not None:
            found &= self.availability >= limits.min_availability
        if limits.max_latency_us is not None:
            found &= self.table.latency_us <= limits.max_latency_us
        if limits.exclude_needs:
            for need in limits.exclude_needs:
                found &= ~self.table.needs_input(need)
        if max_error_deg is not None:
            found &= self.error_deg <= max_error_deg
        return found


def _nothing_drawn(_draws: Draws) -> list[tuple[Numbers, Numbers]]:
    """Return own errors and those at a confidence, to be filled."""
    return []


def begins(values: Positions) -> Flags:
    """Return the mask of the first of equal values, which are in ascending order."""
    found = np.empty(len(values), bool)
    found[:1] = True
    np.not_equal(values[1:], values[:-1], out=found[1:])
    return found


def _scores(row: MeasuredPipeline) -> Iterable[Score]:
    return itertools.chain((row.nominal,), *row.hazards.values())
