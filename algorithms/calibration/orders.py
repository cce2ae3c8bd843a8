"""The order of a regression, chosen from the calibration samples by what was left out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.calibration.blocks import EQUAL, splits
from algorithms.calibration.conditioning import WORST_CONDITION
from algorithms.contract import Floats, UnusableDataError


@dataclass(frozen=True)
class Choice:
    """An order, and the error it left on samples left out.

    Attributes
    ----------
    order : int
        Place in the sequence of nested designs, from 0.
    rms : float
        Root mean square of the errors on samples left out, in the target's unit.
    """

    order: int
    rms: float


def errors_of_orders(
    design: Floats, sizes: list[int], wanted: Floats, fold: NDArray[np.int64], between: Floats
) -> Floats:
    """Mean of squared errors that each order is expected to leave all over the field.

    Errors on samples left out, over all folds, are those at poses. Where a field has hardly more
    poses than a polynomial has degrees, it swings between them, most in the outermost cells, and
    no pose tells. So an order's error is raised by as much as random errors of the samples would
    come out larger between the poses of the whole fit than where samples were left out.

    Parameters
    ----------
    design : ndarray, shape (n, terms)
        Terms of the largest order, those of each smaller order first.
    sizes : list of int
        Columns of each order, increasing.
    wanted : ndarray, shape (n, T)
        What is fitted.
    fold : ndarray of int, shape (n,)
        By which each sample is left out (`algorithms.calibration.blocks`).
    between : ndarray, shape (m, terms)
        The same terms between the poses (`algorithms.calibration.blocks.between_poses`).

    Returns
    -------
    ndarray, shape (orders,)
        Targets added; infinite where a fold does not determine an order.

    Notes
    -----
    One factorisation a fold serves every order: with ``design = Q R``, an order's coefficients
    are those of the first columns of R, and its errors on what was left out follow from them. So
    do the variances ``|R^-T t|^2`` of its values at terms t, for errors of size one.
    """
    total, open_to_noise, count = np.zeros(len(sizes)), np.zeros(len(sizes)), 0
    for fitted, left_out in splits(fold):
        asked, missed = design[left_out], wanted[left_out]
        count += len(asked)
        q, r, usable = _factor(design[fitted], sizes)
        error = np.full(len(sizes), np.inf)
        if usable:
            aim = q.T @ wanted[fitted]
            open_to_noise[:usable] += _variances(r, asked, sizes[:usable])
        for number, size in enumerate(sizes[:usable]):
            fit = np.linalg.solve(r[:size, :size], aim[:size])
            off = asked[:, :size] @ fit - missed
            error[number] = float((off**2).sum())
        total += error
    error, left = total / max(count, 1), open_to_noise / max(count, 1)
    _, r, usable = _factor(design, sizes)
    error[usable:] = np.inf
    if usable and len(between):
        swing = _variances(r, between, sizes[:usable]) / len(between)
        error[:usable] *= np.maximum((1.0 + swing) / (1.0 + left[:usable]), 1.0)
    return error


def _factor(design: Floats, sizes: list[int]) -> tuple[Floats, Floats, int]:
    """Q and R of a design (n, terms), and how many of the orders its samples settle."""
    most = max((size for size in sizes if size <= len(design)), default=0)
    q, r = np.linalg.qr(design[:, :most])
    diagonal = np.abs(np.diag(r))
    usable = 0
    for size in sizes:
        # a column that those before it nearly span: this order and all after are open
        if size > most or not diagonal[:size].min() * WORST_CONDITION > diagonal[:size].max():
            break
        usable += 1
    return q, r, usable


def _variances(r: Floats, design: Floats, sizes: list[int]) -> Floats:
    """Sum, over the rows of a design (m, terms), of each order's variance there (orders,)."""
    from scipy.linalg import solve_triangular  # noqa: PLC0415 - SciPy, at the first fit only

    most = sizes[-1]
    terms = solve_triangular(r[:most, :most].T, design[:, :most].T, lower=True)
    return np.asarray(np.cumsum((terms**2).sum(axis=1))[np.array(sizes) - 1])


def choose_order(errors: Floats, by: str) -> Choice:
    """Return the order with the smallest mean of squared errors; the smaller of equals.

    Equal is what differs by less than 1e-6, relative: rounding does not choose an order.

    Parameters
    ----------
    errors : ndarray, shape (orders,)
        As `errors_of_orders` gives them, of one axis or added over both.
    by : str
        Whose order it is, for the message.

    Raises
    ------
    UnusableDataError
        If the samples do not determine even the smallest order.
    """
    if not np.isfinite(errors).any():
        raise UnusableDataError(
            f"{by} needs more samples at different features: those given do not settle the "
            "smallest order when some are left out to compare orders"
        )
    order = int(np.argmax(errors <= np.nanmin(errors) * (1.0 + EQUAL)))
    return Choice(order, float(np.sqrt(errors[order])))
