"""Earth's magnetic field as a tilted dipole that turns with Earth."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats

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
