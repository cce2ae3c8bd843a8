"""The survey's tables as facts are made from them: frames or texts, read row by row alike."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from survey_data.texts import Rows

if TYPE_CHECKING:
    import pandas as pd

Tables: TypeAlias = Any
"""What has a table an attribute, as `survey_data.load` gives them, or `load_texts`."""


def rows_of(frame: pd.DataFrame | Rows) -> Iterable[Mapping[str, str]]:
    """Rows as text; an empty cell is ""."""
    if isinstance(frame, Sequence):
        yield from frame
        return
    filled = frame.astype(object).where(frame.notna(), "")
    columns = [str(column) for column in filled.columns]
    for row in filled.itertuples(index=False, name=None):
        yield {column: str(cell) for column, cell in zip(columns, row, strict=True)}
