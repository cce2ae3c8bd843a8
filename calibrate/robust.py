"""Regression that wrong poses do not spoil: features to directions, by Tukey's bisquare.

One mechanism ahead of every model: what no smooth function of the readings explains is listed and
left out before a model is chosen.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations_with_replacement

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats

#: Of the bisquare, in robust standard deviations: 95 % efficient for normal errors.
TUNING = 4.685
#: Residuals that count as wrong poses, in robust standard deviations.
WRONG = 6.0
_ROUNDS, _ROUNDS_ABSOLUTE = 60, 8
_NEIGHBOURS = 12
_MOST_WRONG = 0.25
#: Samples that a map is fitted to, and whose neighbours are held at once.
_MOST_MAPPED = 40_000
_MAD = 1.4826


@dataclass(frozen=True)
class SmoothMap:
    """A polynomial from features to Sun vectors."""

    middle: Floats  # (F,), what features are shifted by
    width: Floats  # (F,), and divided by
    degree: int
    coefficients: Floats  # (terms, 3), for each component

    def predict(self, features: Floats) -> Floats:
        """Return unit vectors (N, 3) of features (N, F)."""
        found = terms((features - self.middle) / self.width, self.degree) @ self.coefficients
        return np.asarray(found / np.linalg.norm(found, axis=1)[:, None])


def nearest(among: Floats, at: Floats, count: int) -> tuple[Floats, NDArray[np.int64]]:
    """Return distances and places (N, count) of those of points (M, D) that are nearest to (N, D).

    Without the last axis where the count is 1.
    """
    from scipy.spatial import cKDTree  # noqa: PLC0415 - SciPy, at the first use

    distance, place = cKDTree(among).query(at, k=count)
    return np.asarray(distance), np.asarray(place)


def terms(scaled: Floats, degree: int) -> Floats:
    """Return all products of features (N, F) up to a degree, (N, terms)."""
    columns = [np.ones(len(scaled))]
    for order in range(1, degree + 1):
        columns += [
            np.prod(scaled[:, list(chosen)], axis=1)
            for chosen in combinations_with_replacement(range(scaled.shape[1]), order)
        ]
    return np.column_stack(columns)


def degree_for(samples: int, features: int) -> int:
    """Return the largest degree with ten samples a term, from 1 to 5 (to 2 of many features)."""
    most = 5 if features == 2 else 2
    for degree in range(most, 1, -1):
        count = len(terms(np.zeros((1, features)), degree)[0])
        if samples >= 10 * count:
            return degree
    return 1


def normalised(features: Floats) -> Floats:
    """Return signals over their length where there are more than two: free of light's strength."""
    if features.shape[1] == 2:
        return features
    length = np.linalg.norm(features, axis=1)
    return np.asarray(features / np.where(length > 0, length, 1.0)[:, None])


def robust_map(
    features: Floats, sun: Floats, degree: int | None = None
) -> tuple[SmoothMap, Floats]:
    """Fit a polynomial from features to directions that a tenth of wrong poses does not move.

    Features (N, F) are finite, directions (N, 3) unit vectors; the degree is by default as high as
    the samples settle. Returns the map and the size (N,) of each sample's residual, degrees.
    """
    used = normalised(features)
    degree = degree_for(len(used), used.shape[1]) if degree is None else degree
    middle = np.median(used, axis=0)
    width = np.percentile(np.abs(used - middle), 95, axis=0)
    # a channel that hardly changes is no coordinate: its noise would outweigh the others
    width = np.maximum(width, max(1e-3 * float(width.max()), 1e-12))
    design = terms((used - middle) / width, degree)
    weight: Floats = np.ones(len(used))
    residual = np.zeros((len(used), 3))
    coefficients: Floats = np.zeros((design.shape[1], 3))
    for turn in range(_ROUNDS):
        root = np.sqrt(weight)[:, None]
        solved = np.linalg.lstsq(design * root, sun * root, rcond=1e-10)[0]
        coefficients = np.asarray(solved, dtype=np.float64)
        residual = sun - design @ coefficients
        size = np.linalg.norm(residual, axis=1)
        scale = max(_MAD * float(np.median(size)), 1e-12)
        # absolute values first, so that the start is near what most samples say
        wanted = np.asarray(
            scale / np.maximum(size, scale) if turn < 20 else bisquare(size / scale)
        )
        if turn > 20 and np.max(np.abs(wanted - weight)) < 1e-6:
            break
        weight = wanted
    return SmoothMap(middle, width, degree, coefficients), np.degrees(
        np.linalg.norm(residual, axis=1)
    )


def least_absolute(design: Floats, wanted: Floats) -> float:
    """Return the median size of what a fit by least absolute values leaves of values (N,).

    A quarter of wrong rows of the design (N, P) hardly moves it.
    """
    weight: Floats = np.ones(len(wanted))
    for _ in range(_ROUNDS_ABSOLUTE):
        root = np.sqrt(weight)
        fit = np.linalg.lstsq(design * root[:, None], wanted * root, rcond=1e-12)[0]
        size = np.abs(wanted - design @ fit)
        usual = float(np.median(size))
        weight = 1.0 / np.maximum(size, max(usual, 1e-300))
    return usual


def residuals(fitted: SmoothMap, features: Floats, sun: Floats) -> Floats:
    """Return what a map leaves (N, 3) of directions."""
    scaled = (normalised(features) - fitted.middle) / fitted.width
    return np.asarray(sun - terms(scaled, fitted.degree) @ fitted.coefficients)


def answer_noise_deg(features: Floats, sun: Floats) -> float:
    """Return the RMS noise of single answers, degrees: what nearest poses leave of a smooth map.

    The map errs alike on neighbours. The median of their differences is that of two normal errors.
    """
    left = residuals(robust_map(features, sun)[0], features, sun)
    near = nearest(sun, sun, 2)[1][:, 1]
    square = ((left - left[near]) ** 2).sum(axis=1)
    return float(np.degrees(np.sqrt(np.median(square) / (2.0 * np.log(2.0)))))


def bisquare(over_scale: Floats) -> Floats:
    """Return Tukey's weights of residuals over their scale."""
    share = np.minimum(np.abs(over_scale) / TUNING, 1.0)
    return np.asarray((1.0 - share**2) ** 2)


def wrong_poses(features: Floats, sun: Floats, least_deg: float = 0.0) -> NDArray[np.bool_]:
    """Return which samples (N,) no smooth function of the readings explains, at most a quarter.

    A polynomial does not follow a sensor everywhere: what it leaves is compared with what it leaves
    around, so that only samples that their neighbours contradict, by over six robust standard
    deviations, count. Features (N, F) are finite; departures below the bench's floor, `least_deg`,
    are never wrong poses.
    """
    step = max(-(-len(sun) // _MOST_MAPPED), 1)
    left = residuals(robust_map(features[::step], sun[::step])[0], features, sun)
    size = np.degrees(np.linalg.norm(left, axis=1))
    count = min(_NEIGHBOURS + 1, len(left))
    used = normalised(features)
    used = used / np.maximum(used.std(axis=0), 1e-12)
    near = nearest(used, used, count)[1][:, 1:]
    departure, locally = np.empty(len(left)), np.empty(len(left))
    for start in range(0, len(left), _MOST_MAPPED):  # what neighbours leave is large
        part = slice(start, start + _MOST_MAPPED)
        around = np.median(left[near[part]], axis=1)
        departure[part] = np.degrees(np.linalg.norm(left[part] - around, axis=1))
        # where neighbours differ among themselves, a sample may
        apart = np.linalg.norm(left[near[part]] - around[:, None], axis=2)
        locally[part] = 3.0 * np.median(np.degrees(apart), axis=1)
    usual = _MAD * np.median(departure)
    wrong = departure > np.maximum(WRONG * np.maximum(usual, locally / 2.0), max(least_deg, 1e-9))
    wrong &= size > np.maximum(WRONG * usual, least_deg)
    if wrong.mean() > _MOST_WRONG:
        return np.zeros(len(size), dtype=np.bool_)
    return np.asarray(wrong)
