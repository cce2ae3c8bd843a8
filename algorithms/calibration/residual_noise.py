"""How large the errors of a least-squares fit's parameters are, where two noises make residuals."""

from __future__ import annotations

import numpy as np

from algorithms.contract import Floats

#: Degrees of freedom below which residuals do not tell two noises apart.
_FEWEST = 20
#: Of the weights of squared residuals, which need the noises' own sizes.
_ROUNDS = 10


def parameter_covariance(derivatives: Floats, residuals: Floats, moved: Floats) -> Floats:
    """(P, P) covariance of fitted parameters, poses and features being noisy each in its way.

    A turntable errs alike in all poses. Noise of a feature is an angle that depends on where the
    Sun is: behind a pinhole, 60 deg off, a pixel is a quarter of one on the boresight. Residuals
    have the covariance ``C = p^2 + f^2 G G'`` then, block by block, and the parameters of a fit
    that weighs all alike ``(J'J)^-1 J' C J (J'J)^-1``; p and f are found from the residuals'
    squares.

    Parameters
    ----------
    derivatives : ndarray, shape (n, K, P)
        J, of the residuals by the parameters.
    residuals : ndarray, shape (n, K)
        Of the fit.
    moved : ndarray, shape (n, K, F)
        G, of the residuals by the features, whose noise is alike.

    Returns
    -------
    ndarray, shape (P, P)
        Of a single noise, alike in all residuals, where fewer than 20 degrees of freedom are left.

    Examples
    --------
    >>> line = np.linspace(-1.0, 1.0, 200)
    >>> design = np.stack([np.ones(200), line], axis=1)[:, None, :]
    >>> loud = (1.0 - line**2)[:, None, None]  # at the ends there is hardly noise
    >>> off = loud[:, :, 0] * np.random.default_rng(1).normal(size=(200, 1))
    >>> deviations = np.sqrt(np.diag(parameter_covariance(design, off, loud)))
    >>> alike = np.sqrt(np.diag(parameter_covariance(design, off, np.zeros_like(loud))))
    >>> bool(deviations[1] < 0.75 * alike[1])
    True
    """
    n, each, count = derivatives.shape
    flat = derivatives.reshape(n * each, count)
    lengths = np.linalg.norm(flat, axis=0)
    flat = flat / lengths
    inverse = np.linalg.inv(flat.T @ flat)
    freedom = max(n * each - count, 1)
    size = float((residuals**2).sum()) / freedom
    even = inverse * size
    scale = float((moved**2).sum()) / (n * each)
    if freedom >= _FEWEST and size > 0 and scale > 0 and np.isfinite(scale):
        blocks = flat.reshape(n, each, count)
        alike = np.broadcast_to(np.eye(each), (n, each, each))
        along = np.einsum("nif,njf->nij", moved, moved) / scale
        leverage = np.einsum("nip,pq,njq->nij", blocks, inverse, blocks)
        noises, expected = [], []
        for noise in (alike, along):
            information = np.einsum("nip,nij,njq->pq", blocks, noise, blocks)
            around = inverse @ information @ inverse
            kept = np.einsum("nip,pq,niq->ni", blocks, around, blocks)
            own = np.einsum("nii->ni", noise)
            lost = np.einsum("nij,nji->ni", leverage, noise)
            noises.append(around)
            expected.append((own - 2.0 * lost + kept).ravel())
        p, f = _sizes(np.stack(expected, axis=1), residuals.ravel() ** 2 / size)
        even = size * (p * noises[0] + f * noises[1])
    return np.asarray(even / np.outer(lengths, lengths))


def _sizes(expected: Floats, squares: Floats) -> tuple[float, float]:
    """Two variances, none negative, that explain squares (m,) by what each is expected to give.

    A square of normal noise scatters as its own mean does, which weighs it.
    """
    found = np.array([1.0, 0.0])
    for _ in range(_ROUNDS):
        weight = 1.0 / np.maximum(expected @ found, 1e-6) ** 2
        normal = (expected * weight[:, None]).T @ expected
        right = (expected * weight[:, None]).T @ squares
        alone = np.maximum(right / np.diag(normal), 0.0)
        single = [np.array([alone[0], 0.0]), np.array([0.0, alone[1]])]
        determinant = normal[0, 0] * normal[1, 1] - normal[0, 1] ** 2
        if determinant > 1e-9 * normal[0, 0] * normal[1, 1]:
            both = np.linalg.solve(normal, right)
            if both.min() >= 0:
                found = both
                continue
        # the better one alone: the larger share of the squares that it explains
        gains = [float(right @ one) for one in single]
        found = single[int(np.argmax(gains))]
    return float(found[0]), float(found[1])
