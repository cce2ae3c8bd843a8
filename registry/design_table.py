"""The one table that requirements are put to: designs, measured pipelines and reports as arrays.

Made once of the facts and what was measured. A requirement becomes a mask over its rows.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from registry.designs import Design, Place, gather
from registry.draws import at_confidence
from registry.measured_pipelines import MeasuredPipeline, Measurements, Score
from registry.reports import Report, reports
from registry.requirements import CLASSES_DEG, NEEDS, UNITS
from registry.studies import Facts

Flags = NDArray[np.bool_]
Numbers = NDArray[np.float64]
Positions = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class PipelineErrors:
    """Own errors of all pipelines under hazards, over a field; shapes (pipelines,).

    Attributes
    ----------
    own_error_deg : largest error; infinite where a pipeline answers too seldom or its data set
        lacks the field
    nominal_deg : error under the first condition alone
    availability : least answered share; NaN where one is unknown
    covers : whether the data set has conditions with all hazards
    """

    own_error_deg: Numbers
    nominal_deg: Numbers
    availability: Numbers
    covers: Flags


class DesignTable:
    """Designs, their measured pipelines and the reports of studies and products.

    Attributes
    ----------
    places, designs, rows, reports : architectures, and what they have, in one order each
    design_place, row_design, row_place, report_place : which each belongs to, by position
    used, with_model : designs by studies (by position in `keys`) that use them, or their stages
    report_study : position of the study that a report is of; -1 for a product
    """

    def __init__(self, facts: Facts, measurements: Measurements) -> None:
        self.facts = facts
        self.places: tuple[Place, ...] = gather(facts, measurements)
        self.designs: tuple[Design, ...] = tuple(d for place in self.places for d in place.designs)
        self.rows = tuple(row for design in self.designs for row in design.rows)
        self.reports: tuple[Report, ...] = ()
        self.design_place = _repeat([len(place.designs) for place in self.places])
        self.row_design = _repeat([len(design.rows) for design in self.designs])
        self.row_place = self.design_place[self.row_design]
        found = [list(reports(place)) for place in self.places]
        self.reports = tuple(report for of_place in found for report in of_place)
        self.report_place = _repeat([len(of_place) for of_place in found])
        self.keys = facts.keys
        self._at = {key: at for at, key in enumerate(self.keys)}
        self.used = self._sets(design.users for design in self.designs)
        self.with_model = self._sets(design.with_model for design in self.designs)
        self.place_studies = self._sets(place.studies for place in self.places)
        keys = (None if r.study is None else r.key for r in self.reports)
        self.report_study = np.array([-1 if k is None else self._at[k] for k in keys], int)
        self.is_built = np.array([place.is_built for place in self.places], bool)
        self.is_specified = np.array([d.is_specified for d in self.designs], bool)
        self.is_measured = np.array([bool(d.rows) for d in self.designs], bool)
        self.is_advised = np.array([bool(d.advice) for d in self.designs], bool)

    def _sets(self, of: Iterable[Iterable[str]]) -> Flags:
        """Return sets of study keys as flags, shape (sets, studies)."""
        rows = []
        for keys in of:
            flags = np.zeros(len(self.keys), bool)
            flags[[self._at[key] for key in keys]] = True
            rows.append(flags)
        return np.array(rows, bool).reshape(-1, len(self.keys))

    def studies_with(self, attribute: str, values: Iterable[str]) -> Flags:
        """Return the studies that have one of some values."""
        found = np.zeros(len(self.keys), bool)
        for value in values:
            found |= self._studies_with.get((attribute, value), False)
        return found

    @cached_property
    def _studies_with(self) -> Mapping[tuple[str, str], Flags]:
        found: dict[tuple[str, str], Flags] = {}
        for at, study in enumerate(self.facts.studies.values()):
            for attribute in ("task", "error", "accuracy"):
                for value in study.of(attribute):
                    none = np.zeros(len(self.keys), bool)
                    found.setdefault((attribute, value), none)[at] = True
        return found

    def designs_with(self, attribute: str, values: Iterable[str]) -> Flags:
        """Return the designs with one of some values of detector, mask, extractor, model."""
        kinds = {k for value in values for k in self.facts.taxonomy.kinds(attribute, value)}
        found = np.zeros(len(self.designs), bool)
        for kind in kinds:
            found |= self._designs_with.get((attribute, kind), False)
        return found

    @cached_property
    def _designs_with(self) -> Mapping[tuple[str, str], Flags]:
        found: dict[tuple[str, str], Flags] = {}
        for at, design in enumerate(self.designs):
            detector, mask = design.architecture
            one = (("detector", detector), ("mask", mask), ("extractor", design.extractor))
            for key in (*one, *(("model", stage) for stage in design.stages)):
                found.setdefault(key, np.zeros(len(self.designs), bool))[at] = True
        return found

    def advised_for(self, requirement: str, values: Iterable[str]) -> Flags:
        """Return the architectures that the survey advises for one of some values."""
        wanted = set(values)
        return np.array([one.is_advised_for(requirement, wanted) for one in self.places], bool)

    @cached_property
    def uses(self) -> tuple[Positions, Positions]:
        """Positions of the designs and studies of all uses."""
        design, study = np.nonzero(self.used)
        return design, study

    @cached_property
    def half_fov_deg(self) -> Numbers:
        """Half field of view of the data set of each pipeline; NaN where it has none."""
        return numbers(row.half_fov_deg for row in self.rows)

    @cached_property
    def latency_us(self) -> Numbers:
        """Time of one sample on the machine of the published times; NaN where not timed."""
        return numbers(row.latency_us for row in self.rows)

    @cached_property
    def unit_ratios(self) -> Numbers:
        """Errors of ten units over their geometric mean, ascending, shape (pipelines, 10)."""
        found = np.array([row.unit_ratios for row in self.rows], float).reshape(-1, UNITS)
        return np.sort(found, axis=1)

    @cached_property
    def log_error(self) -> Numbers:
        """Standard error of the log of each own error, the mean over the units measured."""
        measured = np.sqrt([max(len(row.unit_own_error_deg), 1) for row in self.rows])
        return np.asarray(np.log(self.unit_ratios).std(axis=1, ddof=1) / measured)

    @cached_property
    def edges(self) -> Numbers:
        """Half fields over which some pipeline has an error, ascending."""
        halves = {half for row in self.rows for half, error in row.nominal.cones if error}
        halves |= {row.half_fov_deg for row in self.rows if row.half_fov_deg is not None}
        return np.array(sorted(halves), float)

    @cached_property
    def needs_input(self) -> Mapping[str, Flags]:
        """Pipelines that read each input beside the sensor."""
        return {need: np.array([need in row.needs for row in self.rows], bool) for need in NEEDS}

    @cached_property
    def _scores(self) -> Mapping[str, _Scores]:
        """Scores by hazard; "" for the nominal ones."""
        names = {"": None} | {name: None for row in self.rows for name in row.hazards}
        return {name: _Scores(self.rows, name, self.half_fov_deg) for name in names}

    def errors(self, hazards: Sequence[str], half_field_deg: float | None) -> PipelineErrors:
        """Return own errors under hazards over a field, as `MeasuredPipeline.judge` finds them."""
        nominal = self._scores[""]
        first = nominal.over(half_field_deg)
        own, share = first.copy(), nominal.share.copy()
        covers = np.ones(len(self.rows), bool)
        for hazard in hazards:
            scores = self._scores.get(hazard)
            if scores is None:
                covers[:] = False
                continue
            covers &= scores.has_score
            np.maximum.at(own, scores.rows, scores.over(half_field_deg))
            with np.errstate(invalid="ignore"):  # an unknown share makes the least unknown
                np.minimum.at(share, scores.rows, scores.share)
        return PipelineErrors(own, first, share, covers)

    def within(
        self,
        own_error_deg: Numbers,
        among: Flags | list[int] | slice,
        bench_deg: float | None,
        share: float,
    ) -> Numbers:
        """Return the errors that a share of units (and benches) stays within, of some pipelines.

        `own_deg` is of all pipelines, `among` those that are looked at, as flags or positions; a
        bench error of None or 0 is for true directions.
        """
        if bench_deg:
            return at_confidence(own_error_deg[among], self.unit_ratios[among], bench_deg, share)
        unit = math.ceil(share * UNITS - 1e-9) - 1
        return np.asarray(own_error_deg[among] * self.unit_ratios[among, unit])

    @cached_property
    def report_numbers(self) -> Mapping[str, Numbers]:
        """Numbers of the reports by name, NaN where unknown; a self-powered sensor draws 0 mW."""
        free = {"self-powered": 0.0, "passive": 0.0}
        return {
            "rms_deg": numbers(one.rms_deg for one in self.reports),
            "fov_deg": numbers(one.fov_deg for one in self.reports),
            "mass_g": numbers(one.mass_g for one in self.reports),
            "power_mw": numbers(free.get(one.supply, one.power_mw) for one in self.reports),
            "rate_hz": numbers(one.rate_hz for one in self.reports),
        }

    @cached_property
    def report_classes(self) -> Mapping[str, Flags]:
        """Reports of each accuracy class."""
        return {
            name: np.array([name in one.classes for one in self.reports], bool)
            for name in CLASSES_DEG
        }


class _Scores:
    """Scores under a hazard as columns; ``rows`` are the pipelines that they are of."""

    def __init__(
        self, pipelines: Sequence[MeasuredPipeline], hazard: str, half_fov_deg: Numbers
    ) -> None:
        pairs: list[tuple[int, Score]] = [
            (at, score)
            for at, row in enumerate(pipelines)
            for score in (row.hazards.get(hazard, ()) if hazard else (row.nominal,))
        ]
        self.rows = np.array([at for at, _ in pairs], int)
        scores = [score for _, score in pairs]
        self.has_score = np.zeros(len(pipelines), bool)
        self.has_score[self.rows] = True
        self.half_fov_deg = half_fov_deg[self.rows]
        rms = numbers(score.rms_deg for score in scores)
        available = np.array([score.is_available for score in scores], bool)
        self.error = np.where(available & ~np.isnan(rms), rms, np.inf)
        self.share = np.where(np.isnan(rms), 0.0, numbers(score.availability for score in scores))
        most = max((len(score.cones) for score in scores), default=0)
        padded = [(*s.cones, *((None, None),) * (most - len(s.cones))) for s in scores]
        self.cones = [
            (numbers(cones[at][0] for cones in padded), numbers(cones[at][1] for cones in padded))
            for at in range(most)
        ]

    def over(self, half: float | None) -> Numbers:
        """Return the error of each over a field, as `MeasuredPipeline.over` finds it."""
        if half is None:
            return self.error
        found = np.where(self.half_fov_deg >= half, self.error, np.inf)
        for edge, error in reversed(self.cones):
            found = np.where((edge >= half) & ~np.isnan(error), error, found)
        return found


def numbers(values: Iterable[float | None]) -> Numbers:
    """Return numbers as an array, NaN for None."""
    return np.array([math.nan if value is None else value for value in values], float)


def _repeat(lengths: Sequence[int]) -> Positions:
    return np.repeat(np.arange(len(lengths)), np.array(lengths, int))


@lru_cache(maxsize=4)
def design_table(facts: Facts, measurements: Measurements) -> DesignTable:
    """Return the table of these facts and measurements, made at the first call."""
    return DesignTable(facts, measurements)
