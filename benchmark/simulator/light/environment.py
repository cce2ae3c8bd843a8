"""What reaches the sensor besides the mean Sun: the seasons, stray light, sunlit Earth."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.light.memory import digest_of, memory
from benchmark.simulator.light.sun_disc import tangent_axes
from benchmark.simulator.readout.detectors import RESPONSES, Response


@dataclass(frozen=True)
class Irradiance:
    """How direct and stray light vary from sample to sample, both Gaussian.

    Attributes
    ----------
    spread
        Relative standard deviation of sunlight; 0.0236 is the seasons' (orbital eccentricity
        0.0167, irradiance ``1 + 2 e cos``, root mean square).
    stray, stray_spread
        Mean and standard deviation of uniform stray light, in units of mean sunlight at normal
        incidence.
    """

    spread: float = 0.0236
    stray: float = 0.0
    stray_spread: float = 0.0

    def __post_init__(self) -> None:
        if min(self.spread, self.stray, self.stray_spread) < 0:
            raise ValueError("spread, stray and stray_spread must not be negative")

    def draw(self, count: int, generator: np.random.Generator) -> tuple[Floats, Floats]:
        """Sunlight and stray light of `count` samples, (N,) each."""
        normal = generator.standard_normal((count, 2))
        return 1.0 + self.spread * normal[:, 0], self.stray + self.stray_spread * normal[:, 1]


@dataclass(frozen=True)
class Earth:
    """A sunlit Lambert sphere below a satellite on a low circular orbit.

    Attributes
    ----------
    reflectance
        Share of sunlight sent back, everywhere the same; 0.3 is Earth's mean (Bond) albedo.
    altitude_km, radius_km
        Of the orbit above the surface, and of Earth.
    rings, spokes
        Quadrature over the visible disc: Gauss nodes in the cosine of the nadir angle, equal
        steps in azimuth.
    """

    reflectance: float = 0.3
    altitude_km: float = 600.0
    radius_km: float = 6371.0
    rings: int = 16
    spokes: int = 48

    def __post_init__(self) -> None:
        if not 0 <= self.reflectance <= 1:
            raise ValueError(f"reflectance must be in [0, 1]; got {self.reflectance}")
        if not (self.altitude_km > 0 and self.radius_km > 0):
            raise ValueError("altitude_km and radius_km must be positive")

    @property
    def half_angle_deg(self) -> float:
        """Half angle under which Earth is seen."""
        return math.degrees(math.asin(self.radius_km / (self.radius_km + self.altitude_km)))

    def draw_nadir(self, sun: Floats, generator: np.random.Generator) -> Floats:
        """Directions to Earth's centre (N, 3), body frame, for Sun directions `sun` (N, 3).

        The satellite is uniformly anywhere on the orbit's sphere from which the Sun is seen
        (outside Earth's cylindrical shadow), its attitude independent of its position.
        """
        nadir = np.empty_like(sun)
        reach = self.radius_km / (self.radius_km + self.altitude_km)
        first, second = tangent_axes(sun)
        for n in range(len(sun)):
            while True:
                cosine = 2.0 * generator.random() - 1.0  # of the angle Sun - Earth's centre - craft
                sine = math.sqrt(1.0 - cosine * cosine)
                if cosine > 0.0 or sine > reach:
                    break
            x, y, _ = uniform_direction(generator)
            norm = math.sqrt(x * x + y * y)
            nadir[n] = -cosine * sun[n] + sine * (x * first[n] + y * second[n]) / norm
        return nadir

    def sent_back(self, ground: Floats) -> Floats | float:  # noqa: ARG002 - of an Earth with clouds
        """Share of sunlight that ground (P, 3) sends back; unit vectors from Earth's centre."""
        return self.reflectance

    def tables(self) -> tuple[Floats, Floats]:
        """Numbers (5,) and cloud waves (M, 4) as `benchmark.simulator.kernels.earth` has them."""
        reach = self.radius_km / (self.radius_km + self.altitude_km)
        return np.array([reach, self.reflectance, self.reflectance, 0.0, 1.0]), np.empty((0, 4))

    def response(self, sun: Floats, nadir: Floats, normals: Floats, response: Response) -> Floats:
        """Response (N, K) of detector elements facing `normals` (K, 3) to the light from Earth.

        In units of the response to direct sunlight at normal incidence: every visible, sunlit
        patch has the radiance ``reflectance cos(sun zenith) / pi`` and is weighted by the
        element's angular response, integrated over the solid angle of the visible disc. Only
        photodiodes facing a patch see it (eq:mnoise, with light counted positive).
        """
        # splits and conditions see the same Earth
        return memory.render(
            ("Earth.response", self, response, digest_of(sun, nadir, normals)),
            lambda: self._response(sun, nadir, normals, response),
        )

    def _response(self, sun: Floats, nadir: Floats, normals: Floats, response: Response) -> Floats:
        nodes, shares = np.polynomial.legendre.leggauss(self.rings)
        edge = math.cos(math.radians(self.half_angle_deg))
        cos_eta = edge + (1.0 - edge) * (nodes + 1.0) / 2.0
        sin_eta = np.sqrt(1.0 - cos_eta**2)
        turns = [2.0 * math.pi * (step + 0.5) / self.spokes for step in range(self.spokes)]
        circle = np.array([(math.cos(turn), math.sin(turn)) for turn in turns])
        solid_angle = np.repeat(shares * (1.0 - edge) / 2.0, self.spokes) * (
            2.0 * math.pi / self.spokes
        )
        local = np.empty((self.rings * self.spokes, 3))
        local[:, 0] = (sin_eta[:, None] * circle[:, 0]).ravel()
        local[:, 1] = (sin_eta[:, None] * circle[:, 1]).ravel()
        local[:, 2] = np.repeat(cos_eta, self.spokes)
        # distance along each line of sight to the surface, and the surface normal there
        centre = self.radius_km + self.altitude_km
        half = centre * local[:, 2]
        distance = half - np.sqrt(np.maximum(half**2 - centre**2 + self.radius_km**2, 0.0))
        first, second = tangent_axes(nadir)
        out = np.empty((len(sun), len(normals)))
        for n in range(len(sun)):
            sight = local[:, :1] * first[n] + local[:, 1:2] * second[n] + local[:, 2:] * nadir[n]
            ground = (distance[:, None] * sight - centre * nadir[n]) / self.radius_km
            lit = np.maximum(_dot(ground, sun[n]), 0.0)
            day, radiance = lit > 0.0, np.zeros(len(lit))
            radiance[day] = self.sent_back(ground[day]) / math.pi * lit[day] * solid_angle[day]
            for k in range(len(normals)):
                seen = RESPONSES[response](_dot(sight, normals[k]))
                out[n, k] = float(np.sum(radiance * seen))
        return out


def _dot(vectors: Floats, other: Floats) -> Floats:
    # written out: the order of additions must not depend on the linear algebra library
    return np.asarray(
        vectors[:, 0] * other[0] + vectors[:, 1] * other[1] + vectors[:, 2] * other[2]
    )


def uniform_direction(generator: np.random.Generator) -> tuple[float, float, float]:
    """Draw a unit vector uniform over the sphere (Marsaglia's rejection: square roots only)."""
    while True:
        x, y = 2.0 * generator.random() - 1.0, 2.0 * generator.random() - 1.0
        square = x * x + y * y
        if 0.0 < square < 1.0:
            break
    root = 2.0 * math.sqrt(1.0 - square)
    return x * root, y * root, 1.0 - 2.0 * square
