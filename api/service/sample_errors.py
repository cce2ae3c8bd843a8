"""Errors sample by sample, as rows of a table."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from api.schema.samples import SampleError, SampleErrorsQuery
from api.schema.table import columns_of
from api.service.measurements import Measurements

if TYPE_CHECKING:
    import pandas as pd

#: Digits that a column has, at most: those of float32, of an error those that are kept.
_DIGITS = {"error_deg": 4, "bound_deg": 5, "sun_x": 7, "sun_y": 7, "sun_z": 7}


def choose(measured: Measurements, dataset: str, query: SampleErrorsQuery) -> pd.DataFrame:
    """Return the errors of a data set that a query asks for; no rows where none are published."""
    found = measured.sample_errors(dataset)
    for name in ("extractor", "model"):
        if wanted := getattr(query, name):
            found = found[found[name].isin(wanted)]
    return found if query.unit is None else found[found["unit"] == query.unit]


def rows_of(errors: pd.DataFrame) -> list[dict[str, Any]]:
    """Return errors as rows of `SampleError`, None for NaN."""
    names = columns_of(SampleError)
    columns = [
        [_format_value(value, _DIGITS.get(name)) for value in errors[name].tolist()]
        for name in names
    ]
    return [dict(zip(names, row, strict=True)) for row in zip(*columns, strict=True)]


def _format_value(value: Any, digits: int | None) -> Any:
    if digits is None:
        return value
    return None if value != value else float(f"{value:.{digits}g}")  # noqa: PLR0124 - NaN
