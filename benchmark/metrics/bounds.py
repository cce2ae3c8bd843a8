"""Cramer-Rao bounds of the Sun direction from a simulated sensor's own expected signal."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.metrics.noise_products import noise_products
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.light.sun_disc import tangent_axes
from benchmark.simulator.readout.references import References
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import (
    FixedPattern,
    GainSpread,
    PixelSpread,
    Sensor,
    SharesNoise,
)

#: Half step of the central differences over direction, radians: small against the Sun's disc
#: (4.65e-3), which smooths every edge of a shadow, and large against the distances between the
#: points it is rendered by. A lens images the disc itself: its rim needs a smaller one.
STEP_RAD = 5e-4
#: For lenses: within 0.4 % of the limit of small steps on the standard datasets.
LENS_STEP_RAD = 5e-5
#: Samples evaluated together; memory only, the numbers do not depend on it.
BATCH = 64


@dataclass(frozen=True)
class Bound:
    """Smallest standard deviations any unbiased estimator can reach, sample by sample.

    Attributes
    ----------
    angle_deg
        (N,) root of the summed variances along two tangent axes; inf where not observable.
    alpha_deg, beta_deg
        (N,) of the two projection angles (``tan(alpha) = s_y/s_z``); inf where not observable,
        NaN where the Sun is not in front of the sensor (s_z <= 0).
    observable
        (N,) bool.
    unit_angle_deg
        (N,) as `angle_deg`, with the unit known only by references and poses; inf
        where the direction is not observable, or not then. None where it was not asked for, or
        the sensor's elements do not differ each by itself.
    fisher
        (N, 4, 4) Fisher matrices, the unit known, of two tangent axes (radians), irradiance and
        stray light (in units of their spreads, whose prior of 1 is on the diagonal), of samples
        that are not observable, too. None where they were not computed.
    """

    angle_deg: Floats
    alpha_deg: Floats
    beta_deg: Floats
    observable: NDArray[np.bool_]
    unit_angle_deg: Floats | None = None
    fisher: Floats | None = None

    @property
    def rms_deg(self) -> float:
        """Root mean square of `angle_deg` over the observable samples; NaN when there is none."""
        return self._rms(self.angle_deg)

    @property
    def unit_rms_deg(self) -> float:
        """The same of `unit_angle_deg`; NaN where there is none."""
        return math.nan if self.unit_angle_deg is None else self._rms(self.unit_angle_deg)

    def _rms(self, angle_deg: Floats) -> float:
        seen = angle_deg[self.observable]
        return float(np.sqrt(np.mean(seen**2))) if seen.size else math.nan

    @classmethod
    def join(cls, parts: Sequence[Bound]) -> Bound:
        """Put bounds of consecutive samples together."""
        units = [part.unit_angle_deg for part in parts]
        known = [unit for unit in units if unit is not None]
        matrices = [part.fisher for part in parts if part.fisher is not None]
        return cls(
            angle_deg=np.concatenate([part.angle_deg for part in parts]),
            alpha_deg=np.concatenate([part.alpha_deg for part in parts]),
            beta_deg=np.concatenate([part.beta_deg for part in parts]),
            observable=np.concatenate([part.observable for part in parts]),
            unit_angle_deg=np.concatenate(known) if len(known) == len(units) else None,
            fisher=np.concatenate(matrices) if len(matrices) == len(parts) else None,
        )


def cramer_rao(  # noqa: PLR0917 - memory and time come last
    sensor: Sensor,
    scene: Scene,
    pattern: FixedPattern,
    irradiance: Irradiance,
    step_rad: float = STEP_RAD,
    batch: int | None = None,
    references: References | None = None,
    poses: Floats | None = None,
) -> Bound:
    """Return the Cramer-Rao bounds of the direction, with sunlight and stray light unknown.

    The first bound is for a known sensor unit, the second for a unit known only through its
    `references` and the poses of its calibration. Fixed pattern, assembly and albedo count as known
    in the first, so it holds for every estimator, however well it is calibrated.

    Parameters
    ----------
    sensor, scene, pattern, irradiance
        What is seen, by which unit, and the spread of the nuisances.
    step_rad
        Half step of the central differences.
    batch
        Samples evaluated together, `BATCH` by default; the numbers do not depend on it.
    references
        Readings that tell of the unit; None for no bound of that kind.
    poses
        (K, P, P) what poses tell of each element of a few (`pose_information`); None for nothing.

    Raises
    ------
    ValueError
        When irradiance or stray light are drawn without spread: a known nuisance is not one.
        When `step_rad` is not positive.

    Notes
    -----
    The Fisher matrix of (two tangent axes, irradiance, stray light) is ``J^T V^-1 J`` with J
    from differences of `Sensor.expected` and V from `Sensor.variance`, with noise that elements
    share (`SharesNoise`) off its diagonal. The two nuisances enter with the spread they are drawn
    with (``1/spread^2`` on the diagonal: the hybrid bound, exact for Gaussian nuisances).

    In the second bound gains and dark signals of the elements are nuisances, too, with the spread
    that remains after flat and dark readings. They are independent between elements, so
    marginalising them adds a variance to V (`PixelSpread.unit_variance`), and offsets of columns
    add to the noise that a column's elements share. Of a few elements the poses of the calibration
    tell as much as flats do, and of their drifts all: with J the changes of a reading by an
    element's unknowns (`GainSpread.gain_slopes`), the variance is ``J C J^T``, C inverse to what
    references and poses tell of them. Of one pixel of many a pose tells next to nothing. The
    assembly stays known, and observability is decided with the
    unit known.

    A direction is not observable if the matrix is singular, or if the derivatives do not describe
    the neighbourhood of the direction: moving the Sun by one standard deviation along the weakest
    axis must change the signal by half to twice the change predicted by the derivatives (for a
    photodiode about to go dark it does not). If a standard deviation is smaller than the step of
    the differences, the step itself is tested, in both directions along either tangent axis.
    """
    if not step_rad > 0:
        raise ValueError(f"step_rad must be positive; got {step_rad}")
    if irradiance.spread == 0 or irradiance.stray_spread == 0:
        raise ValueError(
            "the bound needs irradiance.spread and irradiance.stray_spread above 0; got "
            f"{irradiance.spread} and {irradiance.stray_spread}"
        )
    size = batch or BATCH
    parts = [
        _batch(
            sensor,
            scene.part(start, start + size),
            pattern,
            irradiance,
            step_rad,
            references,
            poses,
        )
        for start in range(0, len(scene), size)
    ]
    return Bound.join(parts)


def _changed(scene: Scene, irradiance: Irradiance, step_rad: float) -> list[Scene]:
    """Return a scene with the Sun a step to either side of both axes, brighter, and hazier."""
    first, second = tangent_axes(scene.sun)
    zero, step = np.zeros(len(scene)), np.full(len(scene), step_rad)
    sides = [(step, zero), (-step, zero), (zero, step), (zero, -step)]
    return [
        *(scene.seen_from(_turn(scene.sun, first, second, x, y)) for x, y in sides),
        # nuisances in units of their spread: their prior information is 1
        replace(scene, irradiance=scene.irradiance + irradiance.spread),
        replace(scene, stray=scene.stray + irradiance.stray_spread),
    ]


def reading_slopes(
    sensor: Sensor, scene: Scene, pattern: FixedPattern, irradiance: Irradiance, step_rad: float
) -> tuple[Floats, Floats]:
    """Return how the means of a few elements change, (N, K, 4), and their variances (N, K).

    By a radian along two tangent axes, and by one spread of sunlight and of stray light. Parameters
    as of `cramer_rao`.
    """
    mean = sensor.expected(scene, pattern)
    right, left, up, down, brighter, hazier = (
        sensor.expected(one, pattern) for one in _changed(scene, irradiance, step_rad)
    )
    turns = [(right - left) / (2.0 * step_rad), (up - down) / (2.0 * step_rad)]
    slopes = np.stack([*turns, brighter - mean, hazier - mean], axis=-1)
    return np.asarray(slopes), np.asarray(sensor.variance(mean))


def pose_information(sensor: GainSpread, scene: Scene, pattern: FixedPattern) -> Floats:
    """(K, P, P) information of poses on each element's unknowns, in the units of `gain_slopes`.

    Sunlight and the Sun count as known at each pose, so it is at least what an estimator has.

    Parameters
    ----------
    sensor, scene, pattern
        The sensor as it was calibrated, the light of the poses, the unit.
    """
    seen = cast("Sensor", sensor)
    mean = seen.expected(scene, pattern)
    slopes = sensor.gain_slopes(mean, scene)
    weighted = slopes / seen.variance(mean)[..., None]
    return np.asarray(np.einsum("nkp,nkq->kpq", weighted, slopes))


def unit_variance(
    sensor: Sensor,
    mean: Floats,
    scene: Scene,
    references: References,
    poses: Floats | None = None,
) -> Floats | None:
    """Variance, in the shape of `mean`, that a unit adds to its readings where it is not known.

    None for a sensor whose elements do not differ each by itself. Parameters as of `cramer_rao`.
    """
    if isinstance(sensor, GainSpread):
        information = sensor.gain_information(references) + (0.0 if poses is None else poses)
        slopes = sensor.gain_slopes(mean, scene)
        left = np.linalg.inv(np.broadcast_to(information, (mean.shape[1], *information.shape[-2:])))
        return np.asarray(np.einsum("nkp,kpq,nkq->nk", slopes, left, slopes))
    if isinstance(sensor, PixelSpread):
        return sensor.unit_variance(mean, scene, references)
    return None


def _turn(sun: Floats, first: Floats, second: Floats, x: Floats, y: Floats) -> Floats:
    """`sun` moved by the tangent vector x first + y second (radians) along great circles."""
    size = np.sqrt(x**2 + y**2)[:, None]
    step = np.where(size > 0, np.sin(size) / np.where(size > 0, size, 1.0), 1.0)
    moved = np.cos(size) * sun + step * (x[:, None] * first + y[:, None] * second)
    return np.asarray(moved / np.sqrt(np.sum(moved**2, axis=1, keepdims=True)))


def _batch(  # noqa: PLR0917 - as `cramer_rao`
    sensor: Sensor,
    scene: Scene,
    pattern: FixedPattern,
    irradiance: Irradiance,
    step_rad: float,
    references: References | None,
    poses: Floats | None,
) -> Bound:
    count = len(scene)
    first, second = tangent_axes(scene.sun)
    whole = sensor.expected(scene, pattern)
    mean, own = whole.reshape(count, -1), sensor.variance(whole).reshape(count, -1)
    common = unit_common = unit = None
    if isinstance(sensor, SharesNoise):
        common = sensor.common_noise(whole.shape, None)
        unit_common = sensor.common_noise(whole.shape, references)
    if references is not None:
        unit = unit_variance(sensor, whole, scene, references, poses)

    def moved(x: Floats, y: Floats) -> Scene:
        return scene.seen_from(_turn(scene.sun, first, second, x, y))

    seen = _changed(scene, irradiance, step_rad)
    signals = np.empty((len(seen), *mean.shape))
    for signal, one in zip(signals, seen, strict=True):
        signal[:] = sensor.expected(one, pattern).reshape(count, -1)
    products = noise_products(mean, signals, own, common)
    fisher = _fisher(products, step_rad)
    information, nuisance = _marginal(fisher)
    unit_information = None
    if unit is not None:
        wider = own + unit.reshape(count, -1)
        unit_products = noise_products(mean, signals, wider, unit_common)
        unit_information, _ = _marginal(_fisher(unit_products, step_rad))
    values, axes = _principal(information)
    regular = _regular(values)
    inverse = 1.0 / np.where(regular[:, None], values, 1.0)
    covariance = np.einsum("nik,nk,njk->nij", axes, inverse, axes)
    sigma = np.sqrt(inverse[:, 0])

    def as_promised(square: Floats, shared: Floats, promised: Floats) -> NDArray[np.bool_]:
        # what is left of the change when sunlight and stray light take their best share
        taken = np.einsum("ni,ni->n", shared, np.linalg.solve(nuisance, shared[:, :, None])[..., 0])
        distance = np.sqrt(np.maximum(square - taken, 0.0))
        return np.asarray((distance > 0.5 * promised) & (distance < 2.0 * promised))

    near = regular & (sigma < step_rad)
    for side in range(4):
        axis = side // 2
        promised = step_rad * np.sqrt(np.maximum(information[:, axis, axis], 0.0))
        near &= as_promised(products[:, side, side], products[:, side, 4:], promised)
    local = near | (regular & (sigma >= step_rad))
    if (sigma[regular] >= step_rad).any():
        far = regular & (sigma >= step_rad)
        for sign in (1.0, -1.0):
            # samples that need no such test are not moved: their light may be known already
            x = np.where(far, sign * sigma * axes[:, 0, 0], 0.0)
            y = np.where(far, sign * sigma * axes[:, 1, 0], 0.0)
            # in place of a side, which is not needed any more
            signals[3] = sensor.expected(moved(x, y), pattern).reshape(count, -1)
            products = noise_products(mean, signals[3:], own, common)
            local &= ~far | as_promised(products[:, 0, 0], products[:, 0, 1:], np.ones(count))
    alpha, beta = _project(scene.sun, covariance)
    return Bound(
        angle_deg=_angle_deg(inverse, local),
        alpha_deg=np.where(local | np.isnan(alpha), alpha, np.inf),
        beta_deg=np.where(local | np.isnan(beta), beta, np.inf),
        observable=local,
        unit_angle_deg=(
            None if unit_information is None else _unit_angle_deg(unit_information, local)
        ),
        fisher=fisher,
    )


def _unit_angle_deg(information: Floats, observable: NDArray[np.bool_]) -> Floats:
    """(N,) bound of who does not know the unit."""
    values, _ = _principal(information)
    regular = _regular(values)
    return _angle_deg(1.0 / np.where(regular[:, None], values, 1.0), observable & regular)


def _fisher(products: Floats, step_rad: float) -> Floats:
    """Fisher matrices (N, 4, 4) of both axes and both nuisances, the nuisances' priors included.

    Of products (N, 6, 6) of the changes by a step to either side along both axes, and by the
    nuisances.
    """
    slopes = np.zeros((4, 6))
    slopes[0, :2] = slopes[1, 2:4] = 0.5 / step_rad, -0.5 / step_rad
    slopes[2, 4] = slopes[3, 5] = 1.0
    fisher = slopes @ products @ slopes.T
    fisher[:, 2, 2] += 1.0
    fisher[:, 3, 3] += 1.0
    return np.asarray(fisher)


def _marginal(fisher: Floats) -> tuple[Floats, Floats]:
    """Information on the direction (N, 2, 2) without the nuisances' share, and that on those."""
    direction, cross, nuisance = fisher[:, :2, :2], fisher[:, :2, 2:], fisher[:, 2:, 2:]
    gain = np.linalg.solve(nuisance, np.swapaxes(cross, 1, 2))
    return np.asarray(direction - cross @ gain), np.asarray(nuisance)


def _principal(information: Floats) -> tuple[Floats, Floats]:
    """Eigenvalues (N, 2), rising, and axes (N, 2, 2) in columns."""
    values, axes = np.linalg.eigh((information + np.swapaxes(information, 1, 2)) / 2.0)
    return np.asarray(values), np.asarray(axes)


def _regular(values: Floats) -> NDArray[np.bool_]:
    """Say where (N,) information of eigenvalues (N, 2) is knowledge of the direction."""
    # a standard deviation of half a turn is none
    return np.asarray(values[:, 0] > np.maximum(1.0 / math.pi**2, 1e-12 * values[:, 1]))


def _angle_deg(variances: Floats, observable: NDArray[np.bool_]) -> Floats:
    """(N,) degrees of variances (N, 2) along the principal axes; inf where not observable."""
    return np.degrees(np.sqrt(np.where(observable, variances.sum(axis=1), np.inf)))


def _project(sun: Floats, covariance: Floats) -> tuple[Floats, Floats]:
    """Return standard deviations of alpha and beta in degrees, NaN where s_z <= 0."""
    first, second = tangent_axes(sun)
    out = []
    for axis in (1, 0):
        across, along = sun[:, axis], sun[:, 2]
        square = across**2 + along**2
        front = along > 0
        scale = np.where(front, square, 1.0)
        gradient = np.stack(
            [(along * basis[:, axis] - across * basis[:, 2]) / scale for basis in (first, second)],
            axis=1,
        )
        variance = np.einsum("ni,nij,nj->n", gradient, covariance, gradient)
        out.append(np.where(front, np.degrees(np.sqrt(variance)), np.nan))
    return out[0], out[1]
