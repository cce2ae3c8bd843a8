"""How the satellite's body turns along its orbit; the body frame is the sensor's."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.flight.orbit import CircularOrbit


class Attitude(Protocol):
    """A law of motion."""

    def matrices(
        self, orbit: CircularOrbit, sun: Floats, time_s: Floats, turned_s: float = 0.0
    ) -> Floats:
        """(N, 3, 3) rotations from the inertial to the body frame.

        `time_s` (N,) counts as the orbit's does; the motion has been going on for `turned_s` at
        time 0. `sun` (3,) is the inertial direction to the Sun.
        """
        ...

    def describe(self) -> str:
        """In words, for a dataset's card."""
        ...


@dataclass(frozen=True)
class Tumble:
    """Free motion of a body with one axis of symmetry, its z axis: precession and spin.

    The z axis goes round the fixed angular momentum at `precession_deg_s`, always `nutation_deg`
    from it, while the body spins about z at ``precession cos(nutation) (I_t / I_z - 1)`` (Euler's
    equations without torque).

    Attributes
    ----------
    momentum_sun_deg
        Angle between angular momentum and Sun, kept by whoever set the satellite spinning.
    inertia_ratio
        ``I_z / I_t``, in (0, 2): moments of inertia along and across the axis of symmetry.
    precession_phase_deg, spin_phase_deg
        Of the two motions at time 0.
    """

    momentum_sun_deg: float
    nutation_deg: float
    precession_deg_s: float
    inertia_ratio: float
    precession_phase_deg: float = 0.0
    spin_phase_deg: float = 0.0

    def __post_init__(self) -> None:
        if not 0 < self.inertia_ratio < 2:
            raise ValueError(f"inertia_ratio must be in (0, 2); got {self.inertia_ratio}")
        if not 0 < self.momentum_sun_deg < 180:
            raise ValueError(f"momentum_sun_deg must be in (0, 180); got {self.momentum_sun_deg}")

    @property
    def spin_deg_s(self) -> float:
        """Spin about the body's z axis."""
        slope = math.cos(math.radians(self.nutation_deg)) * (1.0 / self.inertia_ratio - 1.0)
        return self.precession_deg_s * slope

    def matrices(
        self, orbit: CircularOrbit, sun: Floats, time_s: Floats, turned_s: float = 0.0
    ) -> Floats:
        """(N, 3, 3) ``R_z(spin) R_x(nutation) R_z(precession)`` after the momentum's frame."""
        del orbit
        frame = _momentum_frame(sun, math.radians(self.momentum_sun_deg))
        c, s = math.cos(math.radians(self.nutation_deg)), math.sin(math.radians(self.nutation_deg))
        out = np.empty((len(time_s), 3, 3))
        for n, moment in enumerate(time_s):
            since = turned_s + float(moment)
            first = math.radians((self.precession_phase_deg + self.precession_deg_s * since) % 360)
            last = math.radians((self.spin_phase_deg + self.spin_deg_s * since) % 360)
            c1, s1, c3, s3 = math.cos(first), math.sin(first), math.cos(last), math.sin(last)
            turn = (
                (c3 * c1 - s3 * c * s1, c3 * s1 + s3 * c * c1, s3 * s),
                (-s3 * c1 - c3 * c * s1, -s3 * s1 + c3 * c * c1, c3 * s),
                (s * s1, -s * c1, c),
            )
            for i, (x, y, z) in enumerate(turn):
                out[n, i] = x * frame[0] + y * frame[1] + z * frame[2]
        return out

    def describe(self) -> str:
        """In words."""
        return (
            f"torque-free tumbling, precession {self.precession_deg_s:g} deg/s at "
            f"{self.nutation_deg:g} deg from the angular momentum, spin {self.spin_deg_s:.3g} "
            f"deg/s, momentum {self.momentum_sun_deg:g} deg from the Sun"
        )


def _momentum_frame(sun: Floats, angle: float) -> tuple[Floats, Floats, Floats]:
    """Axes with the momentum last and the Sun in the plane of first and last.

    The momentum is tilted from the Sun towards Earth's north pole.
    """
    x, y, z = (float(part) for part in sun)
    flat = math.hypot(x, y)
    if flat == 0:
        raise ValueError("the Sun must not stand over Earth's pole")
    north = np.array([-x * z / flat, -y * z / flat, flat])
    momentum = math.cos(angle) * sun + math.sin(angle) * north
    first = math.sin(angle) * sun - math.cos(angle) * north
    second = np.cross(momentum, first)
    return first, second, momentum


def turn_frame(matrices: Floats, vectors: Floats) -> Floats:
    """Turn unit vectors (N, 3) or (3,) by rotations (N, 3, 3); unit again to the last bit.

    Written out: the order of additions must not depend on the linear algebra library.
    """
    out = rotate(matrices, vectors)
    return np.asarray(out / np.sqrt(out[:, :1] ** 2 + out[:, 1:2] ** 2 + out[:, 2:] ** 2))


def rotate(matrices: Floats, vectors: Floats) -> Floats:
    """Turn vectors (N, 3) or (3,) of any length by rotations (N, 3, 3)."""
    x, y, z = vectors[..., 0:1], vectors[..., 1:2], vectors[..., 2:3]
    return np.asarray(matrices[:, :, 0] * x + matrices[:, :, 1] * y + matrices[:, :, 2] * z)
