"""What measured pipelines are judged by under hazards and over a field, as columns.

As `registry.measured` judges each by itself. Only who answers imports this module: it needs NumPy.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from registry.designs import Limits
from registry.draws import at_confidence
from registry.kept_answers import KeptAnswers
from registry.measured import LEAST_ANSWERED, Draws, Judged, Measured, Partly, Score
from registry.requirements import UNITS

Flags = NDArray[np.bool_]
Numbers = NDArray[np.float64]
Positions = NDArray[np.int64]


class PipelineColumns:
    """Columns of measured pipelines.

    Parameters
    ----------
    rows : the pipelines
    places : the architecture that each is on, by position
    design_of : the design that each belongs to, by position
    """

    def __init__(self, rows: tuple[Measured, ...], places: Positions, design_of: Positions) -> None:
        self.rows = rows
        self.row_place = places
        self.design_of = design_of
        self._of_hazards: dict[str, Scores] = {}
        self._overs: dict[tuple[str, float | None], Numbers] = {}
        self._judgements: KeptAnswers[Judgements] = KeptAnswers()

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

    @cached_property
    def unit_ratios(self) -> Numbers:
        """Errors of ten units over their geometric mean, shape (pipelines, 10)."""
        return np.array([row.unit_ratios for row in self.rows], float).reshape(-1, UNITS)

    @cached_property
    def bench_deg(self) -> Numbers:
        """Fixed error of the standard bench of each pipeline's data set."""
        return numbers(row.bench_deg for row in self.rows)

    @cached_property
    def needs(self) -> tuple[frozenset[str], ...]:
        """What each pipeline reads beside the sensor."""
        return tuple(frozenset(row.needs) for row in self.rows)

    def judgements(
        self,
        hazards: tuple[str, ...],
        half_field_deg: float | None,
        draws: Draws | None = None,
    ) -> Judgements:
        """Return what pipelines are judged by; kept for the next question."""
        half = self.half_field(half_field_deg)
        key = (hazards, half, draws)
        return self._judgements.get(key, lambda: Judgements(self, hazards, half, draws))

    def over(self, hazard: str, half: float | None) -> Numbers:
        """Return the error of every score under a hazard ("" for nominal), by `Measured.over`."""
        found = self._overs.get((hazard, half))
        if found is None:
            found = self._overs[hazard, half] = self.scores(hazard).over(half)
        return found

    def scores(self, hazard: str) -> Scores:
        """Return the scores of all pipelines under a hazard; "" for the nominal ones."""
        found = self._of_hazards.get(hazard)
        if found is None:
            pairs = [
                (at, score)
                for at, row in enumerate(self.rows)
                for score in (row.hazards.get(hazard, ()) if hazard else (row.nominal,))
            ]
            found = self._of_hazards[hazard] = Scores(pairs, self.half_fov_deg)
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
        self,
        columns: PipelineColumns,
        hazards: tuple[str, ...],
        half: float | None,
        draws: Draws | None,
    ) -> None:
        self.columns = columns
        self.hazards = hazards
        self.half = half
        self.draws = draws
        self.nominal_deg = columns.over("", half)
        self.error_deg = self.nominal_deg.copy()
        for hazard in hazards:
            scores = columns.scores(hazard)
            np.maximum.at(self.error_deg, scores.rows, columns.over(hazard, half))
        self.own_deg = self.error_deg
        if draws is not None:
            bench, share = draws
            benches = columns.bench_deg
            benches = benches if bench is None else np.full(len(benches), bench)
            self.error_deg = at_confidence(self.own_deg, columns.unit_ratios, benches, share)
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
            of_row = self.columns.rows[row]
            found = self._kept[row] = of_row.judged(self.hazards, half, self.draws)
        return found

    @cached_property
    def _seldom(self) -> tuple[Positions, Positions]:
        """Pipelines that answer too seldom to be judged, by place and error, and their places.

        As `Measured.partly` finds them, of those that answer often enough to be named.
        """
        columns, half = self.columns, self.half
        known, judged = self.tried.copy(), np.ones(len(columns.rows), bool)
        if half is not None:
            known &= columns.half_fov_deg >= half
        largest = np.zeros(len(columns.rows))
        for hazard in ("", *self.hazards):
            scores, over = columns.scores(hazard), columns.over(hazard, half)
            seldom = np.isinf(over)
            error = np.where(seldom, scores.rms, over)
            known[scores.rows[np.isnan(error)]] = False
            judged[scores.rows[seldom]] = False
            with np.errstate(invalid="ignore"):  # those are left out
                np.maximum.at(largest, scores.rows, error)
        named = np.flatnonzero(known & ~judged & (self.availability >= LEAST_ANSWERED))
        places = columns.row_place[named]
        order = np.lexsort((largest[named], places))
        return named[order], places[order]

    def finest(self, limits: Limits, designs: Flags) -> dict[int, int]:
        """Return what errs least of what answers too seldom, by place; both by position.

        Parameters
        ----------
        limits : of these hazards and this field; those on answers and time are kept
        designs : those whose pipelines may be named
        """
        columns, (rows, places) = self.columns, self._seldom
        if not len(rows):
            return {}
        among = designs[columns.design_of[rows]]
        if limits.min_availability is not None:
            among &= self.availability[rows] >= limits.min_availability
        if limits.max_latency_us is not None:
            among &= columns.latency_us[rows] <= limits.max_latency_us
        rows, places = rows[among], places[among]
        first = begins(places)
        return dict(zip(places[first].tolist(), rows[first].tolist(), strict=True))

    def partly_of(self, row: int) -> Partly[Measured] | None:
        """Return how one pipeline does that answers too seldom."""
        return self.columns.rows[row].partly(self.hazards, self.half)

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
        if limits.exclude_needs:
            avoided = frozenset(limits.exclude_needs)
            found &= np.array([not (needs & avoided) for needs in self.columns.needs], bool)
        if max_error_deg is not None:
            found &= self.error_deg <= max_error_deg
        return found


class Scores:
    """Scores as columns; ``rows`` are the pipelines that they are of."""

    def __init__(self, pairs: Sequence[tuple[int, Score]], half_fov_deg: Numbers) -> None:
        self.rows = np.array([at for at, _ in pairs], int)
        scores = [score for _, score in pairs]
        self.tried = np.zeros(len(half_fov_deg), bool)
        self.tried[self.rows] = True
        self.whole = half_fov_deg[self.rows]
        rms = numbers(score.rms_deg for score in scores)
        available = np.array([score.available for score in scores], bool)
        self.rms = rms
        self.error = np.where(available & ~np.isnan(rms), rms, np.inf)
        self.share = np.where(np.isnan(rms), 0.0, numbers(score.availability for score in scores))
        most = max((len(score.cones) for score in scores), default=0)
        self.cones = [
            (
                numbers(s.cones[at][0] if at < len(s.cones) else None for s in scores),
                numbers(s.cones[at][1] if at < len(s.cones) else None for s in scores),
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


def begins(values: Positions) -> Flags:
    """Say of ascending values which are the first of equal ones."""
    found = np.ones(len(values), bool)
    np.not_equal(values[1:], values[:-1], out=found[1:])
    return found


def numbers(values: Iterable[float | None]) -> Numbers:
    """Return numbers as an array, NaN for None."""
    return np.array([math.nan if value is None else value for value in values], float)


def _scores(row: Measured) -> Iterable[Score]:
    return itertools.chain((row.nominal,), *row.hazards.values())
