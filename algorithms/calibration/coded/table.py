"""A coded mask made ready to be read: apertures by place, pairs of apertures by spacing."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from algorithms.calibration.coded.identity_kernel import Code, Indices
from algorithms.contract import Floats

#: A spacing has the errors of two spots.
_TWO = math.sqrt(2.0)


def code_of(
    places: Floats, widths: Floats, reach_px: float, tolerance_px: float, size_tolerance: float
) -> tuple[Code, Indices]:
    """Tables of a mask, and which aperture is which of theirs.

    Parameters
    ----------
    places : ndarray, shape (A, 2)
        Of the apertures, px from the mask's middle.
    widths : ndarray, shape (A,)
        Of the apertures, px.
    reach_px : float
        Largest spacing along an axis that is looked up.
    tolerance_px : float
        Largest distance of a spot from its place, an axis; below a quarter of the least distance
        of two apertures over the root of two.
    size_tolerance : float
        Largest relative error of a width that is estimated from a spot's light; infinity where
        sizes do not count.

    Returns
    -------
    code : Code
        As `algorithms.calibration.coded.identity_kernel` says.
    order : ndarray of int, shape (A,)
        The aperture that each place of the tables is.
    """
    return _code(
        np.ascontiguousarray(places, dtype=np.float64).tobytes(),
        np.ascontiguousarray(widths, dtype=np.float64).tobytes(),
        reach_px,
        tolerance_px,
        size_tolerance,
    )


@lru_cache(maxsize=8)
def _code(
    place_bytes: bytes, width_bytes: bytes, reach: float, tolerance: float, size: float
) -> tuple[Code, Indices]:
    places, widths = np.frombuffer(place_bytes).reshape(-1, 2), np.frombuffer(width_bytes)
    order = np.lexsort(places.T)
    places, widths = places[order], widths[order]
    apart = neighbours_px(places)[0]
    cell = min(apart, float(np.ptp(places, axis=0).max()) + 1.0) / _TWO - 2.0 * tolerance
    corner = places.min(axis=0) - tolerance - cell  # the rim's cells are empty
    rows, columns = (np.ceil((np.ptp(places, axis=0) + 2.0 * tolerance) / cell) + 1.0)[::-1]
    cells = np.full((int(rows) + 2, int(columns) + 2), -1, dtype=np.int64)
    for way in ((-1, -1), (-1, 1), (1, -1), (1, 1)):  # corners of a place's tolerance
        j, i = ((places + np.array(way) * tolerance - corner) * (1.0 / cell)).astype(np.int64).T
        cells[i, j] = np.arange(len(places))

    spacing = _TWO * tolerance
    side = int(2.0 * reach / spacing) + 3
    pairs = pairs_within(places, reach)
    steps = places[pairs[:, 1]] - places[pairs[:, 0]]
    j, i = ((steps + reach) / spacing).astype(np.int64).T + 1
    keys = i * side + j
    pairs, keys = pairs[np.argsort(keys, kind="stable")], np.sort(keys)
    starts = np.searchsorted(keys, np.arange(side * side + 3))
    known = np.column_stack([places, np.log(widths)])
    grid = np.array([*corner, 1.0 / cell, tolerance, size])
    table = np.array([reach, spacing, spacing, side], dtype=np.float64)
    code = (known, cells, grid, starts.astype(np.int64), pairs, table)
    for array in (*code, order):
        array.flags.writeable = False
    return code, order


def pairs_within(places: Floats, reach_px: float) -> Indices:
    """Ordered pairs (P, 2) of different places (A, 2) within `reach_px` along both axes."""
    from scipy.spatial import KDTree  # noqa: PLC0415

    found = KDTree(places).query_pairs(reach_px, p=math.inf, output_type="ndarray")
    found = np.asarray(found, dtype=np.int64).reshape(-1, 2)
    both = np.vstack([found, found[:, ::-1]])
    return both[np.lexsort(both.T[::-1])]


@lru_cache(maxsize=8)
def _neighbours(place_bytes: bytes) -> tuple[float, float]:
    from scipy.spatial import KDTree  # noqa: PLC0415

    places = np.frombuffer(place_bytes).reshape(-1, 2)
    nearest = np.asarray(KDTree(places).query(places, k=2)[0])[:, 1]
    return float(nearest.min()), float(nearest.max())


def neighbours_px(places: Floats) -> tuple[float, float]:
    """Least and largest distance of the places (A, 2) to their nearest neighbours."""
    return _neighbours(np.ascontiguousarray(places, dtype=np.float64).tobytes())
