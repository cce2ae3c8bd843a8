"""The stage of scores: what a pipeline answered is judged."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from algorithms.chain import Scored
from algorithms.contract import Floats
from benchmark.contract import ON_BENCH
from benchmark.datasets.method_bound import method_bound_deg
from benchmark.metrics.score import Score, score
from benchmark.metrics.separation import separation_deg
from benchmark.running.stages import Answers, ConditionData, Task


@dataclass(frozen=True)
class PipelineOutcome:
    """What came of one model: a score, or the reason there is none.

    `refused`: the model's ``fit`` raised UnusableDataError, its contract's word for data it cannot
    work on. That is a result of method and data, as repeatable as a score; any other error is a
    failure, tried again by the next run. `sample_errors_deg` are the errors (N,) of the test
    samples under the first condition, NaN without an answer, and `found` says where (N,) the
    extractor gave features; None under other conditions.
    """

    model: str
    reason: str
    score: Score | None = None
    refused: bool = False
    sample_errors_deg: Floats | None = None
    found: NDArray[np.bool_] | None = None


def score_answers(
    task: Task, model: Scored, answers: Answers, data: ConditionData
) -> PipelineOutcome:
    """Judge what a pipeline answered."""
    name = model.about.name
    if answers.refused:
        return PipelineOutcome(name, answers.refused, refused=True)
    if task.condition == ON_BENCH:
        return PipelineOutcome(name, "", _pooled(answers, data))
    test, (own,) = data.splits["test"], answers.test
    posterior = _posterior_deg(task, model, data, unit_known=True)
    unit_posterior = _posterior_deg(task, model, data, unit_known=False)
    found = score(
        own,
        test.sun,
        data.bound_deg if posterior is None else posterior,
        data.observable,
        None if answers.repeat is None else _repeat(answers.repeat, data),
        bound_unit_deg=data.bound_unit_deg if unit_posterior is None else unit_posterior,
    )
    if task.condition != task.preset.conditions[0]:
        return PipelineOutcome(name, "", found)
    errors = separation_deg(own, test.sun)
    return PipelineOutcome(name, "", found, sample_errors_deg=errors, found=answers.found)


def _pooled(answers: Answers, data: ConditionData) -> Score:
    """Judge the answers of all benches together; those that are aligned each by itself."""
    sun = data.splits["test"].sun
    each = [score(answer, sun, None, data.observable) for answer in answers.test]
    pooled = score(
        np.concatenate(answers.test),
        np.tile(sun, (len(answers.test), 1)),
        None,
        np.tile(data.observable, len(answers.test)),
    )
    aligned = math.sqrt(float(np.mean([one.aligned_deg**2 for one in each])))
    return replace(pooled, aligned_deg=aligned)


def _posterior_deg(
    task: Task, model: Scored, data: ConditionData, *, unit_known: bool
) -> Floats | None:
    """Bound (N,) of a method that knows the samples before or other instruments; None else."""
    if data.bound is None or not model.about.context:
        return None
    context = frozenset(model.about.context)
    return method_bound_deg(task.preset, task.condition, context, data.bound, unit_known=unit_known)


def _repeat(predicted: Floats, data: ConditionData) -> Floats:
    """Answers (R, P, 3) to the observable poses of the split ``repeat``."""
    chosen = data.preset.repeats.pose_indices(len(data.observable))
    passes = np.asarray(predicted).reshape(data.preset.repeats.passes, len(chosen), 3)
    return np.asarray(passes[:, data.observable[chosen]])
