"""Earth's magnetic field: a tilted dipole that turns with Earth, and a quadrupole beside it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats
from benchmark.seeds import generator

#: Of Earth about its axis, against the stars.
EARTH_TURN_DEG_S = 360.98564736629 / 86_400.0


@dataclass(frozen=True)
class TiltedDipole:
    """The three dipole coefficients of the geomagnetic field.

    Attributes
    ----------
    g11_nt, h11_nt, g10_nt
        Gauss coefficients: the dipole along Earth-fixed x (Greenwich), y and z. The defaults are
        those of IGRF-13 for the epoch 2020.0 (igrf13coeffs.txt; Alken et al. 2021,
        doi:10.1186/s40623-020-01288-x): 29 806 nT at the magnetic equator, tilted by 9.4 deg.
        IGRF-14 has -1410.3, 4545.5 and -29 350.0 for 2025.0.
    radius_km
        They refer to.
    greenwich_deg
        Right ascension of Greenwich at time 0.
    """

    g11_nt: float = -1450.9
    h11_nt: float = 4652.5
    g10_nt: float = -29_404.8
    radius_km: float = 6371.2
    greenwich_deg: float = 0.0

    def inertial(self, position: Floats, distance_km: float, time_s: Floats) -> Floats:
        """Field in nT, (N, 3), inertial frame, at unit vectors (N, 3) from Earth's centre.

        ``B = (R/r)^3 (3 (g . r) r - g)`` with the coefficients as the vector g, turned with
        Earth to the times `time_s` (N,).
        """
        dipole = np.empty((len(time_s), 3))
        for n, moment in enumerate(time_s):
            turn = (self.greenwich_deg + EARTH_TURN_DEG_S * float(moment)) % 360.0
            c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
            dipole[n] = (
                c * self.g11_nt - s * self.h11_nt,
                s * self.g11_nt + c * self.h11_nt,
                self.g10_nt,
            )
        along = (
            dipole[:, 0] * position[:, 0]
            + dipole[:, 1] * position[:, 1]
            + dipole[:, 2] * position[:, 2]
        )
        strength = (self.radius_km / distance_km) ** 3
        return np.asarray(strength * (3.0 * along[:, None] * position - dipole))


@dataclass(frozen=True)
class Quadrupole:
    """The five coefficients of the field's second degree, by which a model may be wrong.

    Attributes
    ----------
    g20_nt, g21_nt, h21_nt, g22_nt, h22_nt
        Gauss coefficients, Schmidt's norm.
    radius_km
        They refer to.
    greenwich_deg
        Right ascension of Greenwich at time 0.
    """

    g20_nt: float
    g21_nt: float
    h21_nt: float
    g22_nt: float
    h22_nt: float
    radius_km: float = 6371.2
    greenwich_deg: float = 0.0

    @classmethod
    def drawn(cls, rms_nt: float, distance_km: float, *names: str | int) -> Quadrupole:
        """Return the one of this name, so strong on average at this distance from the centre.

        Its mean square over a sphere is ``3 (R/r)^8`` times the sum of the squared coefficients
        (Lowes 1966), which are independent and of equal size.
        """
        reach = (distance_km / cls.radius_km) ** 4
        size = rms_nt * reach / math.sqrt(15.0)
        normal = generator(*names).standard_normal(5).tolist()
        return cls(*(size * part for part in normal))

    def inertial(self, position: Floats, distance_km: float, time_s: Floats) -> Floats:
        """Field in nT, (N, 3), as `TiltedDipole.inertial` gives it.

        ``B = (R/r)^4 (5 (r . Q r) r - 2 Q r)`` with the coefficients as a symmetric tensor Q
        without trace, turned with Earth.
        """
        half = math.sqrt(3.0) / 2.0
        xx, yy = -self.g20_nt / 2 + half * self.g22_nt, -self.g20_nt / 2 - half * self.g22_nt
        xy, xz, yz = half * self.h22_nt, half * self.g21_nt, half * self.h21_nt
        strength = (self.radius_km / distance_km) ** 4
        field = np.empty((len(time_s), 3))
        for n, (moment, (px, py, z)) in enumerate(zip(time_s, position.tolist(), strict=True)):
            turn = (self.greenwich_deg + EARTH_TURN_DEG_S * float(moment)) % 360.0
            c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
            x, y = c * px + s * py, c * py - s * px
            across, along, up = (
                xx * x + xy * y + xz * z,
                xy * x + yy * y + yz * z,
                xz * x + yz * y + self.g20_nt * z,
            )
            outward = 5.0 * (x * across + y * along + z * up)
            east, north = outward * x - 2.0 * across, outward * y - 2.0 * along
            field[n] = c * east - s * north, s * east + c * north, outward * z - 2.0 * up
        return strength * field
