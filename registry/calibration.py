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
    judged, own, flight : error over the required field and conditions, with the condition it is
        largest under: at the level that is judged, on the ground, and in flight (None: not flown)
    judged_deg : error that the stated share of units (and benches, if stated) stays within
    own_interval_deg, flight_interval_deg : each times and over two standard errors of its log over
        units
    needs_bench_deg : bench error up to which the limit is kept; None without a limit, 0 for none
    units_within : of ten units, how many keep the limit; None without one
    """

    design: Design
    pipeline: MeasuredPipeline | None
    judged: PipelineJudgement | None = None
    own: PipelineJudgement | None = None
    flight: PipelineJudgement | None = None
    judged_deg: float | None = None
    own_interval_deg: tuple[float, float] | None = None
    flight_interval_deg: tuple[float, float] | None = None
    needs_bench_deg: float | None = None
    units_within: int | None = None
    latency_us: float | None = None
    availability: float | None = None


def calibration(question: Question, row: int) -> Calibration:
    """Return the calibration that a measured pipeline is of, judged by a question."""
    table, asked = question.table, question.requirements
    design, pipeline = table.designs[int(table.row_design[row])], table.rows[row]
    on_the_ground = pipeline.own or pipeline
    flown = on_the_ground.flown
    at_level = pipeline.judge(asked.hazards, asked.half_field_deg)
    own = on_the_ground.judge(asked.hazards, asked.half_field_deg)
    flight = None if flown is None else flown.judge(asked.hazards, asked.half_field_deg)
    judged = question.judged_alone_deg(row)
    limit = asked.largest_deg
    within, needed = None, None
    if math.isfinite(at_level.error_deg) and limit is not None:
        found = unit_errors(
            np.array([at_level.error_deg]),
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
        judged=at_level,
        own=own,
        flight=flight,
        judged_deg=judged if math.isfinite(judged) else None,
        own_interval_deg=_interval(on_the_ground, own),
        flight_interval_deg=None if flight is None else _interval(flown, flight),
        needs_bench_deg=needed,
        units_within=within,
        latency_us=None if time is None else time * factor(asked.processor),
        availability=pipeline.availability(asked.hazards),
    )


def _interval(
    pipeline: MeasuredPipeline | None, judged: PipelineJudgement
) -> tuple[float, float] | None:
    """Return an error times and over two standard errors of its log over units."""
    if pipeline is None or not math.isfinite(judged.error_deg):
        return None
    measured = math.sqrt(max(len(pipeline.unit_own_error_deg), 1))
    spread = math.exp(2.0 * float(np.log(np.sort(pipeline.unit_ratios)).std(ddof=1)) / measured)
    return judged.error_deg / spread, judged.error_deg * spread
