"""Scores of measured pipelines, as the caller hands them to the registry."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Generic, TypeVar

from registry.requirements import UNITS

Draws = tuple[float | None, float]
"""Fixed error of the calibration bench in degrees (None: that of each data set), and the share of
sensor units and benches that must stay within an error."""

_NUMBERS = (
    *("rms_deg", "bound_deg", "over_bound", "repeatability_deg"),
    *("availability", "false_sun"),
)


#: A pipeline below the availability limit is shown beside a ranked one if the ranked one's error is
#: more than `FINER` times as large, and if it answers at least this share of the samples.
FINER = 3.0
LEAST_ANSWERED = 0.5

Of = TypeVar("Of")


@dataclass(frozen=True)
class PartialAnswer(Generic[Of]):
    """Error of a pipeline below the availability limit, over the samples it answers.

    Attributes
    ----------
    error_deg
        RMS error over the answered samples.
    availability
        Share of the samples that are answered.
    subject
        The pipeline, or its row in a table.
    """

    error_deg: float
    availability: float
    subject: Of

    @property
    def coarse_deg(self) -> float:
        """Threshold: pipelines with a larger error name this one as finer; infinite for none."""
        return FINER * self.error_deg if self.availability >= LEAST_ANSWERED else math.inf

    def is_finer(self, error_deg: float) -> bool:
        """Return whether it is far more accurate than a given error, of at least half the samples.

        Parameters
        ----------
        error_deg : infinite for none, than which nothing is more accurate
        """
        return self.coarse_deg < error_deg < math.inf


def finer_for(error_deg: float, partly: Iterable[PartialAnswer[Of]]) -> PartialAnswer[Of] | None:
    """Return the most accurate partial answer, if it is far more accurate than a given error.

    Parameters
    ----------
    error_deg
        Error of the ranked pipeline; infinite for none, in which case None is returned.
    partly
        Candidates. Those that answer less than `LEAST_ANSWERED` of the samples are ignored.

    Returns
    -------
    PartialAnswer or None
        The first of equals; None unless `error_deg` is more than `FINER` times its error.
    """
    finer = (one for one in partly if one.is_finer(error_deg))
    return min(finer, key=lambda one: one.error_deg, default=None)


@dataclass(frozen=True)
class Score:
    """Score of one pipeline under one condition of a data set.

    Numbers are None where not measured; NaN and infinities become None.

    Attributes
    ----------
    availability, false_sun
        Answered share of the samples whose direction is observable, and of the other samples.
    is_available
        Whether the availability over the whole field is high enough to rank the pipeline.
    cones
        Pairs of a half angle about the boresight, in degrees and ascending, and the RMS error
        within it; the error is None where the availability in that cone is too low.
    """

    condition: str
    rms_deg: float | None
    bound_deg: float | None = None
    over_bound: float | None = None
    repeatability_deg: float | None = None
    availability: float | None = None
    false_sun: float | None = None
    is_available: bool = True
    cones: tuple[tuple[float, float | None], ...] = ()

    def __post_init__(self) -> None:
        for name in _NUMBERS:
            value: float | None = getattr(self, name)
            if value is not None and not math.isfinite(value):
                object.__setattr__(self, name, None)

    def to_dict(self) -> dict[str, object]:
        """Return the score as in the HTTP answer."""
        return {name: getattr(self, name) for name in ("condition", *_NUMBERS)}


@dataclass(frozen=True)
class PipelineJudgement:
    """Largest error of a pipeline over the required field and conditions.

    Attributes
    ----------
    error_deg
        RMS error; infinite where the availability is too low or the field too narrow.
    condition
        Condition under which that error was measured.
    field_deg
        Full field of view that the error covers.
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
    unit_own_deg
        Own errors of the units of the sensor, the standard one first, under the first condition.
    unit_ratios
        Errors of ten units over their geometric mean (`registry.draws.unit_ratios`).
    bench_deg
        Fixed error of the data set's standard calibration bench, root mean square.
    needs
        Inputs beside the sensor that the calibration reads (`registry.requirements.NEEDS`).
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
    unit_own_deg: tuple[float, ...] = ()
    unit_ratios: tuple[float, ...] = (1.0,) * UNITS
    bench_deg: float = 0.0
    needs: tuple[str, ...] = ()

    def judge(
        self,
        hazards: Iterable[str] = (),
        half_field_deg: float | None = None,
        draws: Draws | None = None,
    ) -> PipelineJudgement:
        """Return the largest error, nominal and under every hazard, over a field.

        With `draws`, it is the error that the given share of units and benches stays within. A
        hazard without a condition adds no error: check `covers` first.
        """
        worst = self.over(self.nominal, half_field_deg)
        for name in hazards:
            for score in self.hazards.get(name, ()):
                found = self.over(score, half_field_deg)
                if found.error_deg > worst.error_deg:
                    worst = found
        if draws is None or math.isinf(worst.error_deg):
            return worst
        from registry.draws import one_at_confidence  # noqa: PLC0415 - NumPy

        bench = self.bench_deg if draws[0] is None else draws[0]
        error = one_at_confidence(worst.error_deg, self.unit_ratios, bench, draws[1])
        return PipelineJudgement(error, worst.condition, worst.field_deg)

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
        scores = [self.nominal, *(s for name in hazards for s in self.hazards.get(name, ()))]
        shares = [0.0 if s.rms_deg is None else s.availability for s in scores]
        known = [share for share in shares if share is not None]
        return min(known) if len(known) == len(shares) else None

    def partial_answer(
        self, hazards: Iterable[str] = (), half_field_deg: float | None = None
    ) -> PartialAnswer[MeasuredPipeline] | None:
        """Return the largest error over the answered samples, if the availability is too low.

        None where the availability is high enough, and where no error is known: a condition was
        refused, a hazard has no condition, or the data set does not have the field.
        """
        names = tuple(hazards)
        scores = [self.nominal, *(s for name in names for s in self.hazards.get(name, ()))]
        whole = self.half_fov_deg
        wide = half_field_deg is None or (whole is not None and whole >= half_field_deg)
        if not (wide and all(map(self.covers, names))):
            return None
        errors, judged = [], True
        for score in scores:
            error = self.over(score, half_field_deg).error_deg
            if math.isinf(error):
                judged = False
                if score.rms_deg is None:
                    return None
                error = score.rms_deg
            errors.append(error)
        share = self.availability(names)
        return None if judged or share is None else PartialAnswer(max(errors), share, self)

    def facts(self) -> dict[str, object]:
        """Return the members of the HTTP answer that no question changes.

        But for ``units.within_limit``, which is None here.
        """
        units = self.unit_own_deg
        return {
            "dataset": self.dataset,
            "extractor": self.extractor,
            "model": self.model,
            "nominal": self.nominal.to_dict(),
            "fov_deg": None if self.half_fov_deg is None else 2 * self.half_fov_deg,
            "latency_us": self.latency_us,
            "needs": list(self.needs),
            "units": {
                "count": len(units),
                "least_deg": min(units),
                "largest_deg": max(units),
                "within_limit": None,
                "of": UNITS,
            }
            if units
            else None,
        }

    def judged(
        self,
        judged: PipelineJudgement,
        own: PipelineJudgement,
        hazards: Sequence[str] = (),
        half_field_deg: float | None = None,
        *,
        bench_deg: float | None = None,
    ) -> dict[str, object]:
        """Return the members of the HTTP answer that a question decides, but for ``finer``.

        Parameters
        ----------
        judged, own
            The error with the calibration bench, and the one with true directions.
        hazards, half_field_deg
            Hazards and half field of view of both errors.
        bench_deg
            Fixed error of the calibration bench; None for the data set's own.
        """
        error, own_error = _finite(judged.error_deg), _finite(own.error_deg)
        nominal = own_error
        if hazards:
            nominal = _finite(self.over(self.nominal, half_field_deg).error_deg)
        return {
            "error_deg": error,
            "condition": judged.condition,
            "field_deg": None if error is None else judged.field_deg,
            "nominal_deg": nominal,
            "conditions": {
                score.condition: _finite(self.over(score, half_field_deg).error_deg)
                for name in hazards
                for score in self.hazards.get(name, ())
            },
            "availability": self.availability(hazards),
            "own_deg": own_error,
            "bench_deg": self.bench_deg if bench_deg is None else bench_deg,
        }


def finer_document(found: PartialAnswer[MeasuredPipeline]) -> dict[str, object]:
    """Return a partial answer as ``finer`` of the HTTP answer."""
    return {
        "dataset": found.subject.dataset,
        "extractor": found.subject.extractor,
        "model": found.subject.model,
        "error_deg": found.error_deg,
        "availability": found.availability,
    }


def _finite(number: float) -> float | None:
    return number if math.isfinite(number) else None


class Measurements:
    """All measured pipelines; make it once and pass it to many calls.

    Parameters
    ----------
    rows : iterable of MeasuredPipeline
        Pipelines without an error under the first condition are left out.
    """

    def __init__(self, rows: Iterable[MeasuredPipeline] = ()) -> None:
        kept = [row for row in rows if row.nominal.rms_deg is not None]
        kept.sort(key=lambda r: (r.dataset, r.extractor, r.model))
        self.rows: tuple[MeasuredPipeline, ...] = tuple(kept)
        by: dict[tuple[str, str], list[MeasuredPipeline]] = {}
        for row in kept:
            by.setdefault((row.detector, row.mask), []).append(row)
        self.by_architecture: Mapping[tuple[str, str], tuple[MeasuredPipeline, ...]] = (
            MappingProxyType({pair: tuple(found) for pair, found in by.items()})
        )
