"""Settings that models choose from their calibration, against the best of all in hindsight.

Bent, skewed and rippled balances, three noise levels, four calibrations: a turntable's 21 x 21
grid over a wide field and 13 x 13 poses over the same, a Fibonacci spiral over a round one, 11 x 11
poses over a narrow one. The test set is measured as the calibration is. What a choice cannot see is
kept as a failure: where a response bends more than its poses show, not noise but the polynomial's
own swings between them decide.
"""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.angles import separation_deg, sun_from_angles
from algorithms.calibration.blocks import between_poses, folds, splits
from algorithms.calibration.orders import errors_of_orders
from algorithms.contract import UnusableDataError
from algorithms.models.lut.blended_polynomials import DEGREES, BlendedPolynomials
from algorithms.models.lut.error_tables import (
    SMOOTHINGS,
    GridAxis,
    errors_left_out,
    interpolation_matrix,
    row_products,
    solve_table,
    surface_roughness,
)
from algorithms.models.lut.lookup_table import ErrorTable
from algorithms.models.non_physical.fourier_balance import MAX_HARMONICS, FourierBalance
from algorithms.models.non_physical.polynomial import (
    MAX_DEGREE,
    AxisPolynomial,
    SurfacePolynomial,
)

WORST = 1.1
DRAWING = {"focal_length_mm": 1.0, "unit_mm": 1.0}
EVERY_DEGREE = [{"degree": n} for n in range(1, MAX_DEGREE + 1)]
MODELS = {
    "polynomial-1d": (AxisPolynomial, {}, EVERY_DEGREE),
    "polynomial-2d": (SurfacePolynomial, {}, EVERY_DEGREE),
    "fourier-balance": (
        FourierBalance,
        {},
        [{"harmonics": n} for n in range(1, MAX_HARMONICS + 1)],
    ),
    "lut": (ErrorTable, DRAWING, [{"smoothing": s} for s in SMOOTHINGS]),
    "lut-polynomial": (
        BlendedPolynomials,
        DRAWING,
        [{"degree": n, "smoothing": s} for n in DEGREES for s in SMOOTHINGS],
    ),
}


def grid(limit, steps):
    axis = np.linspace(-limit, limit, steps)
    return np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)


def spiral(limit, count):
    steps = np.arange(count)
    radius, turn = limit * np.sqrt((steps + 0.5) / count), steps * np.pi * (3 - np.sqrt(5))
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn)])


#: Half the field in degrees, whether it is round, and the poses.
CALIBRATIONS = {
    "grid": (45.0, False, grid(45.0, 21)),
    "spiral": (30.0, True, spiral(30.0, 300)),
    "narrow": (8.0, False, grid(8.0, 11)),
    "coarse": (45.0, False, grid(45.0, 13)),
}

#: Choices that are farther off than they should be.
UNSEEN = {("polynomial-2d", "grid", 1e-5), ("polynomial-2d", "coarse", 1e-5)}


def balances(angles_deg, noise, rng):
    x, y = np.tan(np.radians(angles_deg[:, ::-1])).T
    bent = np.column_stack(
        [
            x + 0.03 * y - 0.02 * x**2 + 0.05 * x**3 + 0.002 * np.sin(9 * x) + 0.01 * x * y,
            y - 0.03 * x + 0.01 * x * y + 0.04 * y**3 - 0.003 * np.cos(7 * y),
        ]
    )
    return bent + noise * rng.standard_normal(bent.shape)


def rms_deg(model, features, sun):
    return float(np.sqrt(np.nanmean(separation_deg(model.predict(features), sun) ** 2)))


@pytest.mark.slow
@pytest.mark.parametrize("noise", [1e-5, 1e-3, 1e-2])
@pytest.mark.parametrize("where", CALIBRATIONS)
@pytest.mark.parametrize("name", MODELS)
def test_chosen_settings_are_as_good_as_the_best_in_hindsight(name, where, noise, request):
    if (name, where, noise) in UNSEEN:
        reason = "polynomials' swings between the poses, 1.5 and 1.7 times the best"
        request.node.add_marker(pytest.mark.xfail(reason=reason, strict=True))
    make, drawing, fixed = MODELS[name]
    limit, is_round, poses = CALIBRATIONS[where]
    rng = np.random.default_rng(100)
    features, sun = balances(poses, noise, rng), sun_from_angles(poses)
    asked = rng.uniform(-0.95 * limit, 0.95 * limit, (2000, 2))
    if is_round:
        asked = asked[np.hypot(*asked.T) < 0.93 * limit]
    test = balances(asked, noise, rng), sun_from_angles(asked)
    chosen = rms_deg(make(**drawing).fit(features, sun), *test)
    errors = []
    for settings in fixed:
        try:
            errors.append(rms_deg(make(**drawing, **settings).fit(features, sun), *test))
        except UnusableDataError:
            continue
    assert len(errors) >= 5
    assert chosen <= WORST * min(errors)


def test_errors_left_out_are_those_of_tables_solved_one_by_one():
    rng = np.random.default_rng(4)
    nominal, errors = rng.uniform(-10, 10, (120, 2)), rng.normal(0, 1, (120, 2))
    axes = [GridAxis.over(column, 2.0) for column in nominal.T]
    along = [interpolation_matrix(a, c) for a, c in zip(axes, nominal.T, strict=True)]
    design = row_products(*along)
    roughness = surface_roughness(axes[0].nodes, axes[1].nodes)
    parts = splits(np.arange(120) % 5)
    found = errors_left_out(design, roughness, SMOOTHINGS, errors, parts)
    expected = []
    for weight in SMOOTHINGS:
        missed = [
            design[out] @ solve_table(design[kept], roughness, weight, errors[kept], "test")
            - errors[out]
            for kept, out in parts
        ]
        expected.append(np.sqrt((np.concatenate(missed) ** 2).sum() / 120))
    np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_folds_leave_out_neither_rim_nor_half_of_a_pose():
    """Corners and edges would be continued to; a repeat left in gives its pose away."""
    poses = np.repeat(grid(20.0, 9), 3, axis=0)
    fold = folds(sun_from_angles(poses))
    rim = np.abs(poses).max(axis=1) == 20.0
    assert (fold[rim] == -1).all()
    assert (fold[~rim] >= 0).all()
    assert all(len(set(fold[k : k + 3])) == 1 for k in range(0, len(fold), 3))
    shares = [int(left_out.sum()) for _, left_out in splits(fold)]
    assert sum(shares) == 3 * 49
    assert max(shares) - min(shares) <= 3


def test_folds_of_the_whole_sphere_and_of_few_poses_leave_all_out_once():
    vectors = np.random.default_rng(1).normal(size=(200, 3))
    vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
    assert (folds(vectors) >= 0).all()
    assert (folds(sun_from_angles(grid(20.0, 4))) >= 0).all()  # four poses within: too few


def test_orders_that_swing_between_the_poses_are_raised_by_as_much():
    """Twelve places, and polynomials of them: variances by NumPy's own least squares."""
    at = np.linspace(-1.0, 1.0, 12)
    sun = sun_from_angles(np.column_stack([np.zeros(12), 20.0 * at]))
    middles = between_poses(sun, at[:, None])[:, 0]
    rng = np.random.default_rng(7)
    wanted = np.sin(2.0 * at)[:, None] + 0.01 * rng.standard_normal((12, 1))
    fold = np.array([-1, 0, 1, 2, 3, 4, 0, 1, 2, 3, 4, -1])
    sizes = [2, 4, 8]
    design = np.polynomial.chebyshev.chebvander(at, 7)
    between = np.polynomial.chebyshev.chebvander(middles, 7)
    found = errors_of_orders(design, sizes, wanted, fold, between)
    expected = []
    for size in sizes:
        left, off = [], []
        for number in range(5):
            kept = fold != number
            inverse = np.linalg.pinv(design[kept][:, :size])
            terms = design[~kept][:, :size]
            off.append(((terms @ inverse @ wanted[kept] - wanted[~kept]) ** 2).sum())
            left.append(((terms @ inverse) ** 2).sum())
        swing = ((between[:, :size] @ np.linalg.pinv(design[:, :size])) ** 2).sum() / len(between)
        raised = max((1.0 + swing) / (1.0 + np.sum(left) / 10.0), 1.0)
        expected.append(np.sum(off) / 10.0 * raised)
    np.testing.assert_allclose(found, expected, rtol=1e-9)
