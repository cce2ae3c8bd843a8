"""Calibration as it happens: a turntable and a lamp that are nearly what they should be.

The sensor sees the lamp where it is; what a method is given is what the bench says. The
directions of a split stay the true ones, and the bench's readings lie off them, so that frames
are rendered alike whatever the bench.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar, cast

import numpy as np

from algorithms.contract import Floats
from benchmark.seeds import generator
from benchmark.simulator.light.sun_disc import SolarDisc

Name = str | int
Sensor = TypeVar("Sensor")

#: Data sets that have a condition of this name beside ``nominal``, alike but for a perfect
#: calibration. A handful, of several detectors: every condition costs a benchmark's time.
IDEAL = "ideal-calibration"
SHOWN_IDEAL = (
    "ccd-n-slit",
    "ccd-orbit",
    "cmos-single-aperture",
    "pd-maskless-cube",
    "pd-orbit",
    "qpd-single-aperture",
)


class Reference(Protocol):
    """What tells a method where the Sun was while it was calibrated."""

    def report(self, sun: Floats, *names: Name) -> Floats:
        """(N, 3) unit vectors that it says, for true ones (N, 3), in the order of the poses."""
        ...

    def systematic_deg(self, sun: Floats) -> float:
        """Root mean square, over directions (N, 3) and what may be drawn, of its fixed error."""
        ...


@dataclass(frozen=True)
class Bench:
    """A two-axis turntable before a lamp; every size a standard deviation over benches and units.

    Outer axis x, inner axis y: the Sun stands at ``(sin b, cos b sin a, cos b cos a)`` for the
    outer angle a and the inner angle b, which covers the sphere. The sizes of the defaults are
    round numbers: a turntable good to 0.02 deg absolutely, a class A solar simulator whose
    collimator shows it as wide as the Sun. What is not simulated: that rays which diverge reach
    holes some millimetres apart at other angles, and a lamp's spectrum but for its level.

    Attributes
    ----------
    axis_random_deg
        How far each axis stops from what it reads, anew in every pose.
    mounting_deg
        Fixed rotation of the sensor on the table, about each of its three axes; the axes' zeros
        are part of it.
    squareness_deg
        By how much the angle between the axes is not a right one.
    eccentricity_deg
        Of each encoder: one turn's harmonic, root mean square at any angle.
    lamp_level
        Relative error of its intensity against the Sun's mean, spectrum included.
    lamp_drift_per_hour
        Relative change of its intensity, steady.
    pose_s
        From one pose to the next, in the order of the split.
    lamp_uneven
        Relative change of light along each component of the Sun's direction: the sensor's face is
        not where the axes cross, and moves through a beam that is not even.
    lamp_flicker
        Relative change of intensity from pose to pose, random.
    lamp_diameter_deg
        Full angle under which the sensor sees it.
    """

    axis_random_deg: float = 0.003
    mounting_deg: float = 0.01
    squareness_deg: float = 0.005
    eccentricity_deg: float = 0.005
    lamp_level: float = 0.02
    lamp_drift_per_hour: float = 0.01
    pose_s: float = 5.0
    lamp_uneven: float = 0.01
    lamp_flicker: float = 0.002
    lamp_diameter_deg: float = 0.533

    def __post_init__(self) -> None:
        for name, value in dataclasses.asdict(self).items():
            if not (math.isfinite(value) and value >= 0):
                raise ValueError(f"{name} of a bench must be finite, not negative; got {value}")

    def report(self, sun: Floats, *names: Name) -> Floats:
        """(N, 3) unit vectors that the table's encoders give, for true ones (N, 3).

        `names` are those of dataset and unit; poses in another number have other random errors,
        the same in their order.
        """
        built = self.draw_errors(*names)
        random = math.radians(self.axis_random_deg)
        stops = random * generator(*names, "axes").standard_normal((len(sun), 2))
        turn = rotation(*(math.radians(angle) for angle in built.mounting_deg))
        skew = math.radians(built.squareness_deg)
        c, s = math.cos(skew), math.sin(skew)
        found = np.empty((len(sun), 3))
        for n, ((x, y, z), (first, second)) in enumerate(
            zip(sun.tolist(), stops.tolist(), strict=True)
        ):
            outer, inner = math.atan2(y, z), math.asin(min(max(x, -1.0), 1.0))
            outer += first + _harmonic(built.outer_deg, outer)
            inner += second + _harmonic(built.inner_deg, inner)
            across, up = math.sin(inner), math.cos(inner)
            right, aside = c * across, s * across
            ca, sa = math.cos(outer), math.sin(outer)
            found[n] = right, ca * aside + sa * up, ca * up - sa * aside
        return turned_by(turn, found)

    def light(self, sun: Floats, *names: Name) -> Floats:
        """(N,) intensity of the lamp in units of mean sunlight, pose after pose; never below 0."""
        built = self.draw_errors(*names)
        flicker = generator(*names, "flicker").standard_normal(len(sun))
        hours = self.pose_s / 3600.0 * np.arange(len(sun), dtype=np.float64)
        x, y, z = built.uneven
        even = 1.0 + x * sun[:, 0] + y * sun[:, 1] + z * (sun[:, 2] - 1.0)
        steady = (1.0 + built.level) * (1.0 + built.drift_per_hour * hours)
        return np.asarray(np.maximum(steady * even * (1.0 + self.lamp_flicker * flicker), 0.0))

    def systematic_deg(self, sun: Floats) -> float:
        """Root mean square of the fixed error of the readings over directions (N, 3), degrees.

        Of the sizes, not of what one bench drew: a user does not know which one he has. With
        independent parts of standard deviation r (mounting), q (squareness) and e (eccentricity)
        it is the root of ``2 r^2 + q^2 <sin^2 b> + e^2 (1 + <cos^2 b>)``, where ``sin b = s_x``.
        """
        sine = math.fsum((sun[:, 0] ** 2).tolist()) / len(sun)
        return math.sqrt(
            2.0 * self.mounting_deg**2
            + self.squareness_deg**2 * sine
            + self.eccentricity_deg**2 * (2.0 - sine)
        )

    def draw_errors(self, *names: Name) -> BenchErrors:
        """Return the fixed errors while the unit of this name is on it."""
        normal = generator(*names, "errors").standard_normal(13).tolist()
        mounted, size, uneven = self.mounting_deg, self.eccentricity_deg, self.lamp_uneven
        return BenchErrors(
            mounting_deg=(mounted * normal[0], mounted * normal[1], mounted * normal[2]),
            squareness_deg=self.squareness_deg * normal[3],
            outer_deg=(size * normal[4], size * normal[5]),
            inner_deg=(size * normal[6], size * normal[7]),
            level=self.lamp_level * normal[8],
            drift_per_hour=self.lamp_drift_per_hour * normal[9],
            uneven=(uneven * normal[10], uneven * normal[11], uneven * normal[12]),
        )

    def seen_by(self, sensor: Sensor) -> Sensor:
        """Return the sensor with the lamp's disc in the place of the Sun's, where it has one."""
        return cast("Sensor", _before_lamp(sensor, self.lamp_diameter_deg))


@dataclass(frozen=True)
class BenchErrors:
    """Fixed errors of one bench and of one unit's place on it, as `Bench` has their sizes.

    `outer_deg` and `inner_deg` are the coefficients of cosine and sine of an axis' angle.
    """

    mounting_deg: tuple[float, float, float]
    squareness_deg: float
    outer_deg: tuple[float, float]
    inner_deg: tuple[float, float]
    level: float
    drift_per_hour: float
    uneven: tuple[float, float, float]


#: What data sets on the ground are calibrated on.
STANDARD_BENCH = Bench()


def rotation(x: float, y: float, z: float) -> Floats:
    """(3, 3) rotation about the vector (x, y, z) by its length, radians (Rodrigues)."""
    angle = math.sqrt(x * x + y * y + z * z)
    if angle == 0.0:
        return np.eye(3)
    x, y, z = x / angle, y / angle, z / angle
    c, s, v = math.cos(angle), math.sin(angle), 1.0 - math.cos(angle)
    return np.array(
        [
            (c + x * x * v, x * y * v - z * s, x * z * v + y * s),
            (y * x * v + z * s, c + y * y * v, y * z * v - x * s),
            (z * x * v - y * s, z * y * v + x * s, c + z * z * v),
        ]
    )


def turned_by(turn: Floats, vectors: Floats) -> Floats:
    """Turn vectors (N, 3) by a rotation (3, 3); unit to the last bit.

    Written out: the order of additions must not depend on the linear algebra library.
    """
    x, y, z = vectors[:, :1], vectors[:, 1:2], vectors[:, 2:]
    out = x * turn[:, 0] + y * turn[:, 1] + z * turn[:, 2]
    return np.asarray(out / np.sqrt(out[:, :1] ** 2 + out[:, 1:2] ** 2 + out[:, 2:] ** 2))


def _harmonic(size_deg: tuple[float, float], angle: float) -> float:
    """Error of an encoder at an angle, radians."""
    cosine, sine = size_deg
    return math.radians(cosine * math.cos(angle) + sine * math.sin(angle))


def _before_lamp(value: Any, diameter_deg: float) -> Any:
    if isinstance(value, SolarDisc):
        # a point source stays one: the sensor's light is not integrated over a disc at all
        same = value.diameter_deg in (0.0, diameter_deg)
        return value if same else dataclasses.replace(value, diameter_deg=diameter_deg)
    if not dataclasses.is_dataclass(value) or isinstance(value, type):
        return value
    parts = {f.name: getattr(value, f.name) for f in dataclasses.fields(value) if f.init}
    seen = {name: _before_lamp(part, diameter_deg) for name, part in parts.items()}
    changed = {name: part for name, part in seen.items() if part is not parts[name]}
    return dataclasses.replace(value, **changed) if changed else value
