"""Settings chosen from the calibration samples: blocked cross-validation, the same every time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from algorithms.calibration.hull import Hull
from algorithms.contract import Floats, UnusableDataError

Candidate = TypeVar("Candidate")

FOLDS = 5

EQUAL = 1e-6
"""Relative difference of two errors below which the setting that comes first is taken."""

#: Most blocks of neighbouring poses that are dealt out to the folds.
_BLOCKS = 500
#: Poses are distinguished to this many digits, far fewer than those that rounding reaches: a digit
#: that it turned would bring neighbours into another order.
_POSE_DIGITS = 6
#: Squared distances are equal that differ by less: those of a grid are, up to rounding.
_ALIKE = 1e-9
#: Places along an axis are distinguished to this many digits of a slice.
_DIGITS = 9
#: Poses around one on a grid.
_NEIGHBOURS = 8


def folds(sun: Floats, count: int = FOLDS) -> NDArray[np.int64]:
    """Fold (n,) of each calibration sample, 0 to count - 1; -1 on the rim, which all fits keep.

    Repeats of a pose are left out together, and of more than 500 poses neighbours too: every
    `count`-th block of them is one fold's, so that all folds spread over the field. Blocks no
    larger than that: a fit with a hole in it is judged by more than it will be asked for. So it is
    by poses on the rim, to which it would have to be continued, as no fit is asked to; they are
    left out only where there are hardly others.

    Parameters
    ----------
    sun : ndarray, shape (n, 3)
        Unit vectors.
    count : int
        Of folds, at least 2.

    Examples
    --------
    >>> turns = np.radians(np.arange(0.0, 60.0, 4.0))
    >>> arc = np.column_stack([np.sin(turns), np.zeros(15), np.cos(turns)])
    >>> np.bincount(folds(np.repeat(arc, 2, axis=0)))  # each pose taken twice
    array([6, 6, 6, 6, 6])
    """
    poses = np.round(sun, _POSE_DIGITS)
    return _folds(poses.tobytes(), count).copy()


# every model that chooses a setting asks for those of the same calibration
@lru_cache(maxsize=16)
def _folds(poses: bytes, count: int) -> NDArray[np.int64]:
    """Return `folds` of rounded directions (n, 3), by their bytes."""
    rounded = np.frombuffer(poses, dtype=np.float64).reshape(-1, 3)
    places, inverse = np.unique(rounded, axis=0, return_inverse=True)
    rim = _rim(places)
    if (~rim).sum() < 2 * count:
        rim[:] = False
    fold = np.full(len(places), -1)
    fold[~rim] = _blocks(places[~rim]) % count
    return np.asarray(fold[inverse.reshape(-1)])


def _blocks(places: Floats) -> NDArray[np.int64]:
    """Block (n,) of each pose (n, 3), each around the pose farthest from those before it."""
    middle = places.mean(axis=0)
    nearest = ((places - middle) ** 2).sum(axis=1)
    chosen = int(np.argmax(nearest < nearest.min() + _ALIKE))
    distance = np.full(len(places), np.inf)
    block = np.zeros(len(places), dtype=np.int64)
    for number in range(min(_BLOCKS, len(places))):
        away = ((places - places[chosen]) ** 2).sum(axis=1)
        closer = away < distance - _ALIKE
        block[closer], distance[closer] = number, away[closer]
        chosen = int(np.argmax(distance > distance.max() - _ALIKE))
    return block


def _rim(places: Floats) -> NDArray[np.bool_]:
    """Which directions (n, 3) lie on the border of the cone of all of them; none where it has none.

    A line of poses has no cone, and poses all around the sensor have no border.
    """
    try:
        cone = Hull.of_directions(places, "folds")
    except UnusableDataError:
        return np.zeros(len(places), dtype=np.bool_)
    # the margin is half a step: what lies deeper is in the next row
    return np.asarray(cone.outside(places) > -cone.margin)


def folds_along(values: Floats, count: int = FOLDS) -> NDArray[np.int64]:
    """Fold (n,) of each sample by one coordinate alone; -1 at both ends, which all fits keep.

    What is fitted along one axis learns nothing new from a sample beside another at the same
    place: poses of a turntable's grid share their columns. So whole slices are left out together,
    and none of those that a curve would have to be continued to.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Of the axis.
    count : int
        Of folds, at least 2.

    Examples
    --------
    >>> folds_along(np.repeat([0.0, 1.0, 2.0, 3.0, 4.0], 2), 3)
    array([-1, -1,  1,  1,  0,  0,  1,  1, -1, -1])
    """
    low, high = float(values.min()), float(values.max())
    slices = max(int(2.0 * np.sqrt(len(values))), 3)
    place = np.round((values - low) / (high - low) * slices, _DIGITS)
    number = np.minimum(place.astype(np.int64), slices - 1)
    fold = number % count
    fold[(number == 0) | (number == slices - 1)] = -1
    return np.asarray(fold)


def between_poses(sun: Floats, features: Floats) -> Floats:
    """Features (m, F) in the middle between neighbouring poses, 8 neighbours each.

    Parameters
    ----------
    sun : ndarray, shape (n, 3)
        Unit vectors.
    features : ndarray, shape (n, F)
        Of them; those of repeats of a pose are averaged.

    Examples
    --------
    >>> turns = np.radians([0.0, 2.0, 6.0])
    >>> arc = np.column_stack([np.sin(turns), np.zeros(3), np.cos(turns)])
    >>> between_poses(arc, np.array([[0.0], [1.0], [3.0]])).ravel()
    array([0.5, 1.5, 0.5, 2. , 2. , 1.5])
    """
    from scipy.spatial import cKDTree  # noqa: PLC0415 - SciPy, at the first fit only

    places, pose = np.unique(np.round(sun, _POSE_DIGITS), axis=0, return_inverse=True)
    pose = pose.reshape(-1)
    times = np.bincount(pose)
    found = np.stack([np.bincount(pose, column) / times for column in features.T], axis=1)
    count = min(_NEIGHBOURS, len(places) - 1)
    if count == 0:
        return np.empty((0, features.shape[1]))
    near = np.asarray(cKDTree(places).query(places, k=count + 1)[1])
    middles = (found[:, None, :] + found[near[:, 1:]]) / 2.0
    return np.asarray(middles.reshape(-1, features.shape[1]))


def splits(fold: NDArray[np.int64]) -> list[tuple[NDArray[np.bool_], NDArray[np.bool_]]]:
    """Which samples are fitted and which left out by each fold (n,), as masks (n,)."""
    found = []
    for number in range(int(fold.max(initial=0)) + 1):
        left_out = fold == number
        if left_out.any() and not left_out.all():
            found.append((~left_out, left_out))
    return found


def best_candidate(
    candidates: Sequence[Candidate], error: Callable[[Candidate], float], by: str
) -> tuple[Candidate, float]:
    """Return the candidate with the smallest error on what was left out, and that error.

    Parameters
    ----------
    candidates : sequence
        In the order of preference: of equals, to a relative 1e-6, the first is taken.
    error : callable
        Error of one; NaN, infinity or UnusableDataError where it cannot be fitted.
    by : str
        Whose they are, for the message.

    Raises
    ------
    UnusableDataError
        If no candidate can be fitted: what the last one said.

    Examples
    --------
    >>> best_candidate([1, 2, 3], lambda order: (order - 2.2) ** 2, "test")[0]
    2
    """
    found: list[tuple[float, int]] = []
    refusal: UnusableDataError | None = None
    for number, candidate in enumerate(candidates):
        try:
            size = error(candidate)
        except UnusableDataError as unusable:
            refusal = unusable
            continue
        if np.isfinite(size):
            found.append((size, number))
    if not found:
        raise refusal or UnusableDataError(
            f"{by} needs samples of several poses to choose its settings by leaving some out"
        )
    least = min(size for size, _ in found)
    size, number = next(one for one in found if one[0] <= least * (1.0 + EQUAL))
    return candidates[number], size
