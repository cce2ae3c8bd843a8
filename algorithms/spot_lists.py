"""Lists of spots as features: the columns, and how long a list a design asks for."""

from __future__ import annotations

import numpy as np

from algorithms.contract import Floats
from algorithms.design import SensorGeometry, UnsuitableDesignError

#: Columns of one spot: x px, y px, and its light; a spot without light is none.
SPOT_COLUMNS = 3
#: Spots kept, over those that the fullest view of a design shows: stray lights may add to them.
_ROOM = 1.25
_MORE = 4


def spot_columns(spots: int) -> tuple[str, ...]:
    """Names of the columns of a list of so many spots.

    Examples
    --------
    >>> spot_columns(2)
    ('x_0_px', 'y_0_px', 'light_0', 'x_1_px', 'y_1_px', 'light_1')
    """
    return tuple(name for n in range(spots) for name in (f"x_{n}_px", f"y_{n}_px", f"light_{n}"))


def detector_size_px(geometry: SensorGeometry, by: str) -> tuple[float, float]:
    """Width and height of a detector whose middle the boresight meets, px.

    Raises
    ------
    UnsuitableDesignError
        Where the design does not say where the boresight meets it.
    """
    geometry.require("centre_px", by=by)
    x, y = geometry.centre_px or (0.0, 0.0)
    return 2.0 * x + 1.0, 2.0 * y + 1.0


def list_length(geometry: SensorGeometry, by: str) -> int:
    """Length of the lists for a mask that is larger than its detector.

    Parameters
    ----------
    geometry : SensorGeometry
        With ``apertures``, ``pixel_pitch_mm`` and ``centre_px``.
    by : str
        Whose lists they are, for the message.

    Returns
    -------
    int
        A quarter more than the fullest view shows, and four.

    Raises
    ------
    UnsuitableDesignError
        Where the detector shows the whole mask at once, so that one place says all.
    """
    geometry.require("apertures", "pixel_pitch_mm", by=by)
    size = np.array(detector_size_px(geometry, by))
    places = np.array(geometry.apertures)[:, :2] / (geometry.pixel_pitch_mm or 1.0)
    if not (np.ptp(places, axis=0) > size).all():
        raise UnsuitableDesignError(
            f"{by} reads masks larger than their detector; this one's {len(places)} apertures are "
            f"seen at once by {size[0]:g} x {size[1]:g} px"
        )
    return int(_ROOM * _fullest(places, size)) + _MORE


def _fullest(places: Floats, size: Floats) -> int:
    """Most places (A, 2) in a window of this size that is centred on one of them."""
    half = size / 2.0
    near = [
        np.abs(column[:, None] - column) <= reach
        for column, reach in zip(places.T, half, strict=True)
    ]
    return int((near[0] & near[1]).sum(axis=1).max())
