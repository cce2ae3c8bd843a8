"""Whether a design's spots are those of all its apertures, so that lists of them have an order."""

from __future__ import annotations

from algorithms.design import SensorGeometry, UnsuitableDesignError
from algorithms.spot_lists import list_length


def require_seen_at_once(geometry: SensorGeometry, by: str) -> None:
    """Raise UnsuitableDesignError for a mask larger than its detector, which lists do not order."""
    try:
        list_length(geometry, by)
    except UnsuitableDesignError:
        return
    raise UnsuitableDesignError(
        f"{by} reads masks whose apertures are all seen at once; this one is larger than its "
        "detector"
    )
