"""One regression an axis, both of the same order: given, or chosen from the samples."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from algorithms.calibration.blocks import between_poses, folds_along
from algorithms.calibration.orders import choose_order, errors_of_orders
from algorithms.contract import Floats, UnusableDataError
from algorithms.models.non_physical.regression_axes import (
    Target,
    feature_scaling,
    in_degrees,
    solve_regression,
    target_from_sun,
)

#: Range of one angle, over the other's, below which only one axis was swept.
_ONE_AXIS = 1e-3
#: Of each axis of the target, (alpha, beta), the feature that it is fitted to, (x, y).
AXES = ((0, 1), (1, 0))


@dataclass(frozen=True)
class AxisFit:
    """Coefficients of both axes.

    Attributes
    ----------
    middle, half_range : ndarray, shape (2,)
        Scaling of the features onto [-1, 1].
    coefficients : ndarray, shape (2, terms)
        Rows alpha (on y) and beta (on x).
    whitening : ndarray, shape (2, terms, terms)
        ``R^-1`` of each axis' design ``Q R``: rows of terms times it have the squared length that
        their value's variance is, for errors of size one.
    validated_deg : float or None
        Error on samples left out, where they chose the order.
    """

    middle: Floats
    half_range: Floats
    coefficients: Floats
    whitening: Floats
    validated_deg: float | None


def fit_axes(
    terms: Callable[[Floats, int], Floats],
    sizes: Sequence[int],
    features: Floats,
    sun: Floats,
    *,
    target: Target,
    by: str,
) -> AxisFit:
    """Fit both axes by least squares, with the size that samples left out prefer.

    Parameters
    ----------
    terms : callable
        Design (n, size) of a scaled feature (n,) and a size; a smaller one's terms come first.
    sizes : sequence of int
        Numbers of terms to choose from, increasing; one leaves no choice.
    features : ndarray, shape (n, 2)
        ``(x, y)``.
    sun : ndarray, shape (n, 3)
        Unit vectors.
    target : {"angle", "tangent"}
        What is fitted.
    by : str
        Whose fit it is, for messages.

    Raises
    ------
    UnusableDataError
        If the samples do not determine the terms, or do not spread along an axis.
    """
    middle, half = feature_scaling(features, by)
    scaled = (features - middle) / half
    wanted = target_from_sun(sun, target)
    _require_both_axes(wanted, by)
    size, validated = sizes[0], None
    if len(sizes) > 1:
        middles = (between_poses(sun, features) - middle) / half
        errors = [
            errors_of_orders(
                terms(scaled[:, column], sizes[-1]),
                list(sizes),
                wanted[:, [axis]],
                folds_along(scaled[:, column]),
                terms(middles[:, column], sizes[-1]),
            )
            for axis, column in AXES
        ]
        choice = choose_order(errors[0] + errors[1], by)
        size, validated = sizes[choice.order], in_degrees(choice.rms, target)
    coefficients, whitening = np.empty((2, size)), np.empty((2, size, size))
    for axis, column in AXES:
        design = terms(scaled[:, column], size)
        coefficients[axis] = solve_regression(design, wanted[:, axis], by)
        whitening[axis] = np.linalg.inv(np.linalg.qr(design, mode="r"))
    return AxisFit(middle, half, coefficients, whitening, validated)


def _require_both_axes(wanted: Floats, by: str) -> None:
    """Raise UnusableDataError where the light moved along one axis alone."""
    ranges = np.ptp(wanted, axis=0)
    if not ranges.min() > _ONE_AXIS * ranges.max():
        raise UnusableDataError(
            f"{by} fits each Sun angle: the light moved along one axis alone; sweep the other too"
        )
