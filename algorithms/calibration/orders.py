"""The order of a regression, chosen from the calibration samples by what was left out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.calibration.blocks import splits
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
    design: Floats, sizes: list[int], wanted: Floats, fold: NDArray[np.int64]
) -> Floats:
    """Mean of squared errors of each order on samples left out, over all folds.

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

    Returns
    -------
    ndarray, shape (orders,)
        Over samples left out, targets added; infinite where a fold does not settle an order.

    Notes
    -----
    One factorisation a fold serves every order: with ``design = Q R``, an order's coefficients
    are those of the first columns of R, and its errors on what was left out follow from them.
    """
    total, count = np.zeros(len(sizes)), 0
    for fitted, left_out in splits(fold):
        count += int(left_out.sum())
        usable = [size for size in sizes if size <= int(fitted.sum())]
        error = np.full(len(sizes), np.inf)
        if usable:
            q, r = np.linalg.qr(design[fitted][:, : usable[-1]])
            aim = q.T @ wanted[fitted]
            diagonal = np.abs(np.diag(r))
            for number, size in enumerate(usable):
                # a column that those before it nearly span: this order and all after are open
                if not diagonal[:size].min() * WORST_CONDITION > diagonal[:size].max():
                    break
                fit = np.linalg.solve(r[:size, :size], aim[:size])
                off = design[left_out][:, :size] @ fit - wanted[left_out]
                error[number] = float((off**2).sum())
        total += error
    return total / max(count, 1)


def chosen(errors: Floats, by: str) -> Choice:
    """Return the order with the smallest mean of squared errors; the smaller of equals.

    Parameters
    ----------
    errors : ndarray, shape (orders,)
        As `errors_of_orders` gives them, of one axis or added over both.
    by : str
        Whose order it is, for the message.

    Raises
    ------
    UnusableDataError
        If the samples do not settle even the smallest order.
    """
    if not np.isfinite(errors).any():
        raise UnusableDataError(
            f"{by} needs more samples at different features: those given do not settle the "
            "smallest order when some are left out to compare orders"
        )
    order = int(np.argmin(errors))
    return Choice(order, float(np.sqrt(errors[order])))
