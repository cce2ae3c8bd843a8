"""/v1/realism: the standard data sets beside built sensors."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from fastapi import APIRouter, Query

from api import columns
from api.http.answers import Answer, AnswerRoute
from api.http.dependencies import Known
from api.http.models.datasets import BuiltSensor, Realism, RealismQuery

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/realism", summary="Data sets beside built sensors", response_model=Realism)
async def realism(known: Known, query: Annotated[RealismQuery, Query()]) -> Answer:
    """List the nearest built sensors of each data set with published figures, and ours beside.

    Our accuracy is the error of the best pipeline on the nominal condition, our precision its
    repeatability. A sentence explains a difference by more than a factor of two; a data set that
    stands for no built sensor says why. As CSV: a row a data set and sensor.
    """
    chosen = [
        row
        for row in known.measurements.realism
        if not query.dataset or row["dataset"] in query.dataset
    ]
    return Answer({"datasets": chosen}, columns.REALISM, lambda: _rows(chosen))


def _rows(chosen: list[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    return [
        {**row, **sensor, "explanation": row["idealisation"] or row["sentence"]}
        for row in chosen
        for sensor in row["sensors"] or [dict.fromkeys(BuiltSensor.model_fields)]
    ]
