"""A study beside the Atlas: its own method here, the best method there, and the bound there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from benchmark.metrics.score import is_available

if TYPE_CHECKING:
    from api.service.measurements import Measurements

_RUNG = ("extractor", "model", "own_error_deg", "availability")


def ladder(own: Mapping[str, Any] | None, measurements: Measurements) -> dict[str, Any] | None:
    """Return the rungs below a study's reported figure, on one data set and condition.

    `own`: score of the study's own method, with `dataset` and `condition`; None for none.

    Returns
    -------
    dict or None
        ``dataset``, ``condition``, ``nominal`` (whether that is the data set's first condition,
        under which own errors are over all units), ``own`` and ``best`` (names, own error and
        availability), ``bound_deg`` with the unit known and ``bound_unit_deg`` with the unit known
        by its darks and flats. None where the study's method has no error.
    """
    if own is None:
        return None
    dataset, condition = own["dataset"], own["condition"]
    scored = (
        row
        for (name, at, *_), row in measurements.score_of.items()
        if (name, at) == (dataset, condition) and row["own_error_deg"] is not None
    )
    best = min(
        scored,
        key=lambda row: (
            not is_available(row),
            row["own_error_deg"],
            row["extractor"],
            row["model"],
        ),
    )
    pin = measurements.pins.get((dataset, condition, "test"))
    return {
        "dataset": dataset,
        "condition": condition,
        "nominal": condition == measurements.preset(dataset).conditions[0],
        "own": {name: own[name] for name in _RUNG},
        "best": {name: best[name] for name in _RUNG},
        "bound_deg": measurements.bounds(dataset).get(condition),
        "bound_unit_deg": pin and pin.bound_unit_deg,
    }
