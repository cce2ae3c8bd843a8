"""Sentences of an answer: why an architecture is in it, and what holds of the whole answer."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from benchmark.leaderboard.partial_answers import PartialAnswer, better_partial_answer
from registry.answer import Answer, RankedArchitecture
from registry.calibration import Calibration
from registry.relaxation import in_words

_FEWEST_TIED = 3


def reason(answer: Answer, one: RankedArchitecture) -> str:
    """Return in one sentence why an architecture is in the answer."""
    said = []
    if "reported" in one.meets:
        more = len({report.family for report in one.reports}) - 1
        said.append(one.reports[0].words + (f" ({more} more meet all)" if more else ""))
    elif one.reports:
        said.append(one.reports[0].words + _lacks(answer, one, 0))
    if one.best is None or one.best.pipeline is None:
        said.append("not measured here")
    else:
        meets = "measured" in one.meets
        said.append(_measured_words(answer, one.best, meets=meets))
        if not meets:
            said[-1] += _lacks(answer, one, 1)
            said += _partial_answer(one)
    sentence = "; ".join(said)
    if not one.place.is_built:
        sentence = f"measured here, never built: {sentence}"
    return sentence[0].upper() + sentence[1:] + "."


def _lacks(answer: Answer, one: RankedArchitecture, kind: int) -> str:
    """Return in brackets which requirements a kind of evidence misses or leaves unknown."""
    value_of = answer.question.requirements.value_of
    found = {
        state: [
            in_words(name, value)
            for name, states in one.evidence.items()
            if states[kind] == state and (value := value_of(name)) is not None
        ]
        for state in ("misses", "unknown")
    }
    said = [f"{state}: {', '.join(names)}" for state, names in found.items() if names]
    return f" ({'; '.join(said)})" if said else ""


def _measured_words(answer: Answer, best: Calibration, *, meets: bool) -> str:
    pipeline, asked = best.pipeline, answer.question.requirements
    own, judged = best.own, best.judged
    assert pipeline is not None  # noqa: S101 - the caller has looked
    name = f"{pipeline.extractor} + {pipeline.model}"
    if own is None or judged is None or not math.isfinite(judged.error_deg):
        return f"{name} on {pipeline.dataset} answers too seldom, or not over this field"
    over = "" if judged.field_deg in {None, 360.0} else f" over {judged.field_deg:g} deg"
    where = f"({pipeline.dataset}, {judged.condition})"
    said = f"{name} has an own error of {own.error_deg:.3g} deg{over} {where}"
    if pipeline.own is not None:
        said = f"{name} errs by {judged.error_deg:.3g} deg in flight{over} {where}"
        if math.isfinite(own.error_deg):
            said += f", its own error is {own.error_deg:.3g} deg"
    if asked.bench_deg is not None and best.judged_deg is not None:
        said += f", on your bench {best.judged_deg:.3g} deg"
    is_over = (best.judged_deg or 0.0) > (asked.largest_deg or math.inf)
    if best.needs_bench_deg and (meets if asked.bench_deg is None else is_over):
        said += f", and needs a calibration bench of {best.needs_bench_deg:g} deg or better"
    return said


def _partial_answer(one: RankedArchitecture) -> list[str]:
    """Name the far more accurate pipeline of the same data set below 95 % availability, if any."""
    question = one.question
    if one.best is None or one.best.judged is None or one.best.pipeline is None:
        return []
    half, data = question.requirements.half_field_deg or 0.0, one.best.pipeline.dataset
    of_place = question.candidates & (question.table.row_place == one.number)
    rows = [question.table.rows[at] for at in np.flatnonzero(of_place)]
    partly = [
        PartialAnswer(row.nominal.rms_deg or math.inf, row.nominal.availability or 0.0, row)
        for row in rows
        if row.dataset == data
        and not row.nominal.is_available
        and (row.half_fov_deg or 0.0) >= half
    ]
    finer = better_partial_answer(one.best.judged.error_deg, partly)
    if finer is None:
        return []
    row = finer.subject
    name, where = f"{row.extractor} + {row.model}", f"({row.dataset}, {row.nominal.condition})"
    share = f"{finer.availability:.0%} of the readings"
    return [f"{name} errs by {finer.error_deg:.3g} deg {where} but answers {share}"]


def notes(answer: Answer) -> Iterator[str]:
    """Yield what holds of the whole answer: its mission, light, bench and running times."""
    question, asked = answer.question, answer.question.requirements
    if asked.mission is not None:
        yield f"Mission {asked.mission}: the requirements listed are its set, with your changes."
    if asked.light is not None:
        yield f"Distance from the Sun, {asked.light.words}."
    if asked.bench_deg is not None and asked.largest_deg is not None:
        tied = [one for one in answer.architectures if one.rank == 1 and "measured" in one.meets]
        if len(tied) >= _FEWEST_TIED:
            yield f"{len(tied)} tie on this bench; choose by power, field or latency."
        if answer.on_better_bench is not None:
            more, bench = answer.on_better_bench
            yield (
                f"The calibration bench of {asked.bench_deg:g} deg stands in the way of {more} "
                f"architecture{'s' * (more > 1)}; the first of them needs one of {bench:g} deg or "
                "better."
            )
    order = answer.height_order
    if order is not None and order.holds:
        yield order.sentence
    if asked.max_latency_us is not None:
        untimed = int((question.table.latency_us != question.table.latency_us).sum())
        if untimed:
            yield f"{untimed} pipelines were not timed; the latency limit cannot judge them."
