"""A fitted chain of two features as a bicubic table with its hull, for flight software."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from algorithms.angles import separation_deg
from algorithms.calibration.hull import Hull
from algorithms.contract import Floats, Model
from api.calibrate.selection import unbounded

#: Nodes an axis that are tried, the fewest first.
_SIZES = (9, 13, 17, 25, 33, 49, 65)
#: Largest error, degrees, that the table may add; the last size is taken where none is as good.
WANTED_DEG = 1e-3
#: Most sides of a hull in flight software; those that cut off least go.
_MOST_SIDES = 48


class NoTableError(ValueError):
    """A chain that no table of two features can stand for; the message says why."""


@dataclass(frozen=True)
class FlightTable:
    """Direction cosines on a grid of features, read by a cubic convolution of 4 x 4 nodes.

    Attributes
    ----------
    low, step : tuple of two float
        First node and distance of nodes along each feature.
    nodes : ndarray, shape (rows, columns, 2)
        s_x and s_y; rows go with the second feature.
    sides : ndarray, shape (m, 3)
        Of the hull: a point is inside where ``a x + b y + c <= 0`` for every side.
    added_deg : float
        RMS error that the table adds to the chain's, over the hull.
    largest_deg : float
        The largest of it.
    """

    low: tuple[float, float]
    step: tuple[float, float]
    nodes: Floats
    sides: Floats
    added_deg: float
    largest_deg: float

    @property
    def words(self) -> str:
        """Name what this is, for a report."""
        return f"a table of {self.nodes.shape[0]} by {self.nodes.shape[1]} nodes"

    def predict(self, features: Floats) -> Floats:
        """Return unit vectors (N, 3); NaN rows outside the hull."""
        place = (features - np.asarray(self.low)) / np.asarray(self.step)
        rows, columns = self.nodes.shape[:2]
        corner = np.floor(np.nan_to_num(place)).astype(np.int64)
        corner[:, 0] = np.clip(corner[:, 0], 1, columns - 3)
        corner[:, 1] = np.clip(corner[:, 1], 1, rows - 3)
        wx = _weights(place[:, 0] - corner[:, 0])
        wy = _weights(place[:, 1] - corner[:, 1])
        cosines = np.zeros((len(features), 2))
        for j in range(4):
            row = np.zeros((len(features), 2))
            for i in range(4):
                row += wx[:, [i]] * self.nodes[corner[:, 1] + j - 1, corner[:, 0] + i - 1]
            cosines += wy[:, [j]] * row
        square = (cosines**2).sum(axis=1)
        sun = np.column_stack([cosines, np.sqrt(np.maximum(1.0 - square, 0.0))])
        outside = (features @ self.sides[:, :2].T + self.sides[:, 2]).max(axis=1) > 0.0
        sun[outside | ~np.isfinite(features).all(axis=1) | (square >= 1.0)] = np.nan
        return sun


def flight_table(model: Model, features: Floats, context: Mapping[str, Floats]) -> FlightTable:
    """Return the smallest table that adds less than a thousandth of a degree to a fitted chain.

    Parameters
    ----------
    model : Model
        Fitted; of two features and no context.
    features : ndarray, shape (N, 2)
        Of the calibration.
    context : mapping
        Must be empty: a table knows no temperature.

    Raises
    ------
    NoTableError
        If the chain reads other than two features, or a context.
    """
    if features.shape[1] != 2:
        raise NoTableError(
            f"flight code is written for sensors of two features; this one has {features.shape[1]}"
        )
    if tuple(model.about.context):
        raise NoTableError(f"code for flight knows no {', '.join(model.about.context)}")
    hull = Hull.around(features, "table")
    sides = _fewest(np.column_stack([hull.facets[:, :2], hull.facets[:, 2] - hull.margin]))
    low, high = features.min(axis=0) - hull.margin, features.max(axis=0) + hull.margin
    open_model = unbounded(model)
    checked = _inside(low, high, sides, 60)
    exact = open_model.predict(checked, context)
    known = np.isfinite(exact).all(axis=1)
    if not known.any():
        raise NoTableError("the chain answers nowhere inside its hull")
    best = None
    for size in _SIZES:
        table = _of_size(open_model, low, high, sides, size)
        off = separation_deg(table.predict(checked[known]), exact[known])
        off = off[np.isfinite(off)]
        best = replace(
            table, added_deg=float(np.sqrt(np.mean(off**2))), largest_deg=float(off.max())
        )
        if best.largest_deg <= WANTED_DEG:
            break
    assert best is not None  # noqa: S101 - sizes are never none
    return best


def _of_size(model: Any, low: Floats, high: Floats, sides: Floats, size: int) -> FlightTable:
    step = (high - low) / (size - 3)
    first = low - step  # one node more on each side, which the cubic reads
    x = first[0] + step[0] * np.arange(size)
    y = first[1] + step[1] * np.arange(size)
    grid = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    sun = model.predict(grid, {})
    cosines = _filled(grid, sun[:, :2]).reshape(size, size, 2)
    return FlightTable(
        (float(x[0]), float(y[0])), (float(step[0]), float(step[1])), cosines, sides, 0.0, 0.0
    )


def _filled(grid: Floats, cosines: Floats) -> Floats:
    """Nodes that have no answer get the value of the plane through the nearest that have one."""
    from scipy.spatial import cKDTree  # noqa: PLC0415 - SciPy, at the first use

    known = np.isfinite(cosines).all(axis=1)
    if known.all():
        return cosines
    near = np.asarray(cKDTree(grid[known]).query(grid[~known], k=min(6, int(known.sum())))[1])
    filled = cosines.copy()
    for at, neighbours in zip(np.flatnonzero(~known), near, strict=True):
        places, values = grid[known][neighbours], cosines[known][neighbours]
        plane = np.linalg.lstsq(
            np.column_stack([np.ones(len(places)), places - grid[at]]), values, rcond=1e-8
        )[0]
        filled[at] = np.clip(plane[0], -1.0, 1.0)
    return filled


def _weights(t: Floats) -> Floats:
    """Weights (N, 4) of Keys' cubic convolution at a fraction of a step."""
    return np.column_stack(
        [
            ((-0.5 * t + 1.0) * t - 0.5) * t,
            (1.5 * t - 2.5) * t * t + 1.0,
            ((-1.5 * t + 2.0) * t + 0.5) * t,
            (0.5 * t - 0.5) * t * t,
        ]
    )


def _inside(low: Floats, high: Floats, sides: Floats, size: int) -> Floats:
    x, y = (np.linspace(low[k], high[k], size + 1 + k) for k in (0, 1))
    grid = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    inside = (grid @ sides[:, :2].T + sides[:, 2]).max(axis=1) <= 0.0
    return np.asarray(grid[inside])


def _fewest(sides: Floats) -> Floats:
    """Return at most 48 sides: evenly by direction."""
    order = np.argsort(np.arctan2(sides[:, 1], sides[:, 0]))
    ordered = sides[order]
    if len(ordered) <= _MOST_SIDES:
        return ordered
    return np.asarray(ordered[np.linspace(0, len(ordered) - 1, _MOST_SIDES).round().astype(int)])
