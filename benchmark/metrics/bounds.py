"""Cramer-Rao bounds of the Sun direction from a simulated sensor's own expected signal."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.light.sun_disc import tangent_axes
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern, Sensor

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
    """

    angle_deg: Floats
    alpha_deg: Floats
    beta_deg: Floats
    observable: NDArray[np.bool_]

    @property
    def rms_deg(self) -> float:
        """Root mean square of `angle_deg` over the observable samples; NaN when there is none."""
        seen = self.angle_deg[self.observable]
        return float(np.sqrt(np.mean(seen**2))) if seen.size else math.nan


def cramer_rao(  # noqa: PLR0917 - memory and time come last
    sensor: Sensor,
    scene: Scene,
    pattern: FixedPattern,
    irradiance: Irradiance,
    step_rad: float = STEP_RAD,
    batch: int | None = None,
) -> Bound:
    """Bound of the direction with sunlight and stray light unknown, the unit itself known.

    The Fisher matrix of (two tangent axes, irradiance, stray light) is ``J^T V^-1 J`` with J
    from differences of `Sensor.expected` and V from `Sensor.variance`. The two nuisances enter
    with the spread they are drawn with (``1/spread^2`` on the diagonal: the hybrid bound,
    exact for Gaussian nuisances). Fixed pattern, assembly and light from the Earth count as
    known, so the bound holds for every estimator, however well it is calibrated.

    A direction is not observable where the matrix is singular, or where the bound is not a
    statement about the neighbourhood it was computed in: moving the Sun by one standard
    deviation along the weakest axis must change the signal by between half and twice of what
    the derivatives promise (a photodiode about to go dark does not). Where a standard deviation
    is less than the differences' step, the step itself must, along either tangent axis and to
    either side: a test further out, whose signals are there already.

    Parameters
    ----------
    sensor, scene, pattern, irradiance
        What is seen, by which unit, and the spread of the nuisances.
    step_rad
        Half step of the central differences.
    batch
        Samples evaluated together, `BATCH` by default; the numbers do not depend on it.

    Raises
    ------
    ValueError
        When irradiance or stray light are drawn without spread: a known nuisance is not one.
        When `step_rad` is not positive.
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
        _batch(sensor, scene.part(start, start + size), pattern, irradiance, step_rad)
        for start in range(0, len(scene), size)
    ]
    covariance = np.concatenate([part[0] for part in parts])
    observable = np.concatenate([part[1] for part in parts])
    variance = covariance[:, 0, 0] + covariance[:, 1, 1]
    alpha, beta = _projected(scene.sun, covariance)
    angle = np.degrees(np.sqrt(np.where(observable, variance, np.inf)))
    return Bound(
        angle_deg=angle,
        alpha_deg=np.where(observable | np.isnan(alpha), alpha, np.inf),
        beta_deg=np.where(observable | np.isnan(beta), beta, np.inf),
        observable=observable,
    )


def _turned(sun: Floats, first: Floats, second: Floats, x: Floats, y: Floats) -> Floats:
    """`sun` moved by the tangent vector x first + y second (radians) along great circles."""
    size = np.sqrt(x**2 + y**2)[:, None]
    step = np.where(size > 0, np.sin(size) / np.where(size > 0, size, 1.0), 1.0)
    moved = np.cos(size) * sun + step * (x[:, None] * first + y[:, None] * second)
    return np.asarray(moved / np.sqrt(np.sum(moved**2, axis=1, keepdims=True)))


def _batch(
    sensor: Sensor, scene: Scene, pattern: FixedPattern, irradiance: Irradiance, step_rad: float
) -> tuple[Floats, NDArray[np.bool_]]:
    count = len(scene)
    first, second = tangent_axes(scene.sun)
    zero, step = np.zeros(count), np.full(count, step_rad)
    mean = sensor.expected(scene, pattern)
    deviation = np.sqrt(sensor.variance(mean)).reshape(count, -1)
    mean = mean.reshape(count, -1)

    def change(x: Floats, y: Floats) -> Floats:
        """(N, M) difference to the mean in standard deviations, the Sun moved by (x, y)."""
        moved = scene.seen_from(_turned(scene.sun, first, second, x, y))
        return _change(sensor.expected(moved, pattern))

    def _change(expected: Floats) -> Floats:
        difference = expected.reshape(count, -1) - mean
        difference /= deviation
        return difference

    sides = [(change(step, zero), change(-step, zero)), (change(zero, step), change(zero, -step))]
    # nuisances in units of their spread: their prior information is 1
    brighter = replace(scene, irradiance=scene.irradiance + irradiance.spread)
    hazier = replace(scene, stray=scene.stray + irradiance.stray_spread)
    jacobian = [
        *((plus - minus) / (2.0 * step_rad) for plus, minus in sides),
        _change(sensor.expected(brighter, pattern)),
        _change(sensor.expected(hazier, pattern)),
    ]
    fisher = np.empty((count, 4, 4))
    for i, one in enumerate(jacobian):
        for j, other in enumerate(jacobian[: i + 1]):
            fisher[:, i, j] = fisher[:, j, i] = _products(one, other)
    fisher[:, 2, 2] += 1.0
    fisher[:, 3, 3] += 1.0
    direction, cross, nuisance = fisher[:, :2, :2], fisher[:, :2, 2:], fisher[:, 2:, 2:]
    gain = np.linalg.solve(nuisance, np.swapaxes(cross, 1, 2))
    information = direction - cross @ gain
    values, axes = np.linalg.eigh((information + np.swapaxes(information, 1, 2)) / 2.0)
    weakest = values[:, 0]
    # a standard deviation of half a turn is no knowledge of the direction
    regular = weakest > np.maximum(1.0 / math.pi**2, 1e-12 * values[:, 1])
    inverse = 1.0 / np.where(regular[:, None], values, 1.0)
    covariance = np.einsum("nik,nk,njk->nij", axes, inverse, axes)
    sigma = np.sqrt(inverse[:, 0])

    def as_promised(changed: Floats, promised: Floats) -> NDArray[np.bool_]:
        # what is left of the change when sunlight and stray light take their best share
        shared = np.column_stack([_products(one, changed) for one in jacobian[2:]])
        taken = np.einsum("ni,ni->n", shared, np.linalg.solve(nuisance, shared[:, :, None])[..., 0])
        distance = np.sqrt(np.maximum(_products(changed, changed) - taken, 0.0))
        return np.asarray((distance > 0.5 * promised) & (distance < 2.0 * promised))

    near = regular & (sigma < step_rad)
    for axis, both in enumerate(sides):
        promised = step_rad * np.sqrt(np.maximum(information[:, axis, axis], 0.0))
        for changed in both:
            near &= as_promised(changed, promised)
    local = near | (regular & (sigma >= step_rad))
    if (sigma[regular] >= step_rad).any():
        far = regular & (sigma >= step_rad)
        for sign in (1.0, -1.0):
            # samples that need no such test are not moved: their light may be known already
            x = np.where(far, sign * sigma * axes[:, 0, 0], 0.0)
            y = np.where(far, sign * sigma * axes[:, 1, 0], 0.0)
            local &= ~far | as_promised(change(x, y), np.ones(count))
    return covariance, local


def _products(one: Floats, other: Floats) -> Floats:
    """(N,) scalar products of the rows of (N, M) arrays."""
    return np.asarray(np.einsum("nm,nm->n", one, other))


def _projected(sun: Floats, covariance: Floats) -> tuple[Floats, Floats]:
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
