"""The region a model was calibrated on: a convex hull of features, or of directions."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats, UnusableDataError

#: Slices of a polygon in which most points are seen to be inside at a glance.
_SLICES = 512
#: Most of a direction's distance to the facet of a cone that rounding makes.
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Hull:
    """A convex region with a margin around it.

    Parameters
    ----------
    facets : ndarray, shape (m, d + 1)
        Outward unit normal and offset of each side; none: everything is inside.
    margin : float
        How far outside still counts as inside, in the points' unit.
    reach : tuple of two float
        Smallest and largest first coordinate of the points.

    Examples
    --------
    >>> square = Hull.around(np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0], [4.0, 4.0]]), "test")
    >>> square.margin  # half a step to the next pose
    2.0
    >>> square.holds(np.array([[3.9, 5.9], [3.9, 6.1], [np.nan, 1.0]]))
    array([ True, False, False])
    """

    facets: Floats
    margin: float = 0.0
    reach: tuple[float, float] = (0.0, 0.0)

    @classmethod
    def around(cls, points: Floats, by: str, beyond: float = 0.0) -> Hull:
        """Hull of points (n, 2) as far as halfway to where the next one would be.

        Parameters
        ----------
        points : ndarray, shape (n, 2)
            Features of a calibration.
        by : str
            Whose they are, for the message.
        beyond : float
            Margin beside the half step, as a share of the hull's half width; may be infinite.

        Raises
        ------
        UnusableDataError
            If the points lie on one line.
        """
        from scipy.spatial import ConvexHull, QhullError  # noqa: PLC0415 - SciPy, at the first fit

        places = np.unique(points, axis=0)
        try:
            found = ConvexHull(places)
        except (QhullError, ValueError) as error:
            raise UnusableDataError(
                f"{by} needs calibration samples that spread over both features; "
                "those given lie on one line"
            ) from error
        width = float(np.sqrt(found.volume / np.pi))
        extra = beyond * width if beyond else 0.0
        return cls(
            np.asarray(found.equations, dtype=np.float64),
            median_spacing(places) / 2.0 + extra,
            (float(places[0, 0]), float(places[-1, 0])),
        )

    @classmethod
    def of_directions(cls, sun: Floats, by: str, beyond: float = 0.0) -> Hull:
        """Cone of directions (n, 3), all of them where they surround the sensor.

        Parameters
        ----------
        sun : ndarray, shape (n, 3)
            Unit vectors of a calibration.
        by : str
            Whose they are, for the message.
        beyond : float
            Margin beside half the step from pose to pose, in radians; may be infinite.

        Raises
        ------
        UnusableDataError
            If the directions lie in one plane through the sensor.
        """
        from scipy.spatial import ConvexHull, QhullError  # noqa: PLC0415 - SciPy, at the first fit

        places = np.unique(sun, axis=0)
        try:
            found = ConvexHull(np.vstack([np.zeros(3), places]))
        except (QhullError, ValueError) as error:
            raise UnusableDataError(
                f"{by} needs calibration directions that spread both ways; "
                "those given lie in one plane"
            ) from error
        facets = np.asarray(found.equations, dtype=np.float64)
        through_sensor = np.abs(facets[:, 3]) < _ROUNDING
        return cls(facets[through_sensor], median_spacing(places) / 2.0 + beyond)

    def holds(self, points: Floats) -> NDArray[np.bool_]:
        """Whether each point (n, d) is inside or within the margin; False for NaN."""
        if len(self.facets) == 0 or np.isinf(self.margin):
            return np.asarray(np.isfinite(points[:, 0]))
        if points.shape[1] != 2 or len(points) < _SLICES:
            return np.asarray(self.outside(points) <= self.margin)
        middle, half = self._box
        if all(
            middle[k] - half[k] <= points[:, k].min() and points[:, k].max() <= middle[k] + half[k]
            for k in (0, 1)
        ):
            return np.ones(len(points), dtype=np.bool_)
        from algorithms.calibration.hull_kernel import in_region  # noqa: PLC0415 - Numba

        low, high, start, slices_a_unit = self._slices
        slices = (low, high, start - 1.0 / slices_a_unit, slices_a_unit)
        inside = np.empty(len(points), dtype=np.bool_)
        in_region(points[:, 0], points[:, 1], slices, (self.facets, float(self.margin)), inside)
        return inside

    def outside(self, points: Floats) -> Floats:
        """Distance (n,) of points (n, d) past the farthest side; negative inside."""
        farthest = np.full(len(points), -np.inf)
        for normal in self.facets:
            past = np.full(len(points), normal[-1])
            for column, weight in zip(points.T, normal[:-1], strict=True):
                past += weight * column
            np.maximum(farthest, past, out=farthest)
        return farthest

    @cached_property
    def _box(self) -> tuple[Floats, Floats]:
        """Middle and half widths of an upright box that is inside, margin and all.

        As large as one of the region's own proportions can be; of a turntable's grid nearly all.
        """
        low, high, _, _ = self._slices
        filled = low <= high
        y = (float(low[filled].min()), float(high[filled].max())) if filled.any() else (0.0, 0.0)
        ends = np.array([self.reach, y])
        middle, half = ends.mean(axis=1), (ends[:, 1] - ends[:, 0]) / 2.0
        normals = self.facets[:, :2]
        room = self.margin - self.facets[:, 2] - normals @ middle
        share = float((room / (np.abs(normals) @ half)).min()) - _ROUNDING
        return middle, half * max(share, -1.0)

    @cached_property
    def _slices(self) -> tuple[Floats, Floats, float, float]:
        """Of each slice of x, a lowest and highest y between which all of it is inside.

        The region is convex: what is inside at both edges of a slice is inside in all of it. A
        slice before the first and one after the last hold nothing for certain.
        """
        x, y, offset = self.facets.T
        edges = np.linspace(*self.reach, _SLICES + 1)
        bound = self.margin - offset - x * edges[:, None]
        down, up = y < -_ROUNDING, y > _ROUNDING
        lowest = (bound[:, down] / y[down]).max(axis=1)
        highest = (bound[:, up] / y[up]).min(axis=1)
        low = np.pad(np.maximum(lowest[:-1], lowest[1:]), 1, constant_values=np.inf)
        high = np.pad(np.minimum(highest[:-1], highest[1:]), 1, constant_values=-np.inf)
        return low, high, float(edges[0]), float(1.0 / (edges[1] - edges[0]))


def median_spacing(points: Floats) -> float:
    """Median distance of points (n, d), all different, to their nearest neighbours."""
    from scipy.spatial import KDTree  # noqa: PLC0415 - SciPy, at the first fit only

    nearest = np.asarray(KDTree(points).query(points, k=2)[0])
    return float(np.median(nearest[:, 1]))
