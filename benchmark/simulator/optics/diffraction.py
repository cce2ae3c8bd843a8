"""Diffraction at an aperture: for which light, and its closed forms.

Scalar Fresnel diffraction about the chief ray, the ray through the aperture's centre. Where the
ray-optical landing point ``S`` moves by ``J ds`` when the direction cosines of the light change by
``ds`` (no glass: ``J_r = h / cos^3`` along the plane of incidence, ``J_t = h / cos`` across), the
phase of the light from the point q of the aperture to the point S + delta of the detector is
``(pi / lambda) ((delta_r - q_r)^2 / J_r + (delta_t - q_t)^2 / J_t)``. Each axis thus has its own
Fresnel number ``a^2 / (lambda J)``, and oblique incidence makes the shadow of a round aperture
elliptical far away and leaves it round close by.

The next term of the phase, cubic, ``-(pi / lambda) (J_r' rho_r^3 / (3 J_r^3) + (J_r - J_t) rho_r
rho_t^2 / (s J_r J_t^2))`` for ``rho = delta - q`` and the prime a derivative by the sine s, moves
spots outwards. It counts to first order, ``pi N (a / h) sin(theta)`` against one (`RoundPattern`,
`rectangle_patterns`), as does that the rims of a foil that bound either side of an opening lie at
depths of their own. How light leaves the opening is Kirchhoff's, whose flux does not lean
towards the horizon or from it to that order: the mean of what either polarisation does.

Left out: vector effects, and interference of different points of the Sun, which is incoherent.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.masks.apertures import Mask
from benchmark.simulator.optics.plates import fresnel_number


@dataclass(frozen=True)
class Spectrum:
    """Light of a few wavelengths, nanometres, with their shares of the detected electrons."""

    wavelengths_nm: tuple[float, ...]
    weights: tuple[float, ...]

    def __post_init__(self) -> None:
        if not self.wavelengths_nm or len(self.wavelengths_nm) != len(self.weights):
            raise ValueError(
                f"a spectrum needs one weight a wavelength; got {len(self.wavelengths_nm)} "
                f"wavelengths and {len(self.weights)} weights"
            )
        if min(self.wavelengths_nm) <= 0 or min(self.weights) <= 0:
            raise ValueError("wavelengths and weights must be positive")
        if abs(math.fsum(self.weights) - 1.0) > 1e-9:
            raise ValueError(f"weights must add up to 1; got {math.fsum(self.weights)}")


#: Half waves from a point of the opening at which its terms of first order fade out: fringes
#: further out have turned by more than they describe, and neither Sun nor colours leave any.
_SKEWED = 8.0

#: Sunlight on silicon: photons of a black body of 5772 K times the quantum efficiencies 0.50,
#: 0.60, 0.50, 0.35, 0.20 and 0.08, round numbers for a front-illuminated CMOS pixel.
SUNLIT_SILICON = Spectrum(
    wavelengths_nm=(450.0, 550.0, 650.0, 750.0, 850.0, 950.0),
    weights=(0.191, 0.283, 0.246, 0.164, 0.086, 0.030),
)


@dataclass(frozen=True, eq=False)
class Strips:
    """What a round opening is cut into across the plane of incidence: pairs of strips.

    An opening is the same on both sides of its middle: what a strip sends across is what the strip
    opposite does.

    Attributes
    ----------
    places
        (J,) distance of the pairs' strips from the middle; one in the middle is two of half.
    fields
        (2, J, T) of a strip, real and imaginary parts; or (4, J + 1, T) with the same with the
        square of the distance across in the integral, and last the strip over the middle.
    """

    places: Floats
    fields: Floats


def propagation(mask: Mask, height_mm: float, spectrum: Spectrum) -> dict[str, Any]:
    """How light gets from a mask to a detector `height_mm` below, for a dataset's ``regime``.

    The Fresnel number ``a^2 / (lambda h)`` of the narrowest opening, at normal incidence and
    550 nm, says what pattern to expect: a shadow with soft edges far above 1, a far pattern far
    below. Nothing is decided by it.
    """
    half = min(aperture.smallest_half_width_mm for aperture in mask.apertures)
    number = fresnel_number(half, height_mm)
    return {
        "propagation": "diffraction",
        "fresnel_number": float(f"{number:.3g}"),
        "wavelength_nm": 550,
        "wavelengths_nm": list(spectrum.wavelengths_nm),
        "weights": list(spectrum.weights),
        "reason": "scalar Fresnel diffraction about the chief ray, every wavelength over the Sun's "
        "disc, through what both rims of the foil leave open",
        "left_out": "vector effects, phases beyond the cubic term, light that openings share",
    }


def fresnel(argument: Floats) -> NDArray[np.complex128]:
    """Fresnel's ``C(u) + i S(u)``, the integral of ``exp(i pi t^2 / 2)`` from 0 to u."""
    from scipy.special import fresnel as sine_and_cosine  # noqa: PLC0415 - SciPy on demand

    sine, cosine = sine_and_cosine(argument)
    return np.asarray(cosine + 1j * sine)


def round_intensity(
    radial: Floats,
    tangential: Floats,
    numbers: tuple[float, float],
    *,
    points: int | None = None,
    apart: float = 0.0,
    blur: float = 0.0,
) -> Floats:
    """Intensity behind a round aperture, (R, T), in units of the open light.

    The integral across the aperture is Fresnel's in closed form. The one along it is, where the
    rims of the foil are not displaced, a trapezoidal sum over the angle ``psi``, ``q = sin(psi)``,
    in which the integrand is analytic and periodic, so that it converges faster than any power of
    the number of points. Of a thick foil light sees the lens that the two rims have in common,
    displaced against each other along the plane of incidence: Gauss's rule in either half of it,
    over the angle at the middle of the circle that bounds it there, so that the integrand is
    analytic up to the lens' tips.

    The rims of a thick foil also take away what bends at the one and hits the other
    (`lost_at_rims`), to first order: the field of a line along the edge is subtracted.

    Parameters
    ----------
    radial, tangential
        (R,), (T,) positions along and across the plane of incidence, from the middle of the
        shadow, in units of the aperture's radius.
    numbers
        Fresnel numbers ``a^2 / (lambda J)`` of the radius a in the two directions.
    points
        Of the sum; by default as many as the phase over the aperture asks for.
    apart
        Distance of the two rims' centres in units of the radius; from 2 on it is dark.
    blur
        ``sqrt(lambda t / 2)`` in units of the radius, t the way of the light through the foil.
    """
    out = np.zeros((len(radial), len(tangential)))
    if apart >= 2.0:
        return out
    from benchmark.simulator.kernels.diffraction_patterns import (  # noqa: PLC0415 - Numba
        squared_sums,
    )

    cut = strips((radial, tangential), numbers, points, (apart, blur))
    squared_sums(out, np.ascontiguousarray(radial), cut.places, numbers[0], cut.fields)
    return out


def round_skew(
    radial: Floats,
    tangential: Floats,
    numbers: tuple[float, float],
    changes: tuple[float, float, float, float],
    *,
    apart: float = 0.0,
    blur: float = 0.0,
) -> tuple[Floats, Floats]:
    """Return `round_intensity`, and how it changes to first order: (R, T), odd along `radial`.

    Parameters
    ----------
    radial, tangential, numbers, apart, blur
        As of `round_intensity`.
    changes
        Of the phase's cubic term ``-pi (N_r A rho_r^3 + N_t B rho_r rho_t^2)``, distances in
        radii, A and B, with what J along and across changes in the amplitude, and by which shares
        J_r and J_t are larger for the arc of positive coordinates, and smaller for the other one:
        the rims of a foil that bound either side of the lens lie at depths of their own.
    """
    light, skew = np.zeros((2, len(radial), len(tangential)))
    if apart >= 2.0:
        return light, skew
    from benchmark.simulator.kernels.diffraction_patterns import (  # noqa: PLC0415 - Numba
        skewed_sums,
    )

    along, across = numbers
    cut = strips((radial, tangential), numbers, None, (apart, blur), skewed=True)
    skewed_sums(
        (light, skew),
        np.ascontiguousarray(radial),
        cut.places,
        np.array([along, across, *changes, fade_half_waves(along)]),
        cut.fields,
    )
    return light, skew


def strips(
    places: tuple[Floats, Floats],
    numbers: tuple[float, float],
    points: int | None,
    rims: tuple[float, float],
    *,
    skewed: bool = False,
) -> Strips:
    """Cut a round opening into strips across the plane of incidence, each with its field.

    Parameters
    ----------
    places, numbers, points
        As of `round_intensity`: (R,) and (T,) positions, Fresnel numbers, points of the sum.
    rims
        `apart` and `blur` of `round_intensity`; apart below 2.
    skewed
        Whether `round_skew` asks, which needs all of them.
    """
    radial, tangential = places
    along, across = numbers
    apart, blur = rims
    if points is None:
        reach = 1.0 + float(np.max(np.abs(radial), initial=0.0))
        side = 1.0 + float(np.max(np.abs(tangential), initial=0.0))
        points = 24 + math.ceil(4.0 * max(along * reach, across * side))
    sines, along_it, shares = _openings(points, apart / 2.0)
    heights = np.sqrt(1.0 - sines**2)
    root, unit = math.sqrt(2.0 * across), math.sqrt(along / 2.0)
    # sqrt(N_r N_t) of the amplitude over sqrt(2 N_t) of the substitution
    weights = heights * shares * unit
    lost = np.zeros(len(heights), dtype=np.complex128)
    if blur > 0.0:
        lost += blur * root * lost_at_rims(apart * sines / blur) * shares * unit
    if skewed:
        # with the strip over the middle, where one side's depth ends and the other's begins
        heights = np.append(heights, math.sqrt(1.0 - apart * apart / 4.0))
        weights, lost = np.append(weights, unit), np.append(lost, 0.0)
    fields = np.empty((4 if skewed else 2, len(heights), len(tangential)))
    below, above = tangential + heights[:, None], tangential - heights[:, None]
    from scipy.special import fresnel as sine_and_cosine  # noqa: PLC0415 - SciPy on demand

    from benchmark.simulator.kernels.diffraction_patterns import (  # noqa: PLC0415 - Numba
        strip_fields,
    )

    strip_fields(
        fields,
        (np.ascontiguousarray(tangential), heights, weights, lost.real.copy(), lost.imag.copy()),
        (root, across),
        (*sine_and_cosine(root * below), *sine_and_cosine(root * above)),
    )
    return Strips(along_it, fields)


def fade_half_waves(number: float) -> float:
    """Half waves from a point of the opening at which `round_skew` fades out there.

    Of far patterns, which have few, much later.
    """
    return _SKEWED * max(1.0, 1.0 / number) ** 2


def lost_at_rims(displaced: Floats) -> NDArray[np.complex128]:
    """By how much the rims of a thick foil narrow its opening, in units of ``sqrt(lambda t / 2)``.

    Light that bends at the upper rim of a straight edge has, a way t further down, the amplitude
    ``A(u)`` of Fresnel's shadow a distance u outside of it, and ``1 - A(u)`` inside. The lower
    rim cuts it off at the distance `displaced` to either side. From far away that is an edge
    moved by the integral of A from there on, a complex number: ``(1 + i) / (2 pi)`` where the rims
    lie on top of each other, less than 0.1 from 1 on. The foil's walls are black.
    """
    rest = 0.5 + 0.5j - fresnel(displaced)
    edge = _turn(displaced[None])[0]
    return np.asarray((1j / math.pi * edge - displaced * rest) / (1.0 + 1j))


def _turn(argument: Floats) -> NDArray[np.complex128]:
    """``exp(i pi u^2 / 2)`` of (R, T) arguments u, the same on every processor."""
    from benchmark.simulator.kernels.diffraction_patterns import turn  # noqa: PLC0415 - Numba

    cosines, sines = np.empty(argument.shape), np.empty(argument.shape)
    turn(cosines, sines, np.ascontiguousarray(argument))
    return np.asarray(cosines + 1j * sines)


def _openings(points: int, half: float) -> tuple[Floats, Floats, Floats]:
    """Sines on the circles that bound an opening, places along it and weights, (P,) each.

    `half` is half the distance of the two rims' centres. Of one side of the opening's middle; the
    other one is the same.
    """
    if half == 0.0:
        turns = [math.pi * ((step + 0.5) / points - 0.5) for step in range(points // 2, points)]
        shares = np.full(len(turns), math.pi / points)
        if points % 2:  # in the middle
            turns[0] = 0.0
            shares[0] /= 2.0
        sines = np.array([math.sin(turn) for turn in turns])
        return sines, sines, shares
    nodes, weights = _gauss((points + 1) // 2)
    first = math.asin(half)
    span = math.pi / 2.0 - first
    turns = [first + span * (float(node) + 1.0) / 2.0 for node in nodes]
    sines = np.array([math.sin(turn) for turn in turns])
    return sines, sines - half, weights * (span / 2.0)


@lru_cache(maxsize=256)
def _gauss(points: int) -> tuple[Floats, Floats]:
    """Nodes and weights of Gauss's rule; every incidence and wavelength asks again."""
    return np.polynomial.legendre.leggauss(points)
