"""Standard data sets."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import ConfigDict, Field

from api import columns
from api.http.models.base import Listing, OpenShape, Shape, TableQuestion
from api.http.models.parameters import (
    DEFAULT_PAGE,
    FIELDS,
    GIVEN,
    SORT,
    Cursor,
    Limit,
    Several,
    columns_of,
    several,
    sorting,
)
from api.http.models.words import DatasetName


class DatasetsQuery(TableQuestion):
    """Which page of the data sets."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"limit": 1}]})

    sort: Annotated[str | None, sorting(columns.DATASETS), GIVEN] = SORT
    fields: Several[Annotated[str, columns_of(columns.DATASETS)]] = FIELDS
    limit: Limit = DEFAULT_PAGE
    cursor: Cursor = None


class Dataset(OpenShape):
    """Summary of a data set."""

    name: str
    version: int
    detector: str
    mask: str
    observation: str
    conditions: list[str]
    description: str
    follows: list[str]
    units: str
    bounds: dict[str, float] = Field(description="Cramer-Rao bound by condition, rms, degrees.")
    splits: dict[str, dict[str, Any]]
    stands_for: dict[str, Any] = Field(
        description="Built `sensors` for comparison, or the reason for an `idealisation`."
    )
    setups: dict[str, dict[str, Any]] = Field(description="Descriptions of the conditions.")
    preview: str = Field(description="Address of its picture.")


class RealismQuery(TableQuestion):
    """Which data sets."""

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"dataset": ["qpd-single-aperture"]}]}
    )

    dataset: Several[DatasetName] = several("Only this data set.")


class BuiltSensor(Shape):
    """Published figures of a built sensor, compared with ours. Null if unknown."""

    id: str
    name: str
    fov_full_deg: float | None = Field(description="Full field of view.")
    accuracy_deg: float | None = Field(description="As claimed.")
    accuracy_kind: str | None
    precision_deg: float | None
    basis: str = Field(description="page: seen on a public page; recalled: not checked.")
    source: str = Field(description="Address, document, study or label of the survey's source.")
    source_name: str = Field(description="Publisher, document or part of the survey.")
    accuracy_rms_deg: float | None = Field(
        description="Accuracy converted to RMS: 3-sigma and maximum errors divided by three."
    )
    our_rms_deg: float | None = Field(
        description="Our RMS error, over its field of view if narrower."
    )
    accuracy_ratio: float | None = Field(description="Our error divided by its accuracy.")
    precision_ratio: float | None = Field(description="Our repeatability divided by its precision.")


class RealismRow(Shape):
    """A data set compared with built sensors."""

    dataset: str
    idealisation: str | None = Field(
        description="Reason for an idealised sensor; null if built sensors exist."
    )
    extractor: str | None = Field(
        description="Extractor of the best pipeline under nominal conditions."
    )
    model: str | None
    rms_deg: float | None
    bound_deg: float | None = Field(description="Cramer-Rao bound over the field of the data set.")
    repeatability_deg: float | None
    half_fov_deg: float | None
    accuracy_ratio: float | None = Field(
        description="1 within the range of the sensors' figures, else the ratio to the nearest."
    )
    precision_ratio: float | None
    sentence: str | None = Field(description="Explanation of a difference.")
    unexplained: bool = Field(
        description="Whether a difference of more than a factor of two is unexplained."
    )
    sensors: list[BuiltSensor]


class Realism(Shape):
    """Data sets compared with built sensors."""

    datasets: list[RealismRow]


class Data(Shape):
    """Published hash of a split under a condition; null if none."""

    condition: str
    split: str
    samples: int
    data_hash: str | None
    bound_deg: float | None = Field(description="RMS Cramer-Rao bound over the test split.")


class DatasetDetail(Dataset):
    """Description of a data set with all simulation parameters."""

    geometry: dict[str, Any]
    regime: dict[str, Any]
    seeds: dict[str, Any]
    data: list[Data]


class Datasets(Listing):
    """A page of standard data sets."""

    items: list[Dataset]
