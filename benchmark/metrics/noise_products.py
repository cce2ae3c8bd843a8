"""Scalar products of changes of a signal, over the inverse covariance of its noise."""

from __future__ import annotations

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.readout.column_noise import CommonNoise


def noise_products(
    mean: Floats, signals: Floats, variance: Floats, common: CommonNoise | None = None
) -> Floats:
    """Return ``d_i^T C^-1 d_j`` of all changes ``d_i`` of a signal from its mean.

    The covariance of a sample is ``C = D + c^2 sum_g e_g e_g^T``: D diagonal, c the common
    deviation and ``e_g`` 1 on the elements of a group, 0 elsewhere. Groups have no element in
    common, so that Woodbury's identity is one term a group:
    ``C^-1 = D^-1 - sum_g c^2 / (1 + c^2 e_g^T D^-1 e_g) D^-1 e_g e_g^T D^-1``.

    Parameters
    ----------
    mean
        (N, M) of N samples.
    signals
        (K, N, M) what it changes to.
    variance
        (N, M) of the elements' own noise; inf for elements that tell nothing.
    common
        Noise that elements share; None for none.

    Returns
    -------
    (N, K, K).
    """
    from benchmark.metrics.noise_products_kernel import products  # noqa: PLC0415 - Numba on demand

    out = np.empty((mean.shape[0], len(signals), len(signals)))
    groups, columns, deviation = np.zeros((0, 0), dtype=np.int64), 0, 0.0
    if common is not None:
        deviation = common.deviation
        if isinstance(common.group, int):
            columns = common.group
        else:
            groups = np.ascontiguousarray(np.atleast_2d(common.group), dtype=np.int64)
            columns = int(groups.max()) + 1
    products(
        out,
        np.ascontiguousarray(mean),
        np.ascontiguousarray(signals),
        np.ascontiguousarray(1.0 / variance),
        (groups, columns, deviation),
    )
    return out
