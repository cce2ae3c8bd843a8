"""Standard data sets."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from api.schema.base import OpenShape, Shape, SortedQuestion, TableQuestion, example, page_of
from api.schema.parameters import Several, several
from api.schema.table import AS_TEXT
from api.schema.words import DatasetName


class SplitSize(OpenShape):
    """Size of a split."""

    samples: int


class Splits(OpenShape):
    """Splits of a data set."""

    calibration: SplitSize = Field(description="Known directions, to calibrate with.")
    test: SplitSize = Field(description="Directions that are scored.")
    repeat: SplitSize = Field(description="Poses measured several times, for repeatability.")


class StandsFor(OpenShape):
    """Built sensors that a data set models, or the reason for an idealisation."""

    idealisation: str | None = Field(description="Reason for an idealised sensor, if any.")
    sensors: Annotated[list[dict[str, Any]], AS_TEXT]


class Dataset(OpenShape):
    """Summary of a data set."""

    name: str
    version: int
    detector: str
    mask: str
    observation: str = Field(description="Kind of readings: frames, profiles, currents or events.")
    conditions: list[str]
    units: str
    bounds: dict[str, float] = Field(description="Cramer-Rao bound by condition, rms, degrees.")
    description: str
    follows: list[str] = Field(description="Studies that the sensor is based on.")
    represents: StandsFor = Field(description="Built sensors, or reason for an idealisation.")
    splits: Splits = Field(description="Samples of each split.")
    preview: str = Field(description="Address of its picture.")
    setups: dict[str, dict[str, Any]] = Field(description="Descriptions of the conditions.")


class RealismQuery(TableQuestion):
    """Which data sets."""

    model_config = example(dataset=["qpd-single-aperture"])

    dataset: Several[DatasetName] = several("Only this data set.")


class BestOnDataset(Shape):
    """The best pipeline on a data set under nominal conditions."""

    dataset: str
    extractor: str | None = Field(description="Extractor of the best nominal pipeline.")
    model: str | None
    half_fov_deg: float | None
    rms_deg: float | None = Field(description="Unit 0 RMS of that pipeline.")
    bound_deg: float | None = Field(description="Cramer-Rao bound over the field of the data set.")
    repeatability_deg: float | None


class PublishedFigures(Shape):
    """Published figures of a built sensor, compared with ours."""

    id: str
    name: str
    fov_full_deg: float | None = Field(description="Full field of view.")
    accuracy_deg: float | None = Field(description="As claimed.")
    accuracy_kind: str | None
    accuracy_rms_deg: float | None = Field(description="Accuracy converted to RMS by its kind.")
    precision_deg: float | None
    basis: str = Field(description="page: seen on a public page; recalled: not checked.")
    our_rms_deg: float | None = Field(description="Our unit 0 RMS on the standard bench.")
    accuracy_ratio: float | None = Field(description="`our_rms_deg` divided by its accuracy.")
    precision_ratio: float | None = Field(description="Our repeatability divided by its precision.")


class Source(Shape):
    """Where a figure was read."""

    source: str = Field(description="Address, document, study or label of the survey's source.")
    source_name: str = Field(description="Publisher, document or part of the survey.")


class Explanation(Shape):
    """Whether a difference is explained, and how."""

    explanation: str | None = Field(description="Why it differs, or is an idealisation.")
    unexplained: bool = Field(description="Whether more than a factor of 2 is unexplained.")


# Members of a class stand behind those of the classes named after it.
class BuiltSensor(Source, PublishedFigures):
    """Published figures of a built sensor, compared with ours. Null if unknown."""


class BuiltSensorRow(Source, Explanation, PublishedFigures, BestOnDataset):
    """A data set and a built sensor: a row of the table."""


class RealismRow(BestOnDataset):
    """A data set compared with built sensors."""

    idealisation: str | None = Field(description="Reason for an idealised sensor, if any.")
    accuracy_ratio: float | None = Field(description="Ratio to the nearest published figure.")
    precision_ratio: float | None = Field(description="Repeatability over published precision.")
    sentence: str | None = Field(description="Explanation of a difference.")
    unexplained: bool = Field(description="Whether more than a factor of 2 is unexplained.")
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

    geometry: dict[str, Any] = Field(description="Dimensions and positions of the sensor's parts.")
    regime: dict[str, Any] = Field(description="geometry or diffraction, whichever dominates.")
    seeds: dict[str, Any] = Field(description="Seeds of the random numbers, by purpose.")
    data: list[Data] = Field(description="Splits of the data set under each condition.")


class DatasetsQuery(SortedQuestion, rows=Dataset):
    """Which page of the data sets."""

    model_config = example(limit=1)


class SoldSensor(Shape):
    """A built sensor simulated as it is sold: a row of the table."""

    hardware: str = Field(description="Id in the table of built sensors.")
    name: str
    detector: str
    mask: str
    depth: Literal["uncalibrated", "constants", "table"] = Field(
        description="Depth of calibration."
    )
    depth_basis: Literal["stated", "family", "assumed"] = Field(
        description="Who says so: its row, another row of its family, or nobody."
    )
    bench: Literal["standard", "fine"] | None = Field(
        description="Calibration bench of 0.016 or 0.001 deg; null if uncalibrated."
    )
    level: Literal["ground", "flight"] = Field(description="Where it is tested.")
    statistic: str = Field(description="Statistic of all errors in the row.")
    stated_deg: float = Field(description="Published accuracy.")
    simulated_deg: float | None = Field(description="The same statistic, simulated.")
    ratio: float | None = Field(description="Simulated over published.")
    agrees: bool | None = Field(description="Whether the ratio is within a factor of 2.")
    reason: str = Field(description="Which other runs agree, if it does not.")
    dataset: str
    half_fov_deg: float | None
    constants: str = Field(description="Pipeline with constants of a physical model.")
    table: str = Field(description="Most accurate pipeline of any kind.")
    uncalibrated_deg: float | None = Field(description="Error with the constants of the design.")
    constants_standard_deg: float | None = Field(description="With constants, standard bench.")
    constants_fine_deg: float | None = Field(description="With constants, fine bench.")
    constants_true_deg: float | None = Field(description="With constants, true directions.")
    table_standard_deg: float | None = Field(description="With a table, standard bench.")
    table_fine_deg: float | None = Field(description="With a table, fine bench.")
    table_true_deg: float | None = Field(description="With a table, true directions.")
    other_level_deg: float | None = Field(description="In flight, or on the ground if flown.")
    without_earth_deg: float | None = Field(description="In flight, without light of the Earth.")


class LeftOutSensor(Shape):
    """A built sensor that is not simulated."""

    hardware: str = Field(description="Id in the table of built sensors.")
    reason: str = Field(description="Why it is not simulated.")


class SoldSensors(Shape):
    """Built sensors simulated as they are sold, beside their published accuracy."""

    words: str = Field(description="How many agree.")
    items: list[SoldSensor]
    left_out: list[LeftOutSensor] = Field(description="Built sensors that are not simulated.")


Datasets = page_of(Dataset, "Datasets", "A page of standard data sets.")
