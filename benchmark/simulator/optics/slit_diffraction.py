"""Diffraction behind long slits: what a linear array sees of it, and what is left out.

`diffraction` has the phase of the light from a point q of the mask to a point ``S + delta`` of the
detector, with ``J = J_r rr' + J_t tt'`` about the chief ray. Over a slit long against
``sqrt(lambda J)`` the integral along it is one of stationary phase: what it leaves of ``J`` is
``J_w = n' J n`` (the Schur complement of the inverse), n the normal of the slit's shadow. So each
point of the Sun gives the pattern of an endless slit, ::

    I(w) = |F(u_+) - F(u_-)|^2 / 2,   u_+- = sqrt(2 / (lambda J_w)) (w +- a),   F = C + i S,

w the distance from the middle of the shadow, a its half width, in units of the open light. A slit's
edge is as wide as ``sqrt(lambda J_w)``, whatever its Fresnel number ``a^2 / (lambda J_w)``. On an
inclined plate ``J_w`` is that of the height above the array at which its light passes.

- Oblique light: the next term of the phase, cubic, moves the fringes of an edge at q to
  ``x (1 + b x)``, ``x = w - q``, ``b = -J_w' / (6 J_w^2)``, the prime a derivative by the direction
  cosine along n. An edge's wave falls as 1/x all the same, so that ``F(u)`` becomes
  ``F(u) - (i b / pi) sqrt(lambda J_w / 2) exp(i pi u^2 / 2)``. Without it spots at 60 deg stood up
  to 0.02 pixels off.
- Foil: the two displaced rims have an effective slit in common, taken at the foil's middle. The
  outer rim of either side, a distance d from the light's edge, cuts off what the inner one bends
  beyond it, which adds ``-+ sqrt(2 / (lambda J_w)) m exp(i pi u^2 / 2)`` to F, ``m`` the integral
  of the inner rim's shadow from d on (at d = 0 ``0.11 (1 + i) sqrt(lambda t)``; less for what is
  bent far: ``m / (1 + sqrt(2 t / h) |u|)``). Left out, that came to 2.5 % of peak of a point for
  0.05 mm of foil 2.5 mm up; what remains is 0.4 %.
- Glass: ``J`` is that of all layers (`diffraction_tables.landing`), the landing point is Snell's.
- Sun: its points add up, each with its own landing point, light, width and, to first order, ``J``.
  Where the light falls along an array depends on one direction on the disc: chords across that
  direction are taken together, at their mean.
- Slits that end on the array: their light is that of the endless slit times the share of the
  pixels' height between their geometric ends, 1 in all standard data sets.

Left out: polarisation, diffraction at a slit's ends, and interference of light of different slits,
which are farther apart than sunlight is coherent (60 um).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.light.memory import memory
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.optics.diffraction import Spectrum
from benchmark.simulator.optics.diffraction_tables import fresnel_table

#: Samples whose patterns are kept at a time, some 50 kB each.
_AT_ONCE = 64


@dataclass(frozen=True)
class SlitProfiles:
    """Light along one linear array behind slits; lengths in pixels but for `pitch_mm`.

    Attributes
    ----------
    slits
        (A, 7) `Mask.table`, u along the array and v across it.
    layers
        (L, 2) thickness and index of what lies under the foil's middle, the empty gap first.
    sun, spectrum
        What shines.
    pitch_mm
        A pixel.
    plate
        Cosine and sine of the plate's inclination, its thickness, its offset along u and v, and
        half the height of the array.
    """

    slits: Floats
    layers: Floats
    sun: SolarDisc
    spectrum: Spectrum
    pitch_mm: float
    plate: tuple[float, float, float, float, float, float]

    def light(self, sun: Floats, columns: int, fill_factor: float) -> Floats:
        """(N, columns) light averaged over each pixel, for (N, 3) directions (u, v, boresight)."""
        from benchmark.simulator.kernels.slit_patterns import (  # noqa: PLC0415 - Numba on demand
            grids,
            patterns,
        )
        from benchmark.simulator.kernels.slit_profiles import (  # noqa: PLC0415 - Numba on demand
            expose_diffracted,
            shapes,
        )

        # slits of one half width, slant and length share a pattern
        alike = np.lexsort((self.slits[:, 1], self.slits[:, 4], self.slits[:, 6], self.slits[:, 3]))
        slits = np.ascontiguousarray(self.slits[alike])
        new = np.any(slits[1:, [3, 4, 6]] != slits[:-1, [3, 4, 6]], axis=1)
        firsts = np.concatenate([[0], np.flatnonzero(new) + 1, [len(slits)]]).astype(np.int64)
        pairs = zip(self.spectrum.wavelengths_nm, self.spectrum.weights, strict=True)
        waves = np.array([(nm * 1e-6 / self.pitch_mm, weight) for nm, weight in sorted(pairs)])
        mean = math.fsum(wave * weight for wave, weight in waves.tolist())
        widest = 2.0 * float(slits[:, 3].max()) * self.pitch_mm
        disc = chords(self.sun, widest, min(self.spectrum.wavelengths_nm) * 1e-6)
        flux = np.empty((len(sun), columns))
        for first in range(0, len(sun), _AT_ONCE):
            some = sun[first : first + _AT_ONCE]
            shape = np.empty((len(some), len(firsts) - 1, 6))
            shapes(shape, slits[firsts[:-1]], some, self.layers, self.plate)
            rows = np.ascontiguousarray(shape[..., 1:].reshape(-1, 5))
            grid = np.empty((len(rows), 3), dtype=np.int64)
            grids(grid, rows, waves)
            sizes = np.where(grid[:, 0] > 0, 2 * grid[:, 1] + 1, 0)
            starts = np.cumsum(sizes) - sizes
            known = np.empty((4, int(sizes.sum())))
            patterns(known, (grid, starts), rows, waves, fresnel_table())
            expose_diffracted(
                flux[first : first + _AT_ONCE],
                (slits, firsts),
                (some, disc, self.layers),
                (known, grid, starts, shape),
                (-columns / 2.0, fill_factor, mean, self.plate),
            )
        return flux


def chords(disc: SolarDisc, widest_mm: float, wavelength_mm: float) -> Floats:
    """(Q, 3) offset of chords of the Sun's disc, root mean square along them, share of the light.

    Offsets are sines of angles from the disc's middle. As many chords as the finest fringes of a
    slit `widest_mm` wide ask for: ``2 r w / lambda`` of them pass over a pixel while the Sun, of
    angular radius r, passes its own diameter.
    """
    return _chords(disc, widest_mm, wavelength_mm)


@memory.tables(32)
def _chords(disc: SolarDisc, widest_mm: float, wavelength_mm: float) -> Floats:
    if disc.diameter_deg == 0.0:
        return np.array([[0.0, 0.0, 1.0]])
    reach = math.sin(math.radians(disc.diameter_deg / 2.0))
    count = 8 + math.ceil(0.6 * 2.0 * math.pi * reach * widest_mm / wavelength_mm)
    nodes, weights = np.polynomial.legendre.leggauss(count)
    plain, dimmed = 1.0 - disc.limb_darkening, disc.limb_darkening
    rows = []
    for node, weight in zip(nodes, weights, strict=True):
        angle = math.pi / 2.0 * float(node)
        half = math.cos(angle)  # of the chord
        # integrals over the chord of 1 - u + u sqrt(half^2 - y^2), and of it times y^2
        light = 2.0 * plain * half + dimmed * math.pi / 2.0 * half**2
        square = 2.0 * plain * half**3 / 3.0 + dimmed * math.pi / 8.0 * half**4
        rows.append((reach * math.sin(angle), square / light, float(weight) * half * light))
    total = math.fsum(share for _, _, share in rows)
    table = np.array([(x, reach * math.sqrt(y2), share / total) for x, y2, share in rows])
    table.flags.writeable = False
    return table
