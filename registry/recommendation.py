"""Which sensor to build, and how to calibrate it: an answer in two levels.

Architectures (a detector behind a mask) that meet the requirements, and on each its calibrations:
an extractor, compensations, a model. Three kinds of evidence stay apart: what studies and built
sensors report, what is measured here, and what the survey's text advises.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from registry import studies as registered
from registry.answer import Answer
from registry.design_table import design_table
from registry.judging import Question
from registry.measured_pipelines import MeasuredPipeline, Measurements
from registry.ranking import SORTS, Sort
from registry.requirements import Requirements
from registry.studies import Facts
from registry.taxonomy import unknown_name


def recommend(
    requirements: Requirements | Mapping[str, object] | None = None,
    measured: Measurements | Iterable[MeasuredPipeline] = (),
    *,
    sort: Sort = "evidence",
    facts: Facts | None = None,
) -> Answer:
    """Rank the architectures that meet the requirements, and on each its calibrations.

    Parameters
    ----------
    requirements : Requirements or mapping, optional
        A mapping takes the names of `registry.requirements.PARAMETERS`, `SETTINGS`, and a
        ``mission``; none asks nothing.
    measured : Measurements or iterable of MeasuredPipeline
        What was measured. Hand in `Measurements` where many questions are asked of the same.
    sort : {"evidence", "error", "studies"}
        Order of the architectures (`registry.ranking`).
    facts : Facts, optional
        The survey's by default.

    Raises
    ------
    InvalidValueError
        For an unknown parameter or order, a value outside the taxonomy, an impossible limit.
    """
    if sort not in SORTS:
        raise unknown_name("sort", sort, SORTS)
    known = facts or registered.facts()
    if isinstance(requirements, Requirements):
        requirements.check(known.taxonomy, known.properties)
        asked = requirements
    else:
        asked = Requirements.parse(requirements or {}, known.taxonomy, known.properties)
    rows = measured if isinstance(measured, Measurements) else Measurements(measured)
    judged, own = rows.at(asked.judged_level), rows.at("own")
    question = Question(design_table(known, judged), asked)
    return Answer(question, sort, Question(design_table(known, own), asked))
