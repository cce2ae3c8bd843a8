"""Calibrations of an answer: a design and a measured pipeline of it, judged by the question."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from registry.designs import Design
from registry.draws import unit_errors
from registry.judging import Question
from registry.measured_pipelines import MeasuredPipeline, PipelineJudgement
from survey_data.processors import factor


@dataclass(frozen=True)
class Calibration:
    """A calibration of an architecture that meets the requirements, or comes nearest.

    Attributes
    ----------
    design, pipeline : labels and studies; the measured pipeline, None where none is measured
    own : own error over the required field and conditions, with the condition it is largest under
    judged_deg : error that the stated share of units (and benches, if stated) stays within
    interval_deg : own error times and over the standard error of its log over units
    needs_bench_deg : bench error up to which the limit is kept; None without a limit, 0 for none
    units_within : of ten units, how many keep the limit; None without one
    """

    design: Design
    pipeline: MeasuredPipeline | None
    own: PipelineJudgement | None = None
    judged_deg: float | None = None
    interval_deg: tuple[float, float] | None = None
    needs_bench_deg: float | None = None
    units_within: int | None = None
    latency_us: float | None = None
    availability: float | None = None


def calibration(question: Question, row: int) -> Calibration:
    """Return the calibration that a measured pipeline is of, judged by a question."""
    table, asked = question.table, question.requirements
    design, pipeline = table.designs[int(table.row_design[row])], table.rows[row]
    own = pipeline.judge(asked.hazards, asked.half_field_deg)
    judged = question.judged_alone_deg(row)
    limit = asked.largest_deg
    interval, within, needed = None, None, None
    if math.isfinite(own.error_deg):
        spread = math.exp(2.0 * float(table.log_error[row]))
        interval = own.error_deg / spread, own.error_deg * spread
        if limit is not None:
            found = unit_errors(
                np.array([own.error_deg]),
                table.unit_ratios[[row]],
                asked.bench_deg or 0.0,
                asked.share,
            )
            within = int(np.count_nonzero(found <= limit))
            needed = question.bench_for([row])
    time = pipeline.latency_us
    return Calibration(
        design=design,
        pipeline=pipeline,
        own=own,
        judged_deg=judged if math.isfinite(judged) else None,
        interval_deg=interval,
        needs_bench_deg=needed,
        units_within=within,
        latency_us=None if time is None else time * factor(asked.processor),
        availability=pipeline.availability(asked.hazards),
    )
