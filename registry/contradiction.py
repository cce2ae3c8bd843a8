"""Names of calibrations, and sentences where measurement contradicts advice or literature."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from operator import attrgetter
from typing import TYPE_CHECKING

from registry.designs import Candidate
from registry.ranking import Regret
from registry.taxonomy import NO_IMPLEMENTATION_STATED as NONE

if TYPE_CHECKING:
    from registry.answer import Answer, RankedPlace
    from registry.pipelines import Numbers

LEAST_RATIO = 1.1
"""Smaller ratios of errors do not count as a contradiction."""


def calibration_name(
    extractor: str, stages: Sequence[str], measured: tuple[str, str] | None
) -> str:
    """Return the one name of a calibration.

    Parameters
    ----------
    extractor, stages
        The survey's labels of its extractor and of its compensations and model.
    measured
        Names of the extractor and model that were measured, if any.

    Returns
    -------
    str
        The measured pipeline, such as ``bctm + pinhole``; without one the survey's labels, marked.
    """
    if measured is not None:
        return pipeline_name(*measured)
    return f"{labels(extractor, stages)} (survey labels)"


def pipeline_name(extractor: str, model: str) -> str:
    """Return the name of a pipeline, such as ``bctm + optical + lut``."""
    return f"{extractor} + {model}"


def labels(extractor: str, stages: Sequence[str]) -> str:
    """Return the survey's labels of a calibration, such as ``BCTM + LSQ``."""
    first = "no extraction" if extractor == NONE else extractor
    return " + ".join((first, *("no model" if stage == NONE else stage for stage in stages)))


def design_words(candidate: Candidate) -> str:
    """Return the name of a calibration."""
    row, design = candidate.row, candidate.design
    measured = None if row is None else (row.extractor, row.model)
    return calibration_name(design.extractor, design.stages, measured)


def is_contradicted(usual_deg: float, best_deg: float) -> bool:
    """Return whether an error is so much larger than the smallest that it contradicts studies."""
    return usual_deg > best_deg and usual_deg >= LEAST_RATIO * best_deg


def against_literature(usual: Candidate, used: int, best: Candidate, tried: int) -> str | None:
    """Compare the calibration that most studies used with the one that has the smallest error.

    Parameters
    ----------
    usual, used
        The measured calibration that most studies used on an architecture, and how many did.
    best, tried
        The one with the smallest error there, and how many studies used that.
    """
    if not is_contradicted(usual.error_deg, best.error_deg):
        return None
    others = f"{tried} {'studies' if tried > 1 else 'study'}" if tried else "no study"
    return (
        f"{used} {'studies' if used > 1 else 'study'} used {design_words(usual)}: {_error(usual)}; "
        f"{design_words(best)}, used by {others}, reaches {_error(best)}{_times(usual, best)}"
    )


def against_advice(answer: Answer, tasks: Sequence[str]) -> tuple[str, ...]:
    """Name tasks at which an architecture that is not advised is better than the advised ones.

    Of the tasks, accuracy, precision and field of view are measured here: by the error over the
    field and conditions asked for, by the repeatability, by the field itself.

    Parameters
    ----------
    answer : Answer
    tasks : sequence of str
        Those asked for; none means all.
    """
    found = []
    places = answer.places
    for task, values_of, scale, unit in _MEASURED:
        if tasks and task not in tasks:
            continue
        advised = [at for at, place in enumerate(places) if task in place.advised_tasks]
        if len(advised) in {0, len(places)}:
            continue
        values = values_of(answer)
        reached = answer.least_by_place(values)
        other = reached.index(min(reached))
        if other in advised:
            continue
        first = min(advised, key=reached.__getitem__)
        mine, theirs = scale * reached[first], scale * reached[other]
        if math.isinf(mine) or mine <= theirs or abs(mine) == abs(theirs):
            continue
        less, more = sorted((abs(mine), abs(theirs)))
        if more < LEAST_RATIO * less:
            continue
        named = ", ".join(_words(places[at]) for at in advised if math.isfinite(reached[at]))
        found.append(
            f"For {task} the survey advises {named.rstrip('.')}. The best of these, "
            f"{_where(answer, places[first], values)}, reaches {abs(mine):.3g} {unit}; "
            f"{_where(answer, places[other], values)}, not advised, reaches {abs(theirs):.3g} "
            f"{unit}"
        )
    return tuple(found)


def regret_words(regret: Regret) -> str:
    """Compare the first calibration of the ranking with the most accurate one measured."""
    first, best = regret.first, regret.best
    if first is best:
        return "the first calibration is the most accurate one measured that meets the requirements"
    named = f"{design_words(best)} on {' + '.join(best.design.architecture)}"
    if not math.isfinite(first.error_deg):
        why = "is not measured" if first.row is None else "has too low an availability"
        return f"the first calibration {why}; the most accurate one, {named}, has {_error(best)}"
    return (
        f"the first calibration has {_error(first)}; the most accurate one measured that meets the "
        f"requirements, {named}, has {_error(best)}{_times(first, best)}"
    )


def _words(place: RankedPlace) -> str:
    return " + ".join(place.place.architecture)


def _where(answer: Answer, place: RankedPlace, values: Numbers) -> str:
    row = answer.best.pipeline(answer.design_with_least(place, values))
    pipeline = "" if row is None else f"{pipeline_name(row.extractor, row.model)} on {row.dataset}"
    return f"{_words(place)} ({pipeline})"


def _error(candidate: Candidate) -> str:
    judged = candidate.judgement
    if not math.isfinite(judged.error_deg):
        nominal = None if candidate.row is None else candidate.row.nominal
        if nominal is None or nominal.rms_deg is None or nominal.availability is None:
            return "no error over the required field of view and conditions"
        return (
            f"{nominal.rms_deg:.3g} deg RMS at {100 * nominal.availability:.0f} % availability, "
            "which is too low"
        )
    over = "" if judged.field_deg is None else f" over {judged.field_deg:g} deg"
    return f"{judged.error_deg:.3g} deg RMS{over}"


def _times(worse: Candidate, better: Candidate) -> str:
    if not math.isfinite(worse.error_deg) or not better.error_deg:
        return ""
    return f", {worse.error_deg / better.error_deg:.3g} times smaller"


_MEASURED: tuple[tuple[str, Callable[[Answer], Numbers], float, str], ...] = (
    ("Accuracy", attrgetter("best.error"), 1.0, "deg"),
    ("Precision", attrgetter("best.repeatability_deg"), 1.0, "deg of repeatability"),
    ("FOV", attrgetter("best.negated_half_field_deg"), 2.0, "deg of field"),
)
"""Tasks that are measured here: their values of each design, the least the best, and the unit."""
