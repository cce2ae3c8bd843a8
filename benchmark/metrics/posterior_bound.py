"""Posterior Cramer-Rao bounds of the Sun direction for who knows more than one sample's readings.

The recursion of Tichavsky, Muravchik and Nehorai (1998), with additive Gaussian noise and a motion
that is linear in its errors: the covariance of the Kalman filter that knows the true Jacobians.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.flight.gyro import Gyro, rotation_vectors_deg
from benchmark.simulator.light.sun_disc import tangent_axes

#: Standard deviation of each angle of the attitude before anything is read: twice half a turn.
PRIOR_RAD = 2.0 * math.pi
#: A standard deviation of half a turn is no knowledge.
_UNKNOWN = math.pi**2
_HOUR_S = 3600.0


@dataclass(frozen=True)
class Motion:
    """How a body turned, and the gyroscope that an estimator has to tell it by.

    Attributes
    ----------
    turn : ndarray, shape (N, 3, 3)
        True rotations from the inertial to the body frame.
    time_s : ndarray, shape (N,)
        Of the samples, rising; rates are mean rates since the sample before.
    gyro : Gyro
        Its noise is known to the estimator, its bias is not.
    """

    turn: Floats
    time_s: Floats
    gyro: Gyro


def sun_information(fisher: Floats, *, irradiance_known: bool) -> Floats:
    """Information (N, 2, 2) on the direction to the Sun along two tangent axes, 1/rad^2.

    Stray light is marginalised, and so is sunlight unless it is known.

    Parameters
    ----------
    fisher : ndarray, shape (N, 4, 4)
        `benchmark.metrics.bounds.Bound.fisher`.
    irradiance_known : bool
        Sunlight stands still during a flight: who carries a state learns it.
    """
    nuisances = [3] if irradiance_known else [2, 3]
    cross = fisher[:, :2, nuisances]
    own = fisher[:, nuisances][:, :, nuisances]
    return np.asarray(fisher[:, :2, :2] - cross @ np.linalg.solve(own, np.swapaxes(cross, 1, 2)))


def attitude_information(sun: Floats, information: Floats) -> Floats:
    """Information (N, 3 + P, 3 + P) on turns of the body, axes of the body frame, 1/rad^2.

    Of that on the direction of the Sun (N, 3) along its tangent axes and on P things unknown,
    (N, 2 + P, 2 + P): of the turn about the Sun it tells nothing.
    """
    extra = information.shape[1] - 2
    lever = np.zeros((len(sun), 2 + extra, 3 + extra))
    lever[:, :2, :3] = _levers(sun)
    lever[:, 2:, 3:] = np.eye(extra)
    return np.asarray(np.swapaxes(lever, 1, 2) @ information @ lever)


def vector_information(vectors: Floats, deviation: float) -> Floats:
    """Information (N, 3, 3) as `attitude_information`, of vectors (N, 3) known in another frame.

    They are read in the body frame and known in the inertial one; `deviation` is that of the white
    noise of each component, in the vectors' unit.
    """
    square = np.einsum("ni,ni->n", vectors, vectors)
    across = square[:, None, None] * np.eye(3) - vectors[:, :, None] * vectors[:, None, :]
    return np.asarray(across / deviation**2)


def single_bound(sun: Floats, information: Floats) -> Floats:
    """Bounds (N,) of the direction, degrees, for who knows each sample's readings alone.

    Parameters
    ----------
    sun : ndarray, shape (N, 3)
        True unit vectors, body frame.
    information : ndarray, shape (N, 3, 3)
        Of all that is read, on turns of the body (`attitude_information`, `vector_information`).

    Returns
    -------
    ndarray, shape (N,)
        Root of the summed variances along two tangent axes; inf where nothing is known.
    """
    covariance = np.linalg.inv(information + np.eye(3) / PRIOR_RAD**2)
    return _angles_deg(_levers(sun), np.asarray(covariance, dtype=np.float64))


def recursive_bound(
    sun: Floats, information: Floats, motion: Motion, known: Floats | None = None
) -> Floats:
    """Bounds (N,) of the direction, degrees, for who knows all readings up to each sample.

    The state is the attitude's error, about the axes of the inertial frame, where it stands still,
    and the gyroscope's bias in the body frame. A rate that is wrong by e over a step of dt turns
    the attitude by ``A^T J e dt``: A from the inertial to the body frame at the step's end, J the
    right Jacobian of the step's rotation. The estimator knows how each reading follows from the
    truth, the noise of all of them and the deviation of the bias when switched on; of where the
    body looks at first it knows nothing, and of how it moves what the gyroscope tells. What is
    unknown of the sensor's unit is a state that stands still.

    Parameters
    ----------
    sun : ndarray, shape (N, 3)
        True unit vectors, body frame.
    information : ndarray, shape (N, 3 + P, 3 + P)
        As `attitude_information`; 0 where nothing is read, as in eclipse.
    motion : Motion
        Between the samples.
    known : ndarray, shape (P, P), optional
        Information on the P unknowns of the unit before the first sample.

    Returns
    -------
    ndarray, shape (N,)
        As `single_bound`.

    Raises
    ------
    ValueError
        Where times do not rise.
    """
    gyro, steps = motion.gyro, np.diff(motion.time_s)
    if not (steps > 0).all():
        raise ValueError("time_s must rise from sample to sample")
    turned = np.swapaxes(motion.turn, 1, 2)
    extra = information.shape[1] - 3
    inertial = np.zeros_like(information)
    inertial[:, :3, :3] = motion.turn
    inertial[:, 3:, 3:] = np.eye(extra)
    values, axes = np.linalg.eigh(np.swapaxes(inertial, 1, 2) @ information @ inertial)
    # rows C with C^T C the information: so many readings of unit noise
    rows = np.sqrt(np.maximum(values, 0.0))[:, :, None] * np.swapaxes(axes, 1, 2)
    rotation = np.radians(rotation_vectors_deg(motion.turn[1:], motion.turn[:-1]))
    drive = turned[1:] @ _right_jacobians(rotation) * steps[:, None, None]
    white = math.radians(gyro.angle_random_walk_deg_sqrt_h) ** 2 / (_HOUR_S * steps)
    walk = (math.radians(gyro.bias_walk_deg_h_sqrt_h) / _HOUR_S**1.5) ** 2 * steps
    one = np.eye(3)
    covariance = np.zeros((6 + extra, 6 + extra))
    covariance[:3, :3] = PRIOR_RAD**2 * one
    covariance[3:6, 3:6] = (math.radians(gyro.bias_deg_h) / _HOUR_S) ** 2 * one
    if known is not None:
        covariance[6:, 6:] = np.linalg.inv(known)
    attitude = np.empty((len(sun), 3, 3))
    forward = np.eye(6 + extra)
    for n, reading in enumerate(rows):
        if n:
            covariance[3:6, 3:6] += walk[n - 1] * one
            forward[:3, 3:6] = drive[n - 1]
            covariance = forward @ covariance @ forward.T
            covariance[:3, :3] += white[n - 1] * drive[n - 1] @ drive[n - 1].T
        if values[n, -1] > 0:
            covariance = _update(covariance, reading)
        attitude[n] = covariance[:3, :3]
    return _angles_deg(_levers(sun) @ motion.turn, attitude)


def _update(covariance: Floats, rows: Floats) -> Floats:
    """Covariance after readings of unit noise: rows (R, 3 + P) of the attitude and the unknowns."""
    slopes = np.zeros((len(rows), len(covariance)))
    slopes[:, :3], slopes[:, 6:] = rows[:, :3], rows[:, 3:]
    common = covariance @ slopes.T
    gain = np.linalg.solve(np.eye(len(rows)) + slopes @ common, common.T).T
    left = np.eye(len(covariance)) - gain @ slopes
    joseph = left @ covariance @ left.T + gain @ gain.T
    return np.asarray((joseph + joseph.T) / 2.0)


def _levers(sun: Floats) -> Floats:
    """(N, 2, 3) how far the Sun moves along its tangent axes as the body turns about its own."""
    axes = tangent_axes(sun)
    return np.stack([np.cross(axis, sun) for axis in axes], axis=1)


def _right_jacobians(rotation: Floats) -> Floats:
    """(N, 3, 3) turns at the end of rotations (N, 3), radians, by small additions to them."""
    angle = np.sqrt(np.einsum("ni,ni->n", rotation, rotation))
    still: NDArray[np.bool_] = angle < 1e-4
    safe = np.where(still, 1.0, angle)
    first = np.where(still, 0.5, (1.0 - np.cos(safe)) / safe**2)
    second = np.where(still, 1.0 / 6.0, (safe - np.sin(safe)) / safe**3)
    cross = np.zeros((len(rotation), 3, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        cross[:, i, j], cross[:, j, i] = -rotation[:, k], rotation[:, k]
    return np.asarray(
        np.eye(3) - first[:, None, None] * cross + second[:, None, None] * cross @ cross
    )


def _angles_deg(levers: Floats, attitude: Floats) -> Floats:
    """(N,) degrees of attitude covariances (N, 3, 3); inf where the direction is not known."""
    covariance = levers @ attitude @ np.swapaxes(levers, 1, 2)
    known = np.linalg.eigvalsh(covariance)[:, 1] < _UNKNOWN
    return np.degrees(np.sqrt(np.where(known, np.trace(covariance, axis1=1, axis2=2), np.inf)))
