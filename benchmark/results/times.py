"""Published running times: multiples of a reference loop, and the machine they were measured on.

They stand beside the record and are no part of its digests: a time stays until it is measured again
(`sunatlas leaderboard times`). A pipeline without a row is not timed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from pydantic import BaseModel, Field, PositiveFloat

from benchmark.results.csv_tables import StoreError, above_zero, read_csv, word
from files.reading import FileRefusedError, read_json, require_type

#: Names of the files.
TIMES, MACHINE = "times.csv", "times_machine.json"

Place = tuple[str, str, str]  # (dataset, extractor, model)

#: Columns of the table. `ratio`: time of extraction and prediction of one sample of a batch over
#: that of the reference loop. `extract_ratio`: time of extraction over that of one weighted sum of
#: the same observations. Both are empty where the pipeline cannot be run.
COLUMNS = {
    "dataset": word,
    "extractor": word,
    "model": word,
    "ratio": above_zero,
    "extract_ratio": above_zero,
}


@dataclass(frozen=True)
class Time:
    """Times of one pipeline under its data set's first condition, as `COLUMNS`."""

    dataset: str
    extractor: str
    model: str
    ratio: float | None
    extract_ratio: float | None

    @property
    def pipeline(self) -> Place:
        """The pipeline that was timed."""
        return self.dataset, self.extractor, self.model


class Machine(BaseModel, frozen=True, extra="forbid"):
    """The machine, measured first on `date`, on which the reference loop takes `loop_us`.

    Other rows were measured on the processors `also_on`.
    """

    processor: str
    cores: int
    python: str
    numpy: str
    date: str
    loop: str
    loop_us: PositiveFloat
    also_on: list[str] = Field(default_factory=list)


@dataclass(frozen=True)
class Times:
    """Times by pipeline; of nothing timed there is no machine."""

    rows: Mapping[Place, Time] = field(default_factory=dict)
    machine: Machine | None = None

    @cached_property
    def latency_us(self) -> Mapping[Place, float | None]:
        """Time of a sample on the machine in microseconds, by pipeline; None if it cannot run."""
        loop_us = self.machine.loop_us if self.machine else 0.0
        return {
            place: None if time.ratio is None else float(f"{time.ratio * loop_us:.3g}")
            for place, time in self.rows.items()
        }

    def columns_of(self, dataset: str, extractor: str, model: str) -> dict[str, float | None]:
        """Return the columns of a score row; None for what is not timed."""
        place = (dataset, extractor, model)
        ratio = self.rows[place].ratio if place in self.rows else None
        return {"latency_us": self.latency_us.get(place), "time_ratio": ratio}


def read_times(directory: Path) -> Times:
    """Read the times beside a record; none where there is no file.

    StoreError for a line that is no time, a pipeline that is there twice, or times without a
    machine.
    """
    rows: dict[Place, Time] = {}
    for line, row in read_csv(directory / TIMES, COLUMNS):
        time = Time(**row)
        if time.pipeline in rows:
            raise StoreError(f"{directory / TIMES}, line {line}: {time.pipeline} is there twice")
        rows[time.pipeline] = time
    return Times(rows, _machine(directory / MACHINE)) if rows else Times()


def _machine(path: Path) -> Machine:
    try:
        held = read_json(path)
        require_type(held, Machine, path)
    except (FileNotFoundError, FileRefusedError) as error:
        raise StoreError(str(error)) from error
    return Machine(**held)
