"""How sure a calibration is: noise of the readings, spread of the fit, intervals that hold."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from algorithms.chain import Scored
from algorithms.contract import Floats, Model, SensorGeometry, UnusableDataError
from calibrate.intervals.grazing import Grazing, grazing_of
from calibrate.intervals.local_scale import quantile_profile, scale_of
from calibrate.intervals.places import Grid, bilinear, tangent_axes
from calibrate.readings import Readings
from calibrate.selection import Candidate, fitted, fold_of

#: 95 % of a normal variable lie within so many standard deviations.
NORMAL_95 = 1.959964
#: Refits with other noise by which a fit's own spread is estimated.
REFITS = 6
#: Samples from which intervals are stated.
FEWEST = 40
_FOLDS = 5
#: Smaller errors are rounding, degrees.
_LEAST = 1e-12
#: Poses are told apart to so many digits.
_DIGITS = 6
#: Poses around one that tell its noise.
_AROUND = 16
_SEED = 20_260_101


@dataclass(frozen=True)
class Intervals:
    """The 1-sigma of a direction by its place, so that 95 % intervals hold 95 % everywhere.

    Attributes
    ----------
    factor : float
        95 % quantile of errors over their local scale (that of normal errors is 1), from samples
        that told nothing of the scale; part of `sigma_deg` already.
    coverage : float
        Share of samples left out within the 95 % interval, by a table of other samples.
    samples : int
        Of them.
    axis : ndarray, shape (3,)
        Unit vector that rings lie about.
    rings_deg : ndarray, shape (K,)
        Off-axis angles of the ring centres, from 0.
    sectors : int
        Of each ring: sector m is at the azimuth 360 m / M about the axis, from +x towards +y.
    sigma_deg : ndarray, shape (K, M, 2)
        Half width of the 95 % interval over 1.96, of the two axes of `tangent_axes`. In the first
        ring, a point, all sectors are the same.
    grazing : Grazing
        By how much it grows where light grazes a face.
    """

    factor: float
    coverage: float
    samples: int
    axis: Floats
    rings_deg: Floats
    sectors: int
    sigma_deg: Floats
    grazing: Grazing = field(default_factory=Grazing.none)

    def at(self, sun: Floats) -> Floats:
        """Return the 1-sigma (N, 2) of two tangent axes at directions (N, 3), degrees.

        Bilinear between centres, periodic in azimuth, constant beyond the last ring; NaN of NaN.
        """
        grid = Grid(self.axis, self.rings_deg, self.sectors)
        return bilinear(grid.weights(sun), self.sigma_deg) * self.grazing.times(sun)


def tangent_offsets(offsets: Floats, sun: Floats) -> Floats:
    """Return errors (N, 2) along the two axes of `tangent_axes`, degrees."""
    first, second = tangent_axes(sun)
    along = np.column_stack([(offsets * first).sum(axis=1), (offsets * second).sum(axis=1)])
    return np.asarray(np.degrees(along))


def covariance_of(sigma_deg: Floats, sun: Floats) -> Floats:
    """Return the covariance (N, 3, 3) of unit vectors (N, 3) with a 1-sigma (N, 2) of their axes.

    In radians squared, which those of a unit vector's components are.
    """
    radians = np.radians(sigma_deg)
    axes = np.stack(tangent_axes(sun), axis=1) * radians[:, :, None]
    return np.asarray(np.einsum("nai,naj->nij", axes, axes))


def intervals(offsets: Floats, sun: Floats, faces: Floats | None = None) -> Intervals | None:
    """Return the 1-sigma by place from errors (N, 3) of samples left out; None for too few.

    Of sensors with faces, whose normals are (P, 3), errors where light grazes one of them are first
    brought to the size of those around.

    The scale of errors is estimated by place; what it is multiplied by, from samples that told
    nothing of it: the scale of a fifth of the samples is that of the other four. A fifth is made of
    every fifth pose with all its repeats.
    """
    along = tangent_offsets(offsets, sun)
    known = np.isfinite(along).all(axis=1)
    along, sun, offsets = along[known], sun[known], offsets[known]
    if len(along) < FEWEST:
        return None
    grid = Grid.over(sun)
    grazing = Grazing.none()
    if faces is not None:
        answers = sun + offsets
        answers /= np.linalg.norm(answers, axis=1)[:, None]
        over = np.maximum(np.abs(along), _LEAST) / bilinear(
            grid.weights(sun), scale_of(along, sun, grid)
        )
        grazing = grazing_of(over, answers, faces)
        along = along / grazing.times(answers)
    rings, _ = grid.weights(sun)
    tests = [parts_of(sun, _FOLDS) == number for number in range(_FOLDS)]
    over, inside = np.empty_like(along), np.empty(along.shape, dtype=np.bool_)
    for test in tests:
        table = scale_of(along[~test], sun[~test], grid)
        over[test] = np.maximum(np.abs(along[test]), _LEAST) / bilinear(
            grid.weights(sun[test]), table
        )
    for test in tests:
        inside[test] = over[test] <= _limits(over[~test], rings[~test], rings[test])
    limits = _limits(over, rings, np.eye(len(grid.rings_deg))) / NORMAL_95
    return Intervals(
        limit_of(over) / NORMAL_95, float(inside.mean()), len(along), grid.axis, grid.rings_deg,
        grid.sectors, scale_of(along, sun, grid) * limits[:, :, None], grazing,
    )  # fmt: skip


def _limits(over: Floats, rings: Floats, at: Floats) -> Floats:
    """Return the limits (M, 1) that hold 95 % of errors over their scale (N, 2) at weights `at`."""
    profile = quantile_profile(over, rings, 0.95)
    level = limit_of(over / np.exp(rings @ profile)[:, None])
    return np.asarray(np.exp(at @ profile)[:, None] * level)


def parts_of(sun: Floats, count: int) -> NDArray[np.int64]:
    """Return the part (N,), 0 to count - 1, of directions (N, 3): by chance, repeats in one."""
    if not len(sun):
        return np.zeros(0, dtype=np.int64)
    poses = np.unique(np.round(sun, _DIGITS), axis=0, return_inverse=True)[1].reshape(-1)
    order = np.random.default_rng(_SEED).permutation(int(poses.max()) + 1)
    return np.asarray(order[poses] % count)


def limit_of(sizes: Floats) -> float:
    """Return the limit that holds 95 % of the next errors, too, from sizes of any shape.

    As conformal prediction has it.
    """
    flat = np.sort(sizes.reshape(-1))
    return float(flat[min(int(np.ceil(0.95 * (len(flat) + 1))) - 1, len(flat) - 1)])


def noise_deg(offsets: Floats, sun: Floats) -> float:
    """Return the RMS noise of samples, degrees: what neighbours in pose differ by.

    A model errs alike on neighbours: half the mean square of their difference is noise.
    """
    from scipy.spatial import cKDTree  # noqa: PLC0415 - SciPy, at the first use

    known = np.isfinite(offsets).all(axis=1)
    if known.sum() < 10:
        return float("nan")
    near = np.asarray(cKDTree(sun[known]).query(sun[known], k=2)[1])[:, 1]
    difference = offsets[known] - offsets[known][near]
    square = (difference**2).sum(axis=1)
    return float(np.degrees(np.sqrt(_middle(square) / 2.0)))


def noise_around(offsets: Floats, sun: Floats) -> Floats:
    """Return the RMS noise (N,) of each sample, degrees: as `noise_deg`, of the poses around it."""
    from scipy.spatial import cKDTree  # noqa: PLC0415 - SciPy, at the first use

    whole = noise_deg(offsets, sun)
    known = np.flatnonzero(np.isfinite(offsets).all(axis=1))
    if len(known) < 4 * _AROUND:
        return np.full(len(sun), whole)
    tree = cKDTree(sun[known])
    pairs = np.asarray(tree.query(sun[known], k=2)[1])[:, 1]
    square = ((offsets[known] - offsets[known][pairs]) ** 2).sum(axis=1)
    near = np.asarray(tree.query(sun, k=_AROUND)[1])
    around = np.degrees(np.sqrt(np.mean(square[near], axis=1) / 2.0))
    usual = np.sqrt(np.mean(around[known] ** 2))
    return np.asarray(around * (whole / usual) if usual > 0 else around)


def _middle(square: Floats) -> float:
    """Mean of squares without the largest hundredth."""
    kept = np.sort(square)[: max(int(0.99 * len(square)), 1)]
    return float(kept.mean())


def refits(  # noqa: PLR0917 - what a fit is made of
    scored: Scored,
    readings: Readings,
    geometry: SensorGeometry,
    noise: Floats,
    at: Readings,
    count: int = REFITS,
    tick: Callable[[], None] = lambda: None,
) -> Floats:
    """Return directions (count, N, 3) at samples `at`, each by a fit to other noise of size (N,).

    UnusableDataError if no refit settles the model.
    """
    found = []
    refusal: UnusableDataError | None = None
    for number in range(count):
        generator = np.random.default_rng(np.random.SeedSequence([_SEED, number]))
        turned = readings.sun + generator.normal(
            0.0, np.radians(noise)[:, None] / np.sqrt(2.0), readings.sun.shape
        )
        turned /= np.linalg.norm(turned, axis=1)[:, None]
        try:
            model = fitted(scored, _with_sun(readings, turned), geometry)
            found.append(model.predict(at.features, at.context))
        except UnusableDataError as error:
            refusal = error
        tick()
    if not found:
        raise refusal or UnusableDataError("no refit settles the model")
    return np.array(found)


def spread_deg(directions: Floats) -> Floats:
    """Return the RMS (N,) over refits (R, N, 3) of directions about their mean, degrees."""
    if len(directions) < 2:
        return np.full(directions.shape[1], np.nan)
    about = directions - directions.mean(axis=0)
    square = (about**2).sum(axis=2).sum(axis=0) / (len(directions) - 1)
    return np.asarray(np.degrees(np.sqrt(square)))


def _with_sun(readings: Readings, sun: Floats) -> Readings:
    from dataclasses import replace  # noqa: PLC0415 - one use

    return replace(readings, sun=sun)


#: Parts of the rim that are left out one after the other.
_PARTS = 3


def errors_left_out(  # noqa: PLR0917 - what was fitted, and to what
    scored: Scored, chosen: Candidate, used: Readings, geometry: SensorGeometry, model: Model,
    removed: Readings,
) -> tuple[Floats, Floats]:  # fmt: skip
    """Return errors (M, 3) of samples that a fit did not see, and their true directions (M, 3).

    Errors are predicted minus true, NaN where not answered: of the samples compared on, `used`, and
    of all that were removed because the final fit, `model`, does not explain them. They count as
    others do: no neighbour contradicts them, so that new ones may err as much.
    """
    offsets = _with_rim(scored, chosen, used, geometry)
    if not len(removed):
        return offsets, used.sun
    beside = model.predict(removed.features, removed.context) - removed.sun
    return np.vstack([offsets, beside]), np.vstack([used.sun, removed.sun])


def _with_rim(
    scored: Scored, chosen: Candidate, used: Readings, geometry: SensorGeometry
) -> Floats:
    """Return predicted minus true direction (N, 3) of every sample when it was left out.

    Models are compared without the rim of the field, to which no fit should be continued. But
    errors are largest there: a third of the rim's poses is left out at a time, so that its
    neighbours on the rim stay.
    """
    offsets = np.array(chosen.offsets)
    rim = np.flatnonzero(fold_of(used)[0] < 0)
    part = parts_of(used.sun[rim], _PARTS)
    for number in range(_PARTS):
        out = rim[part == number]
        if not len(out):
            continue
        try:
            model = fitted(scored, used.only(np.setdiff1d(np.arange(len(used)), out)), geometry)
        except UnusableDataError:
            continue
        test = used.only(out)
        offsets[out] = model.predict(test.features, test.context) - test.sun
    return offsets
