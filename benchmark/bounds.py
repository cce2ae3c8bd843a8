"""Cramer-Rao bounds of the Sun direction from a simulated sensor's own expected signal."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from benchmark.simulator.environment import Irradiance
from benchmark.simulator.light import tangent_axes
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern, Sensor

Floats = NDArray[np.float64]

#: Half step of the central differences over direction, radians: small against the Sun's disc
#: (4.65e-3), which smooths every edge, large against rounding.
STEP_RAD = 5e-4
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


def cramer_rao(
    sensor: Sensor, scene: Scene, pattern: FixedPattern, irradiance: Irradiance
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
    the derivatives promise (a photodiode about to go dark does not).

    Raises
    ------
    ValueError
        When irradiance or stray light are drawn without spread: a known nuisance is not one.
    """
    if irradiance.spread == 0 or irradiance.stray_spread == 0:
        raise ValueError(
            "the bound needs irradiance.spread and irradiance.stray_spread above 0; got "
            f"{irradiance.spread} and {irradiance.stray_spread}"
        )
    parts = [
        _batch(sensor, scene.part(start, start + BATCH), pattern, irradiance)
        for start in range(0, len(scene), BATCH)
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
    sensor: Sensor, scene: Scene, pattern: FixedPattern, irradiance: Irradiance
) -> tuple[Floats, NDArray[np.bool_]]:
    count = len(scene)
    first, second = tangent_axes(scene.sun)
    zero, step = np.zeros(count), np.full(count, STEP_RAD)

    def signal(x: Floats, y: Floats) -> Floats:
        moved = scene.seen_from(_turned(scene.sun, first, second, x, y))
        return sensor.expected(moved, pattern).reshape(count, -1)

    mean = sensor.expected(scene, pattern)
    deviation = np.sqrt(sensor.variance(mean)).reshape(count, -1)
    mean = mean.reshape(count, -1)
    brighter = replace(scene, irradiance=scene.irradiance + irradiance.spread)
    hazier = replace(scene, stray=scene.stray + irradiance.stray_spread)
    # nuisances in units of their spread: their prior information is 1
    jacobian = np.stack(
        [
            (signal(step, zero) - signal(-step, zero)) / (2.0 * STEP_RAD),
            (signal(zero, step) - signal(zero, -step)) / (2.0 * STEP_RAD),
            sensor.expected(brighter, pattern).reshape(count, -1) - mean,
            sensor.expected(hazier, pattern).reshape(count, -1) - mean,
        ],
        axis=2,
    )
    jacobian /= deviation[:, :, None]
    fisher = np.einsum("nmi,nmj->nij", jacobian, jacobian)
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
    local = regular.copy()
    for sign in (1.0, -1.0):
        x, y = sign * sigma * axes[:, 0, 0], sign * sigma * axes[:, 1, 0]
        change = (signal(x, y) - mean) / deviation
        # what is left of the change when sunlight and stray light take their best share
        shared = np.einsum("nmi,nm->ni", jacobian[:, :, 2:], change)
        taken = np.einsum("ni,ni->n", shared, np.linalg.solve(nuisance, shared[:, :, None])[..., 0])
        distance = np.sqrt(np.maximum(np.sum(change**2, axis=1) - taken, 0.0))
        local &= (distance > 0.5) & (distance < 2.0)
    return covariance, regular & local


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
