"""/v1/compare: pipelines of a data set, or architectures, side by side."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Query

from api.schema.comparison import ComparedRow, CompareQuery, Comparison
from api.schema.table import columns_of
from api.service.comparing import compare_architectures, compare_pipelines
from api.service.knowledge import Knowledge
from api.service.problems import Problem, Violation
from api.web.answers import Answer, AnswerRoute
from api.web.dependencies import Known
from registry.taxonomy import InvalidValueError

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/compare", summary="Comparison", response_model=Comparison)
async def compare(known: Known, query: Annotated[CompareQuery, Query()]) -> Answer:
    """Compare two to four pipelines of a data set, or two to four architectures.

    Error, bound, availability, time, calibration poses, errors by condition and off-axis angle, and
    studies. CSV: a row each, without errors by condition and angle.
    """
    try:
        document = _compare(known.of(query.edition), query)
    except InvalidValueError as error:
        came = None if error.value is None else str(error.value)
        violation = Violation(error.parameter, came, error.expected, error.nearest)
        raise Problem(400, "not-comparable", errors=[violation]) from error
    return Answer(document, columns_of(ComparedRow), lambda: document["items"])


def _compare(known: Knowledge, query: CompareQuery) -> dict[str, Any]:
    if query.architecture:
        for other in ("dataset", "pipeline", "condition"):
            if given := getattr(query, other):
                expected = "nothing beside `architecture`, which has data sets of its own"
                raise InvalidValueError(other, str(given), expected)
        return compare_architectures(known, query.architecture)
    if query.dataset is None:
        raise InvalidValueError("dataset", None, "a data set with its pipelines, or architectures")
    return compare_pipelines(known, query.dataset, query.pipeline, query.condition)
