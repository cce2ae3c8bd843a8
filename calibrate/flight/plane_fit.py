"""Polynomials and splines that follow a function of two features, and of the temperature."""

from __future__ import annotations

from typing import Any

import numpy as np

from algorithms.contract import Floats
from calibrate.flight.program import Step
from calibrate.flight.runtime import chebyshev


def scaling(features: Floats, kelvin: Floats | None) -> tuple[Floats, Floats]:
    """Return middle and half range (3,) of two features and the temperature."""
    warm = np.zeros(len(features)) if kelvin is None else kelvin
    columns = np.column_stack([features[:, :2], warm])
    low, high = columns.min(axis=0), columns.max(axis=0)
    half = (high - low) / 2.0
    return (low + high) / 2.0, np.where(half > 0, half, 1.0)


def terms_of(degree: int, warm: int) -> int:
    """Count the terms of a polynomial of a total degree, times powers of the temperature."""
    return (degree + 1) * (degree + 2) // 2 * (warm + 1)


def design_of(scaled: Floats, degree: int, warm: int) -> Floats:
    """Return the terms (N, terms) in the order in which `runtime.polynomial` reads them."""
    x, y, t = scaled.T
    tx, ty, tt = chebyshev(x, degree), chebyshev(y, degree), chebyshev(t, warm)
    return np.column_stack(
        [
            tt[k] * ty[j] * tx[i]
            for k in range(warm + 1)
            for j in range(degree + 1)
            for i in range(degree + 1 - j)
        ]
    )


def least_squares(design: Floats, wanted: Floats) -> Floats:
    """Return the coefficients (terms, P) of a design that fit best."""
    from scipy.linalg import lstsq  # noqa: PLC0415 - SciPy, at the first use

    found: Any = lstsq(design, wanted, cond=1e-13, lapack_driver="gelsy", check_finite=False)[0]
    return np.asarray(found)


def polynomial_step(
    scale: tuple[Floats, Floats], degree: int, warm: int, coefficients: Floats
) -> Step:
    """Return the step of polynomials with coefficients (P, terms)."""
    middle, half = scale
    outputs, terms = len(coefficients), terms_of(degree, 0)
    return Step(
        "polynomial",
        {
            "middle": middle, "half": half, "degree": degree, "warm": warm, "outputs": outputs,
            "coefficients": coefficients.reshape(-1),
        },
        outputs * (warm + 1) * (2 * terms + 3 * (degree + 1)) + 6 * degree + 3 * warm + 6,
    )  # fmt: skip


def fitted_polynomial(
    samples: Floats, kelvin: Floats | None, wanted: Floats, degree: int, warm: int
) -> Step:
    """Return polynomials of features (N, 2) that fit values (N, P) best."""
    scale = scaling(samples, kelvin)
    design = design_of(_scaled(samples, kelvin, scale), degree, warm)
    return polynomial_step(scale, degree, warm, least_squares(design, wanted).T)


def fitted_ratio(
    samples: Floats, kelvin: Floats | None, sun: Floats, degree: int, warm: int
) -> Step:
    """Return three polynomials of features (N, 2) whose vector points along directions (N, 3)."""
    scale = scaling(samples, kelvin)
    design = design_of(_scaled(samples, kelvin, scale), degree, warm)
    x, y, z = (design * component[:, None] for component in sun.T)
    nothing = np.zeros_like(x)
    equations = np.vstack([np.hstack([z, nothing, -x]), np.hstack([nothing, z, -y])])
    # the equations' null vector, or what is nearest to one
    coefficients = np.linalg.svd(np.linalg.qr(equations, mode="r"))[2][-1].reshape(3, -1)
    front = float(np.median(design @ coefficients[2]))
    coefficients = coefficients / (front or 1.0)
    return polynomial_step(scale, degree, warm, coefficients)


def fitted_axes(samples: Floats, wanted: Floats, degree: int) -> Step:
    """Return a polynomial of each feature (N, 2) that fits its own value (N, 2) best."""
    middle, half = scaling(samples, None)
    columns = (samples - middle[:2]) / half[:2]
    coefficients = np.stack(
        [
            least_squares(np.column_stack(chebyshev(columns[:, k], degree)), wanted[:, k])
            for k in range(2)
        ]
    )
    return Step(
        "axis_polynomials",
        {"middle": middle[:2], "half": half[:2], "degree": degree, "coefficients": coefficients},
        2 * (2 + 3 * degree + 2 * (degree + 1)),
    )


def fitted_spline(samples: Floats, wanted: Floats, size: int) -> Step:
    """Return two cubic splines over size x size nodes that fit values (N, 2) best."""
    from scipy.sparse import csr_array, diags_array, eye_array, kron, vstack  # noqa: PLC0415
    from scipy.sparse.linalg import splu  # noqa: PLC0415 - SciPy, at the first use

    low, high = samples.min(axis=0), samples.max(axis=0)
    step = (high - low) / (size - 3)
    first = low - step  # one node more on each side, which the cubic reads
    cells = (samples - first) / step
    corner = np.clip(np.floor(cells).astype(np.int64), 1, size - 3)
    t = cells - corner
    weights = np.stack(
        [
            (1.0 - t) ** 3 / 6.0,
            t * t * (0.5 * t - 1.0) + 2.0 / 3.0,
            ((-0.5 * t + 0.5) * t + 0.5) * t + 1.0 / 6.0,
            t**3 / 6.0,
        ]
    )
    rows = np.arange(len(samples))
    data, at = [], []
    for j in range(4):
        for i in range(4):
            data.append(weights[j, :, 1] * weights[i, :, 0])
            at.append((corner[:, 1] + j - 1) * size + corner[:, 0] + i - 1)
    design = csr_array(
        (np.concatenate(data), (np.tile(rows, 16), np.concatenate(at))),
        shape=(len(samples), size * size),
    )
    bend = diags_array([1.0, -2.0, 1.0], offsets=[0, 1, 2], shape=(size - 2, size))
    same = eye_array(size)
    # nodes that no sample reads go on as straight as those beside them
    rough = vstack([kron(bend, same), kron(same, bend)])
    normal = design.T @ design + _SMOOTH * (rough.T @ rough)
    nodes = splu(normal.tocsc()).solve(design.T @ wanted)
    return Step(
        "spline",
        {
            "first": first, "per_step": 1.0 / step, "columns": size, "lines": size,
            "nodes": nodes.reshape(size, size, 2),
        },
        4 + 6 + 2 * 24 + 16 * 5,
    )  # fmt: skip


#: Weight of squared second differences of nodes against squared errors of samples.
_SMOOTH = 1e-9


def _scaled(samples: Floats, kelvin: Floats | None, scale: tuple[Floats, Floats]) -> Floats:
    warm = np.zeros(len(samples)) if kelvin is None else kelvin
    return np.asarray((np.column_stack([samples[:, :2], warm]) - scale[0]) / scale[1])
