"""Processors that a running time can be asked for, without pandas: `factor`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType

from survey_data.descriptor import DATA_DIRECTORY, column_types, file_name
from survey_data.nearest import nearest_name
from survey_data.problems import SurveyDataError
from survey_data.table_records import read_records

_TABLE = "processors"
#: The machine of the published running times.
REFERENCE = "reference"


@dataclass(frozen=True)
class Processor:
    """One processor; its columns are those of ``processors.csv``."""

    name: str
    description: str
    coremark: float
    basis: str
    source: str

    @property
    def factor(self) -> float:
        """Time of scalar work relative to the reference, two digits: an estimate."""
        return float(f"{processors()[REFERENCE].coremark / self.coremark:.2g}")


def form() -> dict[str, object]:
    """Return the JSON Schema of a processor: a name, or a factor above 0 in plain digits."""
    names = "|".join(processors())
    number = r"[1-9]\d{0,5}(\.\d{1,6})?|0\.\d{0,5}[1-9]"
    pattern = f"^({names}|{number})$"
    return {"type": "string", "minLength": 1, "maxLength": 60, "pattern": pattern}


class UnknownProcessorError(ValueError):
    """A processor that is not known; names the known ones and the nearest."""


@cache
def processors() -> Mapping[str, Processor]:
    """Return the processors by name.

    Raises
    ------
    SurveyDataError
        The table is missing or broken.
    """
    columns = list(column_types(_TABLE))
    records = read_records(DATA_DIRECTORY / file_name(_TABLE), columns)
    if records.problems:
        raise SurveyDataError(tuple(records.problems))
    rows = (dict(zip(columns, cells, strict=True)) for _, cells in records.rows)
    return MappingProxyType(
        {
            row["name"]: Processor(
                row["name"],
                row["description"],
                float(row["coremark"]),
                row["basis"],
                row["source"],
            )
            for row in rows
        }
    )


def factor(processor: str | float | None) -> float:
    """Return by what a time on the reference machine is multiplied to be of a processor.

    Parameters
    ----------
    processor
        A name of `processors`, or the factor itself, as a number or as text; None for the
        reference machine.

    Raises
    ------
    UnknownProcessorError
        For an unknown name, and for a number that is not above 0 and finite.
    """
    if is_processor(processor):
        return _factor(processor)
    nearest = nearest_name(str(processor), processors())
    hint = f"; did you mean {nearest!r}?" if nearest else ""
    raise UnknownProcessorError(
        f"processor {processor!r}: expected one of {', '.join(processors())}, or a number above 0"
        f"{hint}"
    )


def is_processor(processor: str | float | None) -> bool:
    """Whether `factor` knows it."""
    return 0.0 < _factor(processor) < math.inf


def _factor(processor: str | float | None) -> float:
    if processor is None:
        return 1.0
    if isinstance(processor, str) and (known := processors().get(processor.strip().casefold())):
        return known.factor
    try:
        return float(processor)
    except ValueError:
        return math.nan
