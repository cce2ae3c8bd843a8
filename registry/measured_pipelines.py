"""Measured performance as the registry sees it: pipelines handed in by whoever measured."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Generic, TypeVar

from registry.requirements import UNITS

Draws = tuple[float | None, float]
"""A bench's fixed error in degrees, None for a data set's own, and a share of units and benches."""

_NUMBERS = (
    *("rms_deg", "bound_deg", "over_bound", "repeatability_deg"),
    *("availability", "false_sun"),
)


#: What answers too seldom to be judged by its error is named beside what is judged where that errs
#: by more than this many times as much, and where it answers at least this share of the samples.
FINER = 3.0
LEAST_ANSWERED = 0.5

Of = TypeVar("Of")


@dataclass(frozen=True)
class Partly(Generic[Of]):
    """What answers too seldom to be judged by its error: its error where it answers, and how often.

    Attributes
    ----------
    of
        Whatever it is said of.
    """

    error_deg: float
    availability: float
    of: Of


def finer_for(error_deg: float, partly: Iterable[Partly[Of]]) -> Partly[Of] | None:
    """Return what errs least of those that answer part of the samples, if far less than an error.

    Parameters
    ----------
    error_deg
        Of what is judged; infinite where nothing is, beside which nothing is named.
    partly
        Those that answer less than `LEAST_ANSWERED` are passed over.

    Returns
    -------
    Partly or None
        The first of equals; None unless the error is more than `FINER` times as large.
    """
    often = (one for one in partly if one.availability >= LEAST_ANSWERED)
    finest = min(often, key=lambda one: one.error_deg, default=None)
    if finest is None or math.isinf(error_deg) or not error_deg > FINER * finest.error_deg:
        return None
    return finest


@dataclass(frozen=True)
class Score:
    """The score of one pipeline under one condition of a data set.

    Numbers are None where not measured; NaN and infinities are taken as None.

    Attributes
    ----------
    availability, false_sun
        Answered shares of the samples whose direction is observable, and of the others.
    available
        Whether it answers often enough to be judged by its error over the whole field.
    cones
        Half angle of a cone about the boresight, in degrees and ascending, and the RMS error over
        it; None where it does not answer often enough in all of the cone.
    """

    condition: str
    rms_deg: float | None
    bound_deg: float | None = None
    over_bound: float | None = None
    repeatability_deg: float | None = None
    availability: float | None = None
    false_sun: float | None = None
    available: bool = True
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
    """What a pipeline is judged by: its largest error over the field and conditions asked for.

    Attributes
    ----------
    error_deg
        Infinite where it does not answer often enough, or does not have the field.
    condition
        Where that error was measured.
    field_deg
        Full field that it holds over.
    """

    error_deg: float
    condition: str
    field_deg: float | None


@dataclass(frozen=True)
class MeasuredPipeline:
    """One pipeline on one data set, under all of its conditions.

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
        What a sensor may have to survive (`registry.requirements.HAZARDS`) -> the scores under
        the conditions of this data set that try it. One without a condition is absent.
    unit_own_deg
        Own errors of the units of the sensor, the standard one first, under the first condition.
    unit_ratios
        Of ten units, over their geometric mean (`registry.draws.unit_ratios`).
    bench_deg
        Fixed error of the data set's standard calibration bench, root mean square.
    needs
        What the calibration reads beside the sensor (`registry.requirements.NEEDS`).
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

        With `draws`, a bench and a share, it is the error that this share of units and benches
        keeps within; a bench of None is the data set's. A hazard that no condition tries has no
        error here: ask `tried` first.
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

        The field is the narrowest cone with an error that holds the one asked for, or the whole
        field of the data set: where no field is asked for, and where no cone has an error, too
        few samples being in it, but the whole field is wide enough.
        """
        if half_field_deg is not None:
            for half, error in score.cones:
                if half >= half_field_deg and error is not None:
                    return PipelineJudgement(error, score.condition, 2 * half)
        whole = self.half_fov_deg
        field_deg = None if whole is None else 2 * whole
        wide = half_field_deg is None or (whole is not None and whole >= half_field_deg)
        if not wide or not score.available or score.rms_deg is None:
            return PipelineJudgement(math.inf, score.condition, field_deg)
        return PipelineJudgement(score.rms_deg, score.condition, field_deg)

    def tried(self, hazard: str) -> bool:
        """Say whether a condition of the data set tries a hazard."""
        return bool(self.hazards.get(hazard))

    def availability(self, hazards: Iterable[str] = ()) -> float | None:
        """Return the least answered share, nominal and under every hazard; None if one is unknown.

        A refused run answers nothing.
        """
        scores = [self.nominal, *(s for name in hazards for s in self.hazards.get(name, ()))]
        shares = [0.0 if s.rms_deg is None else s.availability for s in scores]
        known = [share for share in shares if share is not None]
        return min(known) if len(known) == len(shares) else None

    def partly(
        self, hazards: Iterable[str] = (), half_field_deg: float | None = None
    ) -> Partly[MeasuredPipeline] | None:
        """Return the largest error where it answers, if it answers too seldom to be judged.

        None where it is judged, and where no error is known: a refused condition, a hazard that
        nothing tries, a field that the data set does not have.
        """
        names = tuple(hazards)
        scores = [self.nominal, *(s for name in names for s in self.hazards.get(name, ()))]
        whole = self.half_fov_deg
        wide = half_field_deg is None or (whole is not None and whole >= half_field_deg)
        if not (wide and all(map(self.tried, names))):
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
        return None if judged or share is None else Partly(max(errors), share, self)

    def to_dict(
        self,
        judged: PipelineJudgement,
        own: PipelineJudgement,
        hazards: Iterable[str] = (),
        half_field_deg: float | None = None,
        *,
        bench_deg: float | None = None,
        partly: Iterable[Partly[MeasuredPipeline]] = (),
    ) -> dict[str, object]:
        """Return the pipeline as in the HTTP answer, but for its units that meet a limit.

        Parameters
        ----------
        judged, own
            The error that it is judged by, and the one with true directions.
        hazards, half_field_deg
            What both hold under and over.
        bench_deg
            Fixed error of the bench asked for; None for the data set's own.
        partly
            Pipelines on the same sensor that answer too seldom, of which one may be far finer.
        """
        names, units = tuple(hazards), self.unit_own_deg
        nominal = self.over(self.nominal, half_field_deg) if names else own
        return {
            "dataset": self.dataset,
            "extractor": self.extractor,
            "model": self.model,
            "error_deg": _finite(judged.error_deg),
            "condition": judged.condition,
            "field_deg": judged.field_deg if math.isfinite(judged.error_deg) else None,
            "nominal_deg": _finite(nominal.error_deg),
            "nominal": self.nominal.to_dict(),
            "conditions": {
                score.condition: _finite(self.over(score, half_field_deg).error_deg)
                for name in names
                for score in self.hazards.get(name, ())
            },
            "fov_deg": None if self.half_fov_deg is None else 2 * self.half_fov_deg,
            "availability": self.availability(names),
            "latency_us": self.latency_us,
            "own_deg": _finite(own.error_deg),
            "bench_deg": self.bench_deg if bench_deg is None else bench_deg,
            "needs": list(self.needs),
            "units": {
                "count": len(units),
                "least_deg": min(units),
                "largest_deg": max(units),
                "meeting": None,
                "of": UNITS,
            }
            if units
            else None,
            "finer": _finer(finer_for(judged.error_deg, partly)),
        }


def _finer(found: Partly[MeasuredPipeline] | None) -> dict[str, object] | None:
    if found is None:
        return None
    return {
        "dataset": found.of.dataset,
        "extractor": found.of.extractor,
        "model": found.of.model,
        "error_deg": found.error_deg,
        "availability": found.availability,
    }


def _finite(number: float) -> float | None:
    return number if math.isfinite(number) else None


class Measurements:
    """Pipelines that were measured; build once and hand in many times.

    Parameters
    ----------
    rows : iterable of Measured
        Those that failed under the first condition are left out.
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
