"""/v1/realism: the standard data sets beside built sensors."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from fastapi import APIRouter, Query

from api.http.answers import Answer, AnswerRoute
from api.http.dependencies import Known
from api.schema.datasets import BuiltSensor, BuiltSensorRow, Realism, RealismQuery
from api.schema.table import columns_of

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/realism", summary="Data sets compared with built sensors", response_model=Realism)
async def realism(known: Known, query: Annotated[RealismQuery, Query()]) -> Answer:
    """Compare each data set with built sensors and their published figures.

    Our accuracy is the RMS of unit 0 of the best pipeline under nominal conditions, on the standard
    bench; our precision is its repeatability. Differences of more than a factor of two are
    explained. CSV: a row per data set and sensor.
    """
    chosen = [
        row
        for row in known.measurements.realism
        if not query.dataset or row["dataset"] in query.dataset
    ]
    return Answer({"datasets": chosen}, columns_of(BuiltSensorRow), lambda: _rows(chosen))


def _rows(chosen: list[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    return [
        {**row, **sensor, "explanation": row["idealisation"] or row["sentence"]}
        for row in chosen
        for sensor in row["sensors"] or [dict.fromkeys(BuiltSensor.model_fields)]
    ]
