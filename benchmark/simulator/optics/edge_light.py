"""Light that crosses a line near the edge of a shadow: Fresnel's edge, integrated in closed form.

Behind a straight edge the intensity at v, in units of ``sqrt(lambda J / 2)`` from the shadow's
edge into the light, is ``I(v) = ((C + 1/2)^2 + (S + 1/2)^2) / 2``; `light_below` is its integral
from the dark. What that has beyond the geometric ``max(v, 0)`` was carried past the line by
diffraction: ``1 / (2 pi)`` at the edge itself, nothing far from it. Edges count each for itself;
the interference of a slit's two is left out.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.optics.diffraction import Spectrum, fresnel

#: Wavelength in whose units lines are placed, nm.
REFERENCE_NM = 550.0
#: The table's half length and steps a unit.
_REACH, _STEPS = 24.0, 64


def light_below(v: Floats) -> Floats:
    """Integral of a straight edge's intensity from the dark up to `v`, units as of `v`.

    ``v I(v) - (sin(pi v^2 / 2) (C + 1/2) - cos(pi v^2 / 2) (S + 1/2)) / pi``: what is left of the
    integral by parts cancels.
    """
    integral = fresnel(v)
    c, s = integral.real + 0.5, integral.imag + 0.5
    phase = [math.pi / 2.0 * float(one) ** 2 for one in v]
    sine = np.array([math.sin(p) for p in phase])
    cosine = np.array([math.cos(p) for p in phase])
    return np.asarray(v * (c * c + s * s) / 2.0 - (sine * c - cosine * s) / math.pi)


@lru_cache(maxsize=8)
def light_across_edge(spectrum: Spectrum) -> tuple[Floats, float]:
    """(M,) light of a spectrum that diffraction carries past a line, and steps a unit.

    In units of ``sqrt(lambda J / 2)`` at `REFERENCE_NM`, as is the line's place from the shadow's
    edge, into the light; the table is centred on the edge. Beyond its ends, less than 0.0022 units
    cross: they are shifted down to none, so that nothing jumps there.
    """
    place = np.arange(-_REACH * _STEPS, _REACH * _STEPS + 1) / _STEPS
    out = np.zeros(len(place))
    for wavelength, weight in zip(spectrum.wavelengths_nm, spectrum.weights, strict=True):
        scale = math.sqrt(wavelength / REFERENCE_NM)
        v = place / scale
        out += weight * scale * (light_below(v) - np.maximum(v, 0.0))
    # the tail goes with 1 / v: a straight line takes it to nothing at the ends
    ends = place / _REACH
    out -= np.where(ends < 0.0, out[0] * np.abs(ends), out[-1] * ends)
    out.flags.writeable = False
    return out, float(_STEPS)
