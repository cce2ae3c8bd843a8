"""The survey's figures as one specification each: a table, sentences, and what Plotly draws.

In a notebook, `flow("error").show()` shows one. Filters keep the studies with one of the values:
`flow("error", detector="CMOS")`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from api.figures.figure import Figure

Values = str | Sequence[str]


def flow(name: str = "cross-analysis", **filters: Values) -> Figure:
    """Return a Sankey diagram of the survey.

    Parameters
    ----------
    name : error, performance, task, cross-analysis or aggregate
    filters : attribute or level -> values that a study must have one of

    Raises
    ------
    InvalidValueError
        For a name, a level or a value that is not known, naming those that are.
    """
    return _figure(name, filters)


def models(**filters: Values) -> Figure:
    """Return the sunburst of calibration models; filters as for `flow`."""
    return _figure("models", filters)


def publications(**filters: Values) -> Figure:
    """Return the publications per year and venue; filters as for `flow`."""
    return _figure("publications", filters)


def coordinates(**filters: Values) -> Figure:
    """Return the sensors of studies in parallel coordinates; filters as for `flow`."""
    return _figure("coordinates", filters)


def matrix(rows: str = "detector", columns: str = "mask", **filters: Values) -> Figure:
    """Return studies by two attributes; what is measured here is left out.

    Parameters
    ----------
    rows, columns : attributes or levels
    filters : as for `flow`
    """
    from api.figures.catalogue import evidence_map  # noqa: PLC0415 - loads every figure
    from registry.studies import facts  # noqa: PLC0415 - likewise

    return evidence_map(facts(), filters, rows, columns)


def _figure(name: str, filters: dict[str, Values]) -> Figure:
    from api.figures.catalogue import figure  # noqa: PLC0415 - loads every figure
    from registry.studies import facts  # noqa: PLC0415 - likewise

    return figure(name, facts(), filters)
