"""Scores of measured pipelines, as the caller hands them to the registry."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType

from registry.requirements import UNITS, Level

_NUMBERS = ("rms_deg", "bound_deg", "repeatability_deg", "availability")


@dataclass(frozen=True)
class Score:
    """Score of one pipeline under one condition of a data set.

    Numbers are None where not measured; NaN and infinities become None.

    Attributes
    ----------
    availability
        Answered share of the samples whose direction is observable.
    is_available
        Whether the availability over the whole field is high enough to rank the pipeline.
    cones
        Pairs of a half angle about the boresight, in degrees and ascending, and the RMS error
        within it; the error is None where the availability in that cone is too low.
    """

    condition: str
    rms_deg: float | None
    bound_deg: float | None = None
    repeatability_deg: float | None = None
    availability: float | None = None
    is_available: bool = True
    cones: tuple[tuple[float, float | None], ...] = ()

    def __post_init__(self) -> None:
        for name in _NUMBERS:
            value: float | None = getattr(self, name)
            if value is not None and not math.isfinite(value):
                object.__setattr__(self, name, None)


@dataclass(frozen=True)
class PipelineJudgement:
    """Largest RMS error of a pipeline over the required field and conditions.

    ``error_deg`` is infinite where the availability is too low or the field too narrow;
    ``condition`` is that under which it was measured, ``field_deg`` the full field of view that it
    covers.
    """

    error_deg: float
    condition: str
    field_deg: float | None


@dataclass(frozen=True)
class MeasuredPipeline:
    """Scores of one pipeline on one data set under all of its conditions.

    Attributes
    ----------
    extractor_taxonomy, stages
        Values of the taxonomy: the extractor's; those of the compensations, if any, and of the
        model, which is last.
    half_fov_deg
        Half the field of view of the data set.
    nominal
        Score under the first condition of the data set.
    hazards
        Scores by hazard (`registry.requirements.HAZARDS`), under the conditions of this data set
        that include it. A hazard without a condition is absent.
    unit_own_error_deg
        Own errors of the units of the sensor, the standard one first, under the first condition.
    unit_ratios
        Errors of ten units over their geometric mean (`registry.draws.unit_ratios`).
    bench_deg
        Fixed error of the data set's standard calibration bench, root mean square; no limit is
        judged by it unless the reader states it.
    latency_us
        Time of one sample on the machine of the published times; None where not timed.
    needs
        Inputs beside the sensor that the calibration reads (`registry.requirements.NEEDS`).
    flight, flight_units_deg, flight_ratios
        In flight: what `nominal`, `unit_own_error_deg` and `unit_ratios` are on the ground; None
        for a pipeline that was not flown.
    height_mm
        Distance of mask or lens and detector; None for sensors without one.
    own
        Of a pipeline in flight (`flown`), the same on the ground; None on the ground.
    """

    dataset: str
    detector: str
    mask: str
    extractor: str
    extractor_taxonomy: str
    model: str
    stages: tuple[str, ...]
    nominal: Score
    hazards: Mapping[str, tuple[Score, ...]] = field(default_factory=dict, hash=False)
    half_fov_deg: float | None = None
    latency_us: float | None = None
    unit_own_error_deg: tuple[float, ...] = ()
    unit_ratios: tuple[float, ...] = (1.0,) * UNITS
    bench_deg: float = 0.0
    needs: tuple[str, ...] = ()
    flight: Score | None = None
    flight_units_deg: tuple[float, ...] = ()
    flight_ratios: tuple[float, ...] = (1.0,) * UNITS
    height_mm: float | None = None
    own: MeasuredPipeline | None = field(default=None, hash=False, repr=False)

    @property
    def flown(self) -> MeasuredPipeline | None:
        """The same in flight, ``nominal`` the score there; None where it was not flown."""
        if self.flight is None:
            return None
        return replace(
            self,
            nominal=self.flight,
            unit_own_error_deg=self.flight_units_deg,
            unit_ratios=self.flight_ratios,
            own=self,
        )

    def judge(
        self, hazards: Iterable[str] = (), half_field_deg: float | None = None
    ) -> PipelineJudgement:
        """Return the largest own error, nominal and under every hazard, over a field.

        A hazard without a condition adds no error: check `covers` first.
        """
        found = [self.over(score, half_field_deg) for score in self.scores(hazards)]
        return max(found, key=lambda one: one.error_deg)

    def scores(self, hazards: Iterable[str] = ()) -> list[Score]:
        """Return the scores under the first condition, then under every hazard."""
        return [self.nominal, *(s for name in hazards for s in self.hazards.get(name, ()))]

    def over(self, score: Score, half_field_deg: float | None = None) -> PipelineJudgement:
        """Return the error under one condition over a field; infinite where there is none.

        The error is taken from the narrowest cone that contains the required field and has an
        error. The whole field of the data set is used if no field is required, or if no such cone
        has an error and the whole field is wide enough.
        """
        if half_field_deg is not None:
            for half, error in score.cones:
                if half >= half_field_deg and error is not None:
                    return PipelineJudgement(error, score.condition, 2 * half)
        whole = self.half_fov_deg
        field_deg = None if whole is None else 2 * whole
        wide = half_field_deg is None or (whole is not None and whole >= half_field_deg)
        if not wide or not score.is_available or score.rms_deg is None:
            return PipelineJudgement(math.inf, score.condition, field_deg)
        return PipelineJudgement(score.rms_deg, score.condition, field_deg)

    def covers(self, hazard: str) -> bool:
        """Return whether the data set has a condition with a hazard."""
        return bool(self.hazards.get(hazard))

    def availability(self, hazards: Iterable[str] = ()) -> float | None:
        """Return the lowest availability, nominal and under every hazard; None if one is unknown.

        A refused run has availability 0.
        """
        scores = self.scores(hazards)
        shares = [0.0 if s.rms_deg is None else s.availability for s in scores]
        known = [share for share in shares if share is not None]
        return min(known) if len(known) == len(shares) else None


class Measurements:
    """All measured pipelines; make it once and pass it to many calls.

    Pipelines without an error under the first condition are left out. What was measured `on_ground`
    is a calibration that a study may have used, whether or not it was flown.
    """

    def __init__(
        self, rows: Iterable[MeasuredPipeline] = (), on_ground: Measurements | None = None
    ) -> None:
        self.on_ground = on_ground or self
        kept = [row for row in rows if row.nominal.rms_deg is not None]
        kept.sort(key=lambda r: (r.dataset, r.extractor, r.model))
        self.rows: tuple[MeasuredPipeline, ...] = tuple(kept)
        by: dict[tuple[str, str], list[MeasuredPipeline]] = {}
        for row in kept:
            by.setdefault((row.detector, row.mask), []).append(row)
        self.by_architecture: Mapping[tuple[str, str], tuple[MeasuredPipeline, ...]] = (
            MappingProxyType({pair: tuple(found) for pair, found in by.items()})
        )

    def at(self, level: Level) -> Measurements:
        """Return what was measured at a level; where nothing was flown, what was on the ground."""
        return self if level == "own" or not self._flown.rows else self._flown

    @cached_property
    def _flown(self) -> Measurements:
        flown = (row.flown for row in self.rows)
        return Measurements((row for row in flown if row is not None), on_ground=self)
