"""Circular low orbits: where the satellite is, where the Sun stands, when Earth hides it.

Inertial frame: z along Earth's axis, x towards the vernal equinox. Angles go through the C library,
never NumPy's processor-dependent sines, so that the same orbit comes out on every machine.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats

GRAVITY_KM3_S2 = 398_600.4418
EQUATOR_KM = 6378.137
OBLATENESS_J2 = 1.08263e-3
OBLIQUITY_DEG = 23.4393
YEAR_DAYS = 365.2422
DAY_S = 86_400.0
ECCENTRICITY = 0.0167
#: From the March equinox to the next perihelion (20 March to 3 January).
PERIHELION_DAY = 289.0


def sun_direction(day: float) -> Floats:
    """(3,) inertial unit vector to the Sun `day` days after the March equinox.

    Earth's orbit counts as a circle here: at most 2 deg off along the ecliptic, nothing across.
    """
    longitude, tilt = math.tau * day / YEAR_DAYS, math.radians(OBLIQUITY_DEG)
    sine = math.sin(longitude)
    return np.array([math.cos(longitude), sine * math.cos(tilt), sine * math.sin(tilt)])


def sunlight(day: float) -> float:
    """Irradiance in units of the yearly mean, ``1 + 2 e cos``, `day` days after the equinox."""
    return 1.0 + 2.0 * ECCENTRICITY * math.cos(math.tau * (day - PERIHELION_DAY) / YEAR_DAYS)


@dataclass(frozen=True)
class CircularOrbit:
    """A circular orbit around a round Earth; node and phase are those at time 0.

    Attributes
    ----------
    altitude_km, radius_km
        Of the orbit above the surface, and of Earth.
    inclination_deg
        Of the orbit's plane to the equator.
    node_deg
        Right ascension of the ascending node.
    phase_deg
        Angle from the ascending node to the satellite, along its motion.
    """

    altitude_km: float = 600.0
    inclination_deg: float = 97.79
    node_deg: float = 0.0
    phase_deg: float = 0.0
    radius_km: float = 6371.0

    def __post_init__(self) -> None:
        if not (self.altitude_km > 0 and self.radius_km > 0):
            raise ValueError(
                f"altitude_km and radius_km must be positive; got {self.altitude_km} "
                f"and {self.radius_km}"
            )
        if not 0 <= self.inclination_deg <= 180:
            raise ValueError(f"inclination_deg must be in [0, 180]; got {self.inclination_deg}")

    @property
    def distance_km(self) -> float:
        """From Earth's centre."""
        return self.radius_km + self.altitude_km

    @property
    def period_s(self) -> float:
        """Kepler: ``2 pi sqrt(a^3 / mu)``."""
        return math.tau * math.sqrt(self.distance_km**3 / GRAVITY_KM3_S2)

    @property
    def node_rate_deg_day(self) -> float:
        """Turn of the orbit's plane by Earth's oblateness, ``-3/2 J2 n (R/a)^2 cos(i)``."""
        turns_a_day = 360.0 * DAY_S / self.period_s
        ratio = (EQUATOR_KM / self.distance_km) ** 2
        return -1.5 * OBLATENESS_J2 * turns_a_day * ratio * math.cos(self._inclination)

    def after(self, days: float) -> CircularOrbit:
        """Return the orbit with node and phase moved on to `days` later."""
        return replace(
            self,
            node_deg=(self.node_deg + self.node_rate_deg_day * days) % 360.0,
            phase_deg=(self.phase_deg + 360.0 * days * DAY_S / self.period_s) % 360.0,
        )

    @property
    def _inclination(self) -> float:
        return math.radians(self.inclination_deg)

    def axes(self) -> tuple[Floats, Floats, Floats]:
        """Inertial unit vectors (3,): to the ascending node, 90 deg on, normal to the plane."""
        c, s = math.cos(math.radians(self.node_deg)), math.sin(math.radians(self.node_deg))
        ci, si = math.cos(self._inclination), math.sin(self._inclination)
        return (
            np.array([c, s, 0.0]),
            np.array([-s * ci, c * ci, si]),
            np.array([s * si, -c * si, ci]),
        )

    def phases(self, time_s: Floats) -> Floats:
        """(N,) radians from the ascending node, not wrapped, at times (N,)."""
        return np.asarray(math.radians(self.phase_deg) + math.tau / self.period_s * time_s)

    def position(self, time_s: Floats) -> Floats:
        """(N, 3) unit vectors from Earth's centre to the satellite; nadir is their negative."""
        return self._in_plane(self.phases(time_s))

    def velocity(self, time_s: Floats) -> Floats:
        """(N, 3) unit vectors along the motion."""
        return self._in_plane(self.phases(time_s) + math.pi / 2.0)

    def _in_plane(self, phases: Floats) -> Floats:
        node, across, _ = self.axes()
        turns = np.array([(math.cos(phase), math.sin(phase)) for phase in phases]).reshape(-1, 2)
        return np.asarray(turns[:, :1] * node + turns[:, 1:] * across)

    def sun_elevation_deg(self, sun: Floats) -> float:
        """Angle of the Sun (3,) above the orbit's plane (its beta angle)."""
        x, y, z = self.axes()[2]
        height = x * float(sun[0]) + y * float(sun[1]) + z * float(sun[2])
        return math.degrees(math.asin(min(max(height, -1.0), 1.0)))

    def eclipse_half_width(self, sun: Floats) -> float:
        """Half the arc in Earth's cylindrical shadow, radians; 0 where none of it is.

        ``cos(half width) = sqrt(a^2 - R^2) / (a cos(beta))``; the share of the orbit in eclipse is
        the half width over pi.
        """
        cosine = math.sqrt(self.distance_km**2 - self.radius_km**2) / self.distance_km
        level = math.cos(math.radians(self.sun_elevation_deg(sun)))
        return math.acos(cosine / level) if level > cosine else 0.0

    def eclipse_entry(self, sun: Floats) -> float:
        """Phase, radians, at which the satellite enters the shadow (its middle without one)."""
        node, across, _ = self.axes()
        x = sum(float(a * b) for a, b in zip(node, sun, strict=True))
        y = sum(float(a * b) for a, b in zip(across, sun, strict=True))
        return math.atan2(-y, -x) - self.eclipse_half_width(sun)

    def eclipsed(self, time_s: Floats, sun: Floats) -> NDArray[np.bool_]:
        """Whether (N,) the satellite is in Earth's shadow, a cylinder: no penumbra.

        The penumbra of a low orbit lasts some 10 s, less than what samples are apart.
        """
        place = self.position(time_s)
        along = place[:, 0] * sun[0] + place[:, 1] * sun[1] + place[:, 2] * sun[2]
        across = self.distance_km * np.sqrt(np.maximum(1.0 - along**2, 0.0))
        return np.asarray((along < 0) & (across < self.radius_km))
