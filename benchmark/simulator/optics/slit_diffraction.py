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

- Foil: the two displaced rims have an effective slit in common, taken at the foil's middle, while
  the light of either edge comes from half a thickness away: 0.4 % of peak for 0.05 mm of foil 1.2
  mm up.
- Glass: ``J`` is that of all layers (`diffraction_tables.landing`), the landing point is Snell's.
- Sun: its points add up, each with its own landing point, light and width. Where the light falls
  along an array depends on one direction on the disc: chords across that direction are taken
  together, at their mean.
- Slits that end on the array: their light is that of the endless slit times the share of the
  pixels' height between their geometric ends.

Left out: the next term of the phase, polarisation, diffraction at a slit's ends, interference of
light of different slits (they are many times farther apart than sunlight is coherent, 60 um).
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.light.sun_disc import SolarDisc


def chords(disc: SolarDisc, widest_mm: float, wavelength_mm: float) -> Floats:
    """(Q, 3) offset of chords of the Sun's disc, root mean square along them, share of the light.

    Offsets are sines of angles from the disc's middle. As many chords as the finest fringes of a
    slit `widest_mm` wide ask for: ``2 r w / lambda`` of them pass over a pixel while the Sun, of
    angular radius r, passes its own diameter.
    """
    return _chords(disc, widest_mm, wavelength_mm)


@lru_cache(maxsize=32)
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
