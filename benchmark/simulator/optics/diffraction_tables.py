"""What diffraction frames are looked up in, computed once a process for each aperture."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.optics.diffraction import Spectrum, fresnel, round_intensity
from benchmark.simulator.optics.plates import CoverGlass

#: Steps of a table in ``k a`` times the direction cosine, at the shortest wavelength: of the far
#: pattern, and of a shadow's fringes, of which many wavelengths and the Sun leave only the coarse
#: ones. The intensity holds no angular frequency above 2 in this coordinate.
_FAR_STEP, _NEAR_STEP = 0.2, 0.35
#: Tables end this far outside the shadow's edge, in the same coordinate.
_OUTSIDE = 60.0
#: Where the shadow outgrows the far pattern: first zero of J1.
_AIRY = 3.8317
_FRESNEL_STEPS, _FRESNEL_REACH = 64, 10


@dataclass(frozen=True)
class RoundPattern:
    """The light behind a round aperture, for incidences from 0 to `widest_deg`.

    Attributes
    ----------
    radius_mm
        Of the aperture.
    height_mm, glass
        From the aperture down to the detector, glass included.
    sun, spectrum
        What shines.
    reach_mm
        Distance from the spot's middle on the detector that the tables need to cover at normal
        incidence; beyond what they cover, light falls with the cube of the distance.
    widest_deg
        Largest incidence tabulated.
    """

    radius_mm: float
    height_mm: float
    glass: CoverGlass
    sun: SolarDisc
    spectrum: Spectrum
    reach_mm: float
    widest_deg: float

    @property
    def _wavelength_mm(self) -> float:
        return min(self.spectrum.wavelengths_nm) * 1e-6

    def layers(self) -> Floats:
        """(L, 2) thickness and index from the aperture down; the first is empty."""
        return layers(self.height_mm, self.glass)

    def numbers(self, sine: Floats, wavelength_mm: float) -> Floats:
        """(N, 2) Fresnel numbers along and across the plane of incidence."""
        return np.asarray(self.radius_mm**2 / (wavelength_mm * landing(sine, self.layers())[:, 1:]))

    def scales(self, sine: Floats) -> tuple[Floats, Floats]:
        """Return direction cosines a step of the tables (N, 2), and the tables' unit (N,).

        The steps follow the shadow where the aperture is many fringes wide, the far pattern where
        it is not, so that tables of neighbouring incidences resemble each other.
        """
        normal = self.numbers(np.zeros(1), self._wavelength_mm)
        here = self.numbers(sine, self._wavelength_mm)
        ratio = np.sqrt(
            (1.0 + (2.0 * math.pi / _AIRY * here) ** 2)
            / (1.0 + (2.0 * math.pi / _AIRY * normal) ** 2)
        )
        step = _FAR_STEP if float(normal[0, 0]) < 1.0 else _NEAR_STEP
        steps = ratio * (step * self._wavelength_mm / (2.0 * math.pi * self.radius_mm))
        far = math.pi**2 * here[:, 0] * here[:, 1]
        return steps, far / (1.0 + far)

    @property
    def nodes(self) -> int:
        """How many incidences are tabulated, equally spaced."""
        normal = float(self.numbers(np.zeros(1), self._wavelength_mm)[0, 0])
        return 8 + math.ceil(1.5 * normal)

    def place(self, sine: Floats) -> Floats:
        """Coordinate among the tables; that of `widest_deg` beyond it."""
        angles = np.array([math.asin(min(float(s), 1.0)) for s in sine])
        last = self.nodes - 1
        return np.minimum(angles / math.radians(self.widest_deg) * last, float(last))

    def tables(self) -> Floats:
        """(T, 2 n + 1, n + 1) light for equally spaced incidences, in units of `scales`.

        Rows go along the plane of incidence, -n to n steps from the chief ray away from the
        boresight; columns across it, 0 to n.
        """
        return _tables(self)

    def _table(self, sine: float, reach: int) -> Floats:
        from benchmark.simulator.kernels.diffraction import spread_over_sun  # noqa: PLC0415

        steps, unit = self.scales(np.array([sine]))
        centre = np.array([[sine, 0.0, math.sqrt(1.0 - sine * sine)]])
        points = self.sun.directions(centre)
        shifts = (points[0, :, :2] - centre[:, :2]) / steps
        _, shares = self.sun.quadrature()
        passed = self.glass.transmission(points)[0] / self.glass.transmission(centre)[0]
        weights = shares * points[0, :, 2] / centre[0, 2] * passed
        margin = math.ceil(float(np.abs(shifts).max())) + 3
        grid = np.arange(reach + margin + 1) * steps.T
        quadrant = np.zeros((grid.shape[1], grid.shape[1]))
        for wavelength, weight in zip(
            self.spectrum.wavelengths_nm, self.spectrum.weights, strict=True
        ):
            # positions in units of the radius: cosines times J over a
            along, across = self.numbers(np.array([sine]), wavelength * 1e-6)[0]
            turn = self.radius_mm / (wavelength * 1e-6)
            quadrant += weight * round_intensity(
                grid[0] * turn / along, grid[1] * turn / across, (along, across)
            )
        out = np.empty((2 * reach + 1, reach + 1))
        spread_over_sun(out, quadrant / unit[0], np.ascontiguousarray(shifts), weights, margin)
        return out


@lru_cache(maxsize=16)
def _tables(pattern: RoundPattern) -> Floats:
    steps, _ = pattern.scales(np.zeros(1))
    across = landing(np.zeros(1), pattern.layers())[0, 1]
    wave = min(pattern.spectrum.wavelengths_nm) * 1e-6 / (2.0 * math.pi * pattern.radius_mm)
    widest = min(pattern.reach_mm / across, pattern.radius_mm / across + _OUTSIDE * wave)
    reach = math.ceil(widest / float(steps[0, 0])) + 3
    last = pattern.nodes - 1
    found = [
        pattern._table(math.sin(math.radians(pattern.widest_deg) * node / last), reach)  # noqa: SLF001 - cached here: a dataclass method cannot be
        for node in range(pattern.nodes)
    ]
    tables = np.array(found)
    tables.flags.writeable = False
    return tables


def layers(height_mm: float, glass: CoverGlass) -> Floats:
    """(L, 2) thickness and index from an aperture down; the first is empty."""
    rows = [(height_mm - glass.thickness_mm, 1.0)]
    return np.array(rows + [(plate.thickness_mm, plate.index) for plate in glass.plates])


def landing(sine: Floats, stack: Floats) -> Floats:
    """(N, 3) where rays of these sines of incidence land, and J_r, J_t (see `diffraction`)."""
    square = stack[:, 1] ** 2 - sine[:, None] ** 2
    share = stack[:, 0] / np.sqrt(square)
    across = np.sum(share, axis=1)
    along = np.sum(share * stack[:, 1] ** 2 / square, axis=1)
    return np.stack([sine * across, along, across], axis=1)


@lru_cache(maxsize=1)
def fresnel_table() -> tuple[Floats, float]:
    """(2, M) auxiliary functions f and g of the Fresnel integrals, and steps a unit."""
    place = (np.arange(_FRESNEL_STEPS * _FRESNEL_REACH + 8) - 1.0) / _FRESNEL_STEPS
    integral = fresnel(place)
    left, right = 0.5 - integral.imag, 0.5 - integral.real
    phase = [math.pi / 2.0 * float(u) ** 2 for u in place]
    cosine = np.array([math.cos(p) for p in phase])
    sine = np.array([math.sin(p) for p in phase])
    table = np.stack([left * cosine - right * sine, right * cosine + left * sine])
    table.flags.writeable = False
    return table, float(_FRESNEL_STEPS)
