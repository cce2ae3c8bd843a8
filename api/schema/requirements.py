"""Requirements on a sensor and its calibration, in a query or a body."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import ConfigDict, Field

from api.schema import words
from api.schema.base import OfEdition, TableQuestion
from api.schema.parameters import LARGEST_PAGE, NUMBER, WHOLE, Several, several
from registry.ranking import Sort


def _wanted(attribute: str) -> Any:
    return several(f"Require one of these values of {attribute}.")


def _unwanted(attribute: str) -> Any:
    return several(f"Exclude these values of {attribute}.")


Number = Annotated[float | None, NUMBER]


class Requirements(OfEdition):
    """Requirements on a sensor and its calibration."""

    model_config = ConfigDict(defer_build=True)  # the command line reads the fields alone

    task: Several[words.Task] = _wanted("task")
    error: Several[words.Error] = _wanted("error")
    accuracy: Several[words.Accuracy] = _wanted("accuracy")
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
    # No more than directions, a full turn, and 11 days.
    max_error_deg: Number = Field(
        None,
        gt=0,
        le=180,
        description=(
            "Maximum RMS error, degrees, over the required field of view and conditions. "
            "Measured; if not measured, the stated accuracy converted to RMS."
        ),
    )
    min_fov_deg: Number = Field(
        None,
        gt=0,
        le=360,
        description="Minimum full field of view, degrees. Measured; if not measured, stated.",
    )
    max_latency_us: Number = Field(
        None,
        gt=0,
        le=1e12,
        description="Maximum time of extraction and prediction per sample, microseconds.",
    )
    min_availability: Number = Field(
        None,
        gt=0,
        le=1,
        description="Minimum availability, nominal and under all required conditions.",
    )
    survive: Several[words.Hazard] = several(
        "Conditions to tolerate: a data set must test each, with sufficient "
        "availability and within the maximum error."
    )
    properties: Several[words.Property] = several(
        "Required extractor properties, at least partly provided in the survey's assessment."
    )
    exclude_needs: Several[words.Need] = several(
        "Exclude calibrations that need one of these inputs."
    )
    bench_deg: Number = Field(
        None,
        ge=0,
        le=180,
        description=(
            "Calibration-bench error, degrees; by default that of each data set's "
            "standard bench; 0 for own errors."
        ),
    )
    confidence: Number = Field(
        None,
        ge=0.5,
        le=0.999,
        description=(
            "Share of sensor units and benches that must meet the maximum error; default 0.9."
        ),
    )
    sort: Sort = Field(
        "advice",
        description=(
            "Ranking. advice: advised or used in studies first, then by the measure of "
            "the tasks or by error. support: by number of studies. measured: by error."
        ),
    )
    limit: Annotated[int, WHOLE] = Field(
        20,
        ge=1,
        le=LARGEST_PAGE,
        description="Maximum number of architectures; `count`, paths, nodes and links cover all.",
    )
    calibrations: Annotated[int, WHOLE] = Field(
        5, ge=1, le=LARGEST_PAGE, description="Maximum number of calibrations per architecture."
    )


class RequirementsQuery(Requirements, TableQuestion):
    """Requirements in a query."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "task": ["Accuracy"],
                    "detector": ["CMOS"],
                    "mask": ["Single-Ap."],
                    "limit": 1,
                    "calibrations": 1,
                }
            ]
        }
    )


class RequirementsBody(Requirements, strict=True):
    """Requirements in a request body."""

    model_config = ConfigDict(
        defer_build=False,
        json_schema_extra={
            "examples": [
                {
                    "task": ["Accuracy"],
                    "mask": ["Encoded"],
                    "exclude_detector": ["CCD"],
                    "limit": 1,
                    "calibrations": 1,
                }
            ]
        },
    )
