"""Errors sample by sample."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from api.schema.base import Shape, TableQuestion, example, page_of
from api.schema.parameters import (
    DEFAULT_PAGE,
    FIELDS,
    WHOLE,
    Cursor,
    Limit,
    OneOf,
    Several,
    several,
)
from api.schema.table import columns_of
from api.schema.words import ExtractorName, ModelName
from benchmark.results.samples import OUTCOMES


class SampleErrorsQuery(TableQuestion):
    """Which errors of a data set."""

    model_config = example(extractor=["weighted-spots"], unit=0, limit=1)

    extractor: Several[ExtractorName] = several("Only this extractor.")
    model: Several[ModelName] = several("Only this model.")
    unit: Annotated[int | None, WHOLE] = Field(None, ge=0, le=127, description="Only this unit.")
    fields: Several[Annotated[str, OneOf(lambda: list(columns_of(SampleError)))]] = FIELDS
    limit: Limit = DEFAULT_PAGE
    cursor: Cursor = None


class SampleError(Shape):
    """The error of one pipeline on one sample of the test split, under the nominal condition."""

    extractor: str
    model: str
    unit: int = Field(description="Sensor unit; 0 is the standard unit.")
    sample: int = Field(description="Number of the sample in the test split, from 0.")
    sun_x: float = Field(description="True direction of the Sun in the sensor's frame, x.")
    sun_y: float = Field(description="True direction of the Sun in the sensor's frame, y.")
    sun_z: float = Field(description="True direction in the sensor's frame, z.")
    observable: bool = Field(description="Whether the readings contain the direction.")
    bound_deg: float | None = Field(description="Cramer-Rao bound of this sample, unit 0.")
    error_deg: float | None = Field(description="Separation angle; null without an answer.")
    outcome: int = Field(
        description="; ".join(f"{code}: {meaning}" for code, meaning in OUTCOMES.items()) + "."
    )


SampleErrors = page_of(
    SampleError, "SampleErrors", "A page of errors, by extractor, model, unit and sample."
)
