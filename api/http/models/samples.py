"""Errors sample by sample."""

from __future__ import annotations

from typing import Annotated

from pydantic import ConfigDict, Field

from api import columns
from api.http.models.base import Listing, Shape, TableQuestion
from api.http.models.parameters import (
    DEFAULT_PAGE,
    FIELDS,
    WHOLE,
    Cursor,
    Limit,
    Several,
    columns_of,
    several,
)
from api.http.models.words import ExtractorName, ModelName
from benchmark.results.samples import DOUBTS


class SampleErrorsQuery(TableQuestion):
    """Which errors of a data set."""

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"extractor": ["weighted-spots"], "unit": 0, "limit": 1}]}
    )

    extractor: Several[ExtractorName] = several(
        "Only this extractor, by the name of its implementation."
    )
    model: Several[ModelName] = several("Only this model, by the name of its implementation.")
    unit: Annotated[int | None, WHOLE] = Field(
        None, ge=0, le=127, description="Only this unit of the sensor; 0 is the standard one."
    )
    fields: Several[Annotated[str, columns_of(columns.SAMPLE_ERRORS)]] = FIELDS
    limit: Limit = DEFAULT_PAGE
    cursor: Cursor = None


class SampleError(Shape):
    """The error of one pipeline on one sample of the test split, under the nominal condition."""

    extractor: str
    model: str
    unit: int = Field(description="Which unit of the sensor; 0 is the standard one.")
    sample: int = Field(description="Number of the sample in the test split, from 0.")
    sun_x: float = Field(description="True direction of the Sun in the sensor's frame, x.")
    sun_y: float = Field(description="The same, y.")
    sun_z: float = Field(description="The same, z: along the boresight.")
    observable: bool = Field(description="Whether the direction can be told at all.")
    bound_deg: float | None = Field(
        description="Cramer-Rao bound of this sample, of unit 0; null where there is none."
    )
    error_deg: float | None = Field(
        description="Angle between answer and truth, kept to a part in 2,000; null where there is "
        "no answer."
    )
    doubt: int = Field(
        description="; ".join(f"{code}: {meaning}" for code, meaning in DOUBTS.items()) + "."
    )


class SampleErrors(Listing):
    """A page of errors, by extractor, model, unit and sample."""

    items: list[SampleError]
