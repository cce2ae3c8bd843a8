"""Processors that a running time can be asked for, without pandas: `factor`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType

from survey_data.nearest import nearest_name
from survey_data.texts import load_texts

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
    """Return the processors by name; SurveyDataError where the table cannot be read."""
    rows = load_texts(("processors",)).processors
    return MappingProxyType(
        {row["name"]: Processor(**{**row, "coremark": float(row["coremark"])}) for row in rows}
    )


def factor(processor: str | float | None) -> float:
    """Return by what a time on the reference machine is multiplied to be of a processor.

    That is a name of `processors`, or the factor itself, as a number or as text; None for the
    reference machine. UnknownProcessorError for any other.
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
