"""The survey's tables as facts are made from them: frames or texts, read row by row alike."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Protocol

from survey_data.texts import Rows

if TYPE_CHECKING:
    import pandas as pd


class Tables(Protocol):
    """The tables read here, as `survey_data.load` gives them, or `load_texts`."""

    @property
    def studies(self) -> pd.DataFrame | Rows:
        """One row a study."""
        ...

    @property
    def attributes(self) -> pd.DataFrame | Rows:
        """One row a value."""
        ...

    @property
    def taxonomy(self) -> pd.DataFrame | Rows:
        """One row a value of the vocabulary."""
        ...

    @property
    def model_families(self) -> pd.DataFrame | Rows:
        """One row a model: whether it is calibrated on the ground or in operation."""
        ...

    @property
    def roles(self) -> pd.DataFrame | Rows:
        """One row a method of a study that it proposed or only compared."""
        ...

    @property
    def architectures(self) -> pd.DataFrame | Rows:
        """One row a sensor of a study whose detectors and masks do not all go together."""
        ...

    @property
    def defaults(self) -> pd.DataFrame | Rows:
        """One row a rule of what stands in an empty cell."""
        ...

    @property
    def purposes(self) -> pd.DataFrame | Rows:
        """One row a rule of what studies are run for."""
        ...

    @property
    def compensated_models(self) -> pd.DataFrame | Rows:
        """One row a model that a compensation of a study belongs to."""
        ...

    @property
    def method_variants(self) -> pd.DataFrame | Rows:
        """One row a model of a study whose way to carry it out is known."""
        ...

    @property
    def advice(self) -> pd.DataFrame | Rows:
        """One row a sensor or calibration that the survey's text advises."""
        ...

    @property
    def feature_assessment(self) -> pd.DataFrame | Rows:
        """One row a mark of an extractor for a property."""
        ...

    @property
    def aliases(self) -> pd.DataFrame | Rows:
        """One row another name of a value."""
        ...


def rows_of(frame: pd.DataFrame | Rows) -> Iterable[Mapping[str, str]]:
    """Rows as text; an empty cell is ""."""
    if isinstance(frame, Sequence):
        yield from frame
        return
    filled = frame.astype(object).where(frame.notna(), "")
    columns = [str(column) for column in filled.columns]
    for row in filled.itertuples(index=False, name=None):
        yield {column: str(cell) for column, cell in zip(columns, row, strict=True)}
