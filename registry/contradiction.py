"""Where measurement contradicts advice or literature: sentences, with the numbers."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from operator import attrgetter
from typing import TYPE_CHECKING

from registry.designs import Kept
from registry.judging import KeptPlace
from registry.ranking import Regret
from registry.taxonomy import NO_IMPLEMENTATION_STATED as NONE

if TYPE_CHECKING:
    from registry.ranked_designs import RankedPlace

LEAST_RATIO = 1.1
"""Errors nearer to each other than this contradict nothing."""

#: How methods begin that take signals as they are, and what that is called.
_DIRECT, _AS_READ = "direct", "no extraction"

Reached = tuple[float, int]
"""A number reached on an architecture, infinite where none is, and the position of the design."""


def calibration_words(extractor: str, stages: Sequence[str], run_by: str | None) -> str:
    """Return a calibration in words: extractor, stages.

    What the survey has no extractor for is named by the method `run_by` that measured it: one of
    ours, or signals taken as they are.
    """
    if extractor == NONE:
        extractor = f"{run_by} (ours)" if run_by and not run_by.startswith(_DIRECT) else _AS_READ
    return " > ".join((extractor, *("no model" if stage == NONE else stage for stage in stages)))


def design_words(kept: Kept) -> str:
    """Return a calibration that is kept in words."""
    run_by = None if kept.row is None else kept.row.extractor
    return calibration_words(kept.design.extractor, kept.design.stages, run_by)


def against_literature(place: KeptPlace, usual: Kept | None) -> str | None:
    """Say that what most studies stand for on an architecture is not what errs least there.

    Parameters
    ----------
    place : KeptPlace
    usual : Kept
        Of its measured calibrations the one that most studies stand for; None for none.
    """
    best = place.best
    if usual is None or not math.isfinite(best.error_deg):
        return None
    if usual.error_deg < LEAST_RATIO * best.error_deg:
        return None
    many = place.taken(usual).bit_count()
    who = f"{many} {'studies stand' if many > 1 else 'study stands'} for {design_words(usual)}"
    others = place.taken(best).bit_count()
    tried = f"{others} {'studies' if others > 1 else 'study'}" if others else "no study"
    return (
        f"{who}, measured {_error(usual)}; {design_words(best)}, which {tried} stands for, "
        f"reaches {_error(best)}{_times(usual, best)}"
    )


def against_advice(places: Sequence[RankedPlace], tasks: Sequence[str]) -> tuple[str, ...]:
    """Say where an architecture that is not advised does better at a task than those advised.

    Of the tasks, accuracy, precision and field of view are measured here: by the error over the
    field and conditions asked for, by the repeatability, by the field itself.

    Parameters
    ----------
    places : sequence of RankedPlace
    tasks : sequence of str
        Those asked for; none means all.
    """
    found = []
    for task, reached, unit in _MEASURED:
        if tasks and task not in tasks:
            continue
        advised = [place for place in places if task in place.advised_tasks]
        if not advised or len(advised) == len(places):
            continue
        others = [place for place in places if task not in place.advised_tasks]
        of_advised, of_others = ([reached(at)[0] for at in side] for side in (advised, others))
        mine, theirs = min(of_advised), min(of_others)
        if math.isinf(mine) or mine <= theirs or abs(mine) == abs(theirs):
            continue
        ratio = mine / theirs if mine > 0 else theirs / mine
        if ratio < LEAST_RATIO:
            continue
        first, other = advised[of_advised.index(mine)], others[of_others.index(theirs)]
        named = ", ".join(at.words for at in advised if math.isfinite(reached(at)[0]))
        found.append(
            f"The survey advises {named} for {task}; the best of them measured here, "
            f"{_where(first, reached(first)[1])}, reaches {abs(mine):.3g} {unit}; "
            f"{_where(other, reached(other)[1])}, which it does not advise for that, "
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


def _where(place: KeptPlace, design: int) -> str:
    row = place.judged.pipeline(design)
    pipeline = "" if row is None else f"{row.extractor} > {row.model} on {row.dataset}"
    return f"{place.words} ({pipeline})"


def _error(kept: Kept) -> str:
    judged = kept.judged
    if not math.isfinite(judged.error_deg):
        nominal = None if kept.row is None else kept.row.nominal
        if nominal is None or nominal.rms_deg is None or nominal.availability is None:
            return "without an error over the field and conditions asked for"
        return (
            f"{nominal.rms_deg:.3g} deg where it answers, {100 * nominal.availability:.0f} % of "
            "the samples: too seldom"
        )
    over = "" if judged.field_deg is None else f" over {judged.field_deg:g} deg"
    return f"{judged.error_deg:.3g} deg{over}"


def _times(worse: Kept, better: Kept) -> str:
    if not math.isfinite(worse.error_deg):
        return ""
    return f", {worse.error_deg / better.error_deg:.3g} times less"


def _least_error(place: RankedPlace) -> Reached:
    return place.error_deg, place.best_at


_MEASURED: tuple[tuple[str, Callable[[RankedPlace], Reached], str], ...] = (
    ("Accuracy", _least_error, "deg"),
    ("Precision", attrgetter("repeatability"), "deg of repeatability"),
    ("FOV", attrgetter("field"), "deg of field"),
)
"""Tasks that are measured here: what of an architecture tells, the least the best, and in what."""
