"""Where measurement contradicts advice or literature: sentences, with the numbers."""

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
"""Errors nearer to each other than this contradict nothing."""

#: How methods begin that take signals as they are, and what that is called.
_DIRECT, _AS_READ = "direct", "no extraction"


def calibration_words(extractor: str, stages: Sequence[str], run_by: str | None) -> str:
    """Return a calibration in words: extractor, stages.

    What the survey has no extractor for is named by the method `run_by` that measured it: one of
    ours, or signals taken as they are.
    """
    if extractor == NONE:
        extractor = f"{run_by} (ours)" if run_by and not run_by.startswith(_DIRECT) else _AS_READ
    return " > ".join((extractor, *("no model" if stage == NONE else stage for stage in stages)))


def design_words(candidate: Candidate) -> str:
    """Return a calibration in words."""
    run_by = None if candidate.row is None else candidate.row.extractor
    design = candidate.design
    return calibration_words(design.extractor, design.stages, run_by)


def against_literature(usual: Candidate, used: int, best: Candidate, tried: int) -> str | None:
    """Say that the calibration that most studies used is not the one with the smallest error.

    Parameters
    ----------
    usual, used
        The measured calibration that most studies used on an architecture, and how many did.
    best, tried
        The one with the smallest error there, and how many studies used that.
    """
    if not math.isfinite(best.error_deg) or usual.error_deg < LEAST_RATIO * best.error_deg:
        return None
    who = f"{used} {'studies stand' if used > 1 else 'study stands'} for {design_words(usual)}"
    others = f"{tried} {'studies' if tried > 1 else 'study'}" if tried else "no study"
    return (
        f"{who}, measured {_error(usual)}; {design_words(best)}, which {others} stands for, "
        f"reaches {_error(best)}{_times(usual, best)}"
    )


def against_advice(answer: Answer, tasks: Sequence[str]) -> tuple[str, ...]:
    """Say where an architecture that is not advised does better at a task than those advised.

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
        if not advised or len(advised) == len(places):
            continue
        others = [at for at, place in enumerate(places) if task not in place.advised_tasks]
        values = values_of(answer)
        reached = [scale * number for number in answer.reached(values)]
        first, other = (min(side, key=reached.__getitem__) for side in (advised, others))
        mine, theirs = reached[first], reached[other]
        if math.isinf(mine) or mine <= theirs or abs(mine) == abs(theirs):
            continue
        ratio = mine / theirs if mine > 0 else theirs / mine
        if ratio < LEAST_RATIO:
            continue
        named = ", ".join(_words(places[at]) for at in advised if math.isfinite(reached[at]))
        found.append(
            f"The survey advises {named} for {task}; the best of them measured here, "
            f"{_where(answer, places[first], values)}, reaches {abs(mine):.3g} {unit}; "
            f"{_where(answer, places[other], values)}, which it does not advise for that, "
            f"{abs(theirs):.3g}"
        )
    return tuple(found)


def regret_words(regret: Regret) -> str:
    """Say by how much the first calibration named errs more than the best one measured."""
    first, best = regret.first, regret.best
    if first is best:
        return "the first calibration named is the best one measured that meets the requirements"
    named = f"{design_words(best)} on {' + '.join(best.design.architecture)}"
    if not math.isfinite(first.error_deg):
        why = "is not measured" if first.row is None else "answers too seldom to be judged"
        beside = f"the best one measured, {named}, errs {_error(best)}"
        return f"the first calibration named {why}; {beside}"
    return (
        f"the first calibration named errs {_error(first)}; the best one measured that meets the "
        f"requirements, {named}, {_error(best)}{_times(first, best)}"
    )


def _words(place: RankedPlace) -> str:
    return " + ".join(place.place.architecture)


def _where(answer: Answer, place: RankedPlace, values: Numbers) -> str:
    row = answer.best.pipeline(answer.reached_by(place, values))
    pipeline = "" if row is None else f"{row.extractor} > {row.model} on {row.dataset}"
    return f"{_words(place)} ({pipeline})"


def _error(candidate: Candidate) -> str:
    judged = candidate.judged
    if not math.isfinite(judged.error_deg):
        nominal = None if candidate.row is None else candidate.row.nominal
        if nominal is None or nominal.rms_deg is None or nominal.availability is None:
            return "without an error over the field and conditions asked for"
        return (
            f"{nominal.rms_deg:.3g} deg where it answers, {100 * nominal.availability:.0f} % of "
            "the samples: too seldom"
        )
    over = "" if judged.field_deg is None else f" over {judged.field_deg:g} deg"
    return f"{judged.error_deg:.3g} deg{over}"


def _times(worse: Candidate, better: Candidate) -> str:
    if not math.isfinite(worse.error_deg):
        return ""
    return f", {worse.error_deg / better.error_deg:.3g} times less"


_MEASURED: tuple[tuple[str, Callable[[Answer], Numbers], float, str], ...] = (
    ("Accuracy", attrgetter("best.error"), 1.0, "deg"),
    ("Precision", attrgetter("best.repeatability_deg"), 1.0, "deg of repeatability"),
    ("FOV", attrgetter("best.negated_half_field_deg"), 2.0, "deg of field"),
)
"""Tasks that are measured here: their values of each design, the least the best, and the unit."""
