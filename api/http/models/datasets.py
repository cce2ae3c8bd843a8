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
    """Card of a standard data set."""

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
        description="The nearest built `sensors` with their published figures, or why it is an "
        "`idealisation`."
    )
    setups: dict[str, dict[str, Any]] = Field(description="What each condition is.")
    preview: str = Field(description="Where its picture is served.")


class RealismQuery(TableQuestion):
    """Which data sets."""

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"dataset": ["qpd-single-aperture"]}]}
    )

    dataset: Several[DatasetName] = several("Only this data set.")


class BuiltSensor(Shape):
    """Published figures of a built sensor, and ours over them. Null where not known."""

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
        description="Accuracy as a root mean square: three sigma and largest errors over three."
    )
    our_rms_deg: float | None = Field(description="Our error, over its field where narrower.")
    accuracy_ratio: float | None = Field(description="Our error over its accuracy.")
    precision_ratio: float | None = Field(description="Our repeatability over its precision.")


class RealismRow(Shape):
    """A data set beside the built sensors that it stands for."""

    dataset: str
    idealisation: str | None = Field(description="Why it stands for none; null where it does.")
    extractor: str | None = Field(description="Of the best pipeline on the nominal condition.")
    model: str | None
    rms_deg: float | None
    bound_deg: float | None = Field(description="Cramer-Rao bound, over the data set's field.")
    repeatability_deg: float | None
    half_fov_deg: float | None
    accuracy_ratio: float | None = Field(
        description="1 within the range of the sensors' figures, else that of the nearest."
    )
    precision_ratio: float | None
    sentence: str | None = Field(description="What explains a difference.")
    unexplained: bool = Field(description="Beyond a factor of two without a sentence.")
    sensors: list[BuiltSensor]


class Realism(Shape):
    """Data sets beside built sensors."""

    datasets: list[RealismRow]


class Data(Shape):
    """The published data of a split in a condition; null where none are pinned."""

    condition: str
    split: str
    samples: int
    data_hash: str | None
    bound_deg: float | None = Field(description="Cramer-Rao bound, rms over the test split.")


class DatasetDetail(Dataset):
    """Card of a standard data set, with every parameter that its numbers depend on."""

    geometry: dict[str, Any]
    regime: dict[str, Any]
    seeds: dict[str, Any]
    data: list[Data]


class Datasets(Listing):
    """A page of standard data sets."""

    items: list[Dataset]
