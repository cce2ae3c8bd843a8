"""Standard data sets."""

from __future__ import annotations

from typing import Any

from pydantic import ConfigDict, Field

from api.http.models.base import Listing, OpenShape, Question, Shape
from api.http.models.parameters import DEFAULT_PAGE, Cursor, Limit


class DatasetsQuery(Question):
    """Which page of the data sets."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"limit": 1}]})

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
    setups: dict[str, dict[str, Any]] = Field(description="What each condition is.")
    preview: str = Field(description="Where its picture is served.")


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
