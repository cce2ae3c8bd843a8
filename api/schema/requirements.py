"""Requirements on a sensor and its calibration, in a query or a body."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, ConfigDict, Field, WithJsonSchema

from api.schema import words
from api.schema.base import OfEdition, TableQuestion
from api.schema.parameters import (
    GIVEN,
    LARGEST_PAGE,
    NUMBER,
    WHOLE,
    Cursor,
    OneOf,
    Several,
    several,
)
from registry.ranking import Sort
from registry.requirements import EVIDENCE, LEVELS, MISSIONS
from survey_data.processors import form, processors

INCLUDE = ("calibrations", "paths", "designs")


def _wanted(attribute: str) -> Any:
    return several(f"Require one of these values of {attribute}.")


def _unwanted(attribute: str) -> Any:
    return several(f"Exclude these values of {attribute}.")


def _split(value: Any) -> Any:
    """Return a list of words that commas may separate."""
    values = [value] if isinstance(value, str) else value
    if not isinstance(values, list) or not all(isinstance(one, str) for one in values):
        return value
    return [word for one in values for word in one.split(",")]


Number = Annotated[float | None, NUMBER]
Included = Annotated[str, OneOf(lambda: INCLUDE)]


class Requirements(OfEdition):
    """Requirements on a sensor and its calibration."""

    model_config = ConfigDict(defer_build=True)  # the command line reads the fields alone

    mission: Annotated[str | None, OneOf(lambda: tuple(MISSIONS)), GIVEN] = Field(
        None,
        description="Named set of requirements; a requirement given beside it replaces its own.",
    )
    task: Several[words.Task] = _wanted("task")
    error: Several[words.Error] = _wanted("error")
    accuracy: Several[words.Accuracy] = several("Require one of these classes.")
    detector: Several[words.Detector] = _wanted("detector")
    mask: Several[words.Mask] = _wanted("mask")
    model: Several[words.Model] = _wanted("model")
    extractor: Several[words.Extractor] = _wanted("extractor")
    exclude_task: Several[words.Task] = _unwanted("task")
    exclude_error: Several[words.Error] = _unwanted("error")
    exclude_accuracy: Several[words.Accuracy] = _unwanted("accuracy")
    exclude_detector: Several[words.Detector] = _unwanted("detector")
    exclude_mask: Several[words.Mask] = _unwanted("mask")
    exclude_model: Several[words.Model] = _unwanted("model")
    exclude_extractor: Several[words.Extractor] = _unwanted("extractor")
    # No more than directions, a full turn, 11 days, a tonne, a kilowatt.
    max_error_deg: Number = Field(
        None,
        gt=0,
        le=180,
        description="Maximum RMS error, degrees: reported (converted to RMS), or measured over "
        "the required field of view and conditions.",
    )
    min_fov_deg: Number = Field(None, gt=0, le=360, description="Minimum full field of view.")
    max_latency_us: Number = Field(
        None,
        gt=0,
        le=1e12,
        description="Maximum time of extraction and prediction per sample, microseconds.",
    )
    min_availability: Number = Field(None, gt=0, le=1, description="Minimum availability.")
    max_mass_g: Number = Field(None, gt=0, le=1e6, description="Maximum mass, grams.")
    max_power_mw: Number = Field(None, gt=0, le=1e6, description="Maximum power, mW.")
    min_rate_hz: Number = Field(None, gt=0, le=1e9, description="Minimum rate, Hz.")
    tolerate: Several[words.Hazard] = several(
        "Conditions to tolerate: a data set must test each, with sufficient "
        "availability and within the maximum error."
    )
    sun_distance_au: Number = Field(
        None,
        ge=0.05,
        le=100,
        description="Distance from the Sun, astronomical units; judged by the nearest condition.",
    )
    properties: Several[words.Property] = several("Required extractor properties.")
    exclude_needs: Several[words.Need] = several("Inputs that it must not need.")
    bench_deg: Number = Field(
        None,
        ge=0,
        le=180,
        description="Error of your calibration bench, degrees. Without it limits are judged on "
        "own errors, and the answer says which bench they take.",
    )
    confidence: Number = Field(
        None,
        ge=0.5,
        le=0.999,
        description="Share of sensor units and benches that must meet the maximum error; default "
        "0.9.",
    )
    processor: Annotated[
        str | None, Field(min_length=1, max_length=60), GIVEN, WithJsonSchema(form())
    ] = Field(
        None,
        description=f"Your processor: {', '.join(processors())}; or its time relative to the "
        "reference.",
    )
    evidence: Annotated[str | None, OneOf(lambda: EVIDENCE), GIVEN] = Field(
        None, description="Evidence that must meet all requirements; default any of the two kinds."
    )
    level: Annotated[str | None, OneOf(lambda: LEVELS), GIVEN] = Field(
        None,
        description="Error that limits are judged by: flight (calibrated on the ground once, then "
        "flown), the default, or own (what sensor and method achieve).",
    )
    sort: Sort = Field(
        "evidence",
        description="Order. evidence: by evidence, then error or the measure of the task. error: "
        "by error. studies: by number of studies and products. What nobody built is always last.",
    )
    include: Annotated[Several[Included], BeforeValidator(_split)] = several(
        "More of the answer: calibrations of each architecture, paths of the studies, designs (all "
        "calibrations as flat rows)."
    )
    limit: Annotated[int, WHOLE] = Field(10, ge=1, le=LARGEST_PAGE, description="Most per page.")
    cursor: Cursor = None
    calibrations: Annotated[int, WHOLE] = Field(
        5, ge=1, le=LARGEST_PAGE, description="Maximum number of calibrations per architecture."
    )


class RequirementsQuery(Requirements, TableQuestion):
    """Requirements in a query."""

    model_config = ConfigDict(
        defer_build=False,
        json_schema_extra={"examples": [{"detector": ["CMOS"], "max_error_deg": 0.01, "limit": 1}]},
    )


class RequirementsBody(Requirements, strict=True):
    """Requirements in a request body."""

    model_config = ConfigDict(
        defer_build=False,
        json_schema_extra={
            "examples": [{"mask": ["Encoded"], "exclude_detector": ["CCD"], "limit": 1}]
        },
    )
