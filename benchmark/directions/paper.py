"""Directions that a calculation decides: what light, photons and distances allow at all.

Each function returns a `Calculation`: the number that the rule asks for, and what it is of.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.optics.diffraction import SUNLIT_SILICON


@dataclass(frozen=True)
class Calculation:
    """What a calculation gives.

    Attributes
    ----------
    value, against
        The number, and what it is compared with; in `unit`.
    pays
        Whether the rule is met.
    text
        In a sentence, with what is assumed.
    """

    value: float
    against: float
    unit: str
    pays: bool
    text: str


#: Of both masks, millimetres: a hole of 0.2 mm, 2 mm over pixels of 6.5 um (ccd-single-aperture
#: with the pixels of cmos-single-aperture).
HEIGHT_MM, WIDTH_MM, PITCH_MM = 2.0, 0.2, 0.0065
#: Wavelength that the zones are made for, millimetres.
DESIGN_MM = 633e-6
FULL_E, READ_E = 14_000.0, 12.0
#: Samples a pixel and axis, and half the width of the image that is looked at.
_FINE, _REACH_MM = 5, 0.35


@lru_cache(1)
def zone_plate() -> Calculation:
    """Compare the bound of a Fresnel zone plate with that of a hole (Lee2024).

    Zones are open and closed in turn, the first open, the n-th ends at ``sqrt(n lambda f)``. The
    field behind either mask is Fresnel's integral over the opening for every wavelength of sunlight
    on silicon; intensities are spread over the Sun's disc and the pixels, and scaled to a peak of
    80 % of full scale. The bound is that of a shift, of shot and read noise.
    """
    bounds = [
        math.degrees(_shift_bound_mm(_image(mask)) / HEIGHT_MM) for mask in (zones_open, hole_open)
    ]
    plate, hole = bounds
    return Calculation(
        plate,
        hole,
        "deg",
        plate < hole / 1.03,
        f"At a height of {HEIGHT_MM:g} mm and a width of {WIDTH_MM:g} mm the bound of a zone plate "
        f"for 633 nm is {plate:.2g} deg an axis, that of a hole {hole:.2g} deg, in the light that "
        "silicon sees, over the Sun's disc, at equal peak.",
    )


def hole_open(radius_mm: Floats) -> Floats:
    """Whether light passes at a radius: of a hole."""
    return np.asarray(radius_mm <= WIDTH_MM / 2.0, dtype=np.float64)


def zones_open(radius_mm: Floats) -> Floats:
    """Whether light passes at a radius: of a zone plate."""
    zone = np.floor(radius_mm**2 / (DESIGN_MM * HEIGHT_MM))
    return np.asarray(hole_open(radius_mm) * (zone % 2 == 0))


def radial_intensity(
    mask: Callable[[Floats], Floats], wavelength_mm: float, radius_mm: Floats
) -> Floats:
    """Intensity (R,) behind a round mask at `HEIGHT_MM`, in units of that before it.

    ``|2 pi / (lambda h) int t(q) exp(i pi q^2 / (lambda h)) J_0(2 pi q r / (lambda h)) q dq|^2``.
    """
    from scipy.special import j0  # noqa: PLC0415 - SciPy on demand

    steps = 4000
    q = (np.arange(steps) + 0.5) / steps * (WIDTH_MM / 2.0)
    scale = math.pi / (wavelength_mm * HEIGHT_MM)
    field = mask(q) * q * np.exp(1j * scale * q**2) * (WIDTH_MM / 2.0 / steps)
    bessel = j0(2.0 * scale * radius_mm[:, None] * q)
    wave = 2.0 * scale * (bessel @ field)
    return np.asarray(wave.real**2 + wave.imag**2)


def _image(mask: Callable[[Floats], Floats]) -> Floats:
    """(G, G) light of the Sun's disc over pixels, at `_FINE` places a pixel, of any scale."""
    from scipy.signal import fftconvolve  # noqa: PLC0415 - SciPy on demand

    step = PITCH_MM / _FINE
    places = np.arange(-math.ceil(_REACH_MM / step), math.ceil(_REACH_MM / step) + 1) * step
    radius = np.hypot(places[:, None], places)
    line = np.arange(0.0, radius.max() + step, step / 2.0)
    point = np.zeros_like(radius)
    for nm, weight in zip(SUNLIT_SILICON.wavelengths_nm, SUNLIT_SILICON.weights, strict=True):
        profile = radial_intensity(mask, 1e-6 * nm, line)
        point += weight * np.interp(radius, line, profile)
    sun = SolarDisc()
    edge = HEIGHT_MM * math.radians(sun.diameter_deg / 2.0)
    square = np.clip(1.0 - (radius / edge) ** 2, 0.0, 1.0)
    disc = np.where(square > 0, 1.0 - sun.limb_darkening * (1.0 - np.sqrt(square)), 0.0)
    kept = slice(len(places) // 2 - math.ceil(edge / step) - 1, None)
    near = disc[kept, kept][: 2 * math.ceil(edge / step) + 3, : 2 * math.ceil(edge / step) + 3]
    spread = fftconvolve(point, near / near.sum(), mode="same")
    return np.asarray(fftconvolve(spread, np.ones((_FINE, _FINE)), mode="same"))


def _shift_bound_mm(image: Floats) -> float:
    """Bound of a shift along x, root mean square over where the image lies on the pixels."""
    signal = np.maximum(image, 0.0) * (0.8 * FULL_E / image.max())
    slope = np.gradient(signal, PITCH_MM / _FINE, axis=1)
    told = slope**2 / (signal + READ_E**2)
    information = [
        float(told[y::_FINE, x::_FINE].sum()) for y in range(_FINE) for x in range(_FINE)
    ]
    return math.sqrt(float(np.mean(1.0 / np.array(information))))


#: Speed of the Sun's equator along the line of sight at its limb, and assumed of the cells of
#: supergranulation, m/s; cells of some 30,000 km over the disc, each with a motion of its own.
EQUATOR_M_S, CELLS_M_S, CELLS = 2000.0, 300.0, 1500
#: Photons of sunlight at 630 nm, a second, square metre and nanometre; the passband on a slope of a
#: line, nm; area of a lens, m^2; share of photons that is counted; seconds.
PHOTONS, PASSBAND_NM, AREA_M2, COUNTED, SECONDS = 5.2e18, 0.005, 1e-4, 0.1, 1.0
#: Change of light that passes, a metre a second: a line of 10 pm on whose slope half of the light
#: changes.
CONTRAST_S_M = 630.0 / 2.998e8 / 0.01


def third_axis() -> Calculation:
    """Bound the turn about the line of sight by the Doppler shift of a line (Liebe2016).

    Over the disc of radius R the Sun's rotation changes the light that passes a filter on the slope
    of a line by ``c x / R`` along its equator. Of N photons the direction of that slope is known to
    ``2 / (c sqrt(N))``, as ``<(x / R)^2> = 1/4``. Cells of convection that move by themselves leave
    ``2 (v_cell / v_equator) / sqrt(cells)``, however many photons there are.
    """
    photons = PHOTONS * PASSBAND_NM * AREA_M2 * COUNTED * SECONDS
    contrast = EQUATOR_M_S * CONTRAST_S_M
    shot = math.degrees(2.0 / (contrast * math.sqrt(photons)))
    cells = math.degrees(2.0 * CELLS_M_S / EQUATOR_M_S / math.sqrt(CELLS))
    turn, needed = math.hypot(shot, cells), 0.1
    return Calculation(
        turn,
        needed,
        "deg",
        turn <= needed,
        f"A lens of 1 cm2 counts photons for {shot:.1g} deg in a second, but convection (assumed: "
        f"300 m/s in {CELLS} cells that move by themselves) beside 2 km/s of rotation leaves "
        f"{cells:.2g} deg for as long as its cells live, about a day.",
    )


#: Error of the best built sensors, degrees; baseline of a spacecraft, and distance of the Sun, m.
BEST_DEG, BASELINE_M, SUN_M = 0.001, 1.0, 1.496e11


def positioning() -> Calculation:
    """Bound the distance of a light by two sensors that see it from both ends of a baseline.

    A parallax of b / D, of which either sensor knows its end to s: the share of the distance that
    is unknown is ``sqrt(2) s D / b``.
    """
    parallax = math.sqrt(2.0) * math.radians(BEST_DEG)
    share, needed = parallax * SUN_M / BASELINE_M, 0.1
    reach = needed * BASELINE_M / parallax
    return Calculation(
        share,
        needed,
        "of the distance",
        share <= needed,
        f"Sensors of {BEST_DEG:g} deg, {BASELINE_M:g} m apart, know the distance of a light to "
        f"10 % up to {reach:.0f} m. The Sun's parallax over a metre is "
        f"{math.degrees(BASELINE_M / SUN_M):.1g} deg: its distance comes from the almanac.",
    )


CALCULATIONS: Mapping[str, Callable[[], Calculation]] = {
    "zone_plate": zone_plate,
    "third_axis": third_axis,
    "positioning": positioning,
}
