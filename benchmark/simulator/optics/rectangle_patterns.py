"""What diffraction at rectangles is looked up in, computed once a process for each aperture.

In a rectangle's own axes, w across and v along it, light from ``s`` lands at ``S(s) + J ds``. The
integral over one side is done by stationary phase everywhere but at the ends of the other one, and
what is left is a slit's pattern with ``J_ww = n^T J n``: so a rectangle gives the product of two
slits' patterns, exactly so where the Sun stands over one of the axes. Off both axes the phase
``q_w q_v`` couples the sides near the corners. Its part is known in closed form as a Fourier
transform: the field of a rectangle and the same, moved by ``lambda J f``, have a rectangle in
common, so that the intensity's transform at the frequency f is a product of two sines over their
arguments. What that differs by from the product of slits is tabulated about a corner. Where two
corners are so near that ``lambda J f`` takes a rectangle past itself, the product of sines is 0,
which corners by themselves do not know: what they lack is tabulated about the end of a slit. Of the
cubic phase and the depths of a foil's two rims a slit's pattern has what is of first order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.light.memory import memory
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.optics.diffraction import Spectrum
from benchmark.simulator.optics.diffraction_tables import fresnel_table
from benchmark.simulator.optics.plates import CoverGlass

#: Of wider slits the edges do not know each other: the pattern of this Fresnel number is taken
#: apart in the middle.
_WIDEST_NUMBER = 30.0
#: Rows of a slit's table a unit of its Fresnel number, and steps a fringe.
_ROWS, _FRINGE = 20.0, 16.0
#: A slit's table ends so many half widths from its middle at the latest.
_FAR = 40.0
#: Corners are tabulated as far as this, and in such steps, in roots of 550 nm times J.
_CORNER_REACH, _CORNER_STEP = 6.4, 0.2
#: They repeat at so many of twice that reach, and fade out over their last few roots.
_CORNER_PERIOD, _CORNER_FADE = 1.3, 2.0
_ROOT = math.sqrt(550e-6)
#: Incidences that corners are tabulated for, an axis, at equal steps of the angle.
_INCIDENCES = 8
#: What corners close together lack, at equal steps of the tangent: it comes up far off axis, where
#: fringes change with its square. As far as this from an end, in roots as above.
_SLOPES, _END_REACH, _END_FADE = 12, 3.2, 1.0
#: Less than this of the open light, all over a table, is nothing.
_NOTHING = 1e-3
#: How finely the Sun's disc is sampled: strips, and points of each.
_STRIPS, _POINTS = 8, 8
#: Cycles a radius up to which the disc's transform counts, and steps a cycle.
_CYCLES, _STEPS = 6, 16

#: (4, R, M) running integrals, of a thin foil and what a thick one, a bend and edges at two depths
#: add; the first row's Fresnel number, rows a unit of it, steps a half width.
Slits = tuple[Floats, float, float, float]


def spreading(directions: Floats, height_mm: Floats, glass: CoverGlass) -> tuple[Floats, Floats]:
    """Return J along and across the plane of incidence, (N,) each, mm a unit of direction cosine.

    Of directions (N, 3) that light comes from through a plane so far (N,) above the detector.
    """
    sine2 = np.sum(directions[:, :2] ** 2, axis=1)
    cosine2 = 1.0 - sine2
    across = (height_mm - glass.thickness_mm) / np.sqrt(cosine2)
    along = across / cosine2
    for plate in glass.plates:
        square = plate.index**2 - sine2
        share = plate.thickness_mm / np.sqrt(square)
        across = across + share
        along = along + share * plate.index**2 / square
    return along, across


def matrix(directions: Floats, height_mm: Floats, glass: CoverGlass) -> tuple[Floats, ...]:
    """Return ``J_xx, J_yy, J_xy`` (N,) of `spreading` in the axes of the directions."""
    along, across = spreading(directions, height_mm, glass)
    sine2 = np.sum(directions[:, :2] ** 2, axis=1)
    more = (along - across) / np.where(sine2 > 0, sine2, 1.0)
    x, y = directions[:, 0], directions[:, 1]
    return across + more * x * x, across + more * y * y, more * x * y


def bend(
    directions: Floats, height_mm: Floats, glass: CoverGlass, spread: tuple[Floats, ...]
) -> Floats:
    """(N, 2) half the second derivative of the landing point over J squared, a mm, along x and y.

    Where diffraction throws light far, equal steps of the direction cosine are unequal ones on
    the detector: ``J ds = delta - bend delta^2``. The other cosine stays as it is behind a slit.
    """
    square = directions[:, :2] ** 2
    found = np.zeros((len(directions), 2))
    gaps = [(height_mm - glass.thickness_mm, 1.0)]
    for thickness, index in [*gaps, *((plate.thickness_mm, plate.index) for plate in glass.plates)]:
        inside = (index**2 - square[:, 0] - square[:, 1])[:, None]
        third = np.asarray(thickness, dtype=np.float64).reshape(-1, 1) / (inside * np.sqrt(inside))
        found += 1.5 * directions[:, :2] * third * (1.0 + square / inside)
    return found / np.stack(spread[:2], axis=1) ** 2


def shade_edges(directions: Floats, apart_mm: Floats, thickness_mm: float) -> tuple[Floats, Floats]:
    """How a foil narrows each half of a rectangle (N, 2), and its share of softness (N, 2).

    Across and along. Light bent at the upper rim is cut by the lower one: an edge whose amplitude
    behind the upper rim is ``E(w)`` lacks ``int_0^inf (1 - E) dw = (1 + i) / (2 pi)``, w in units
    of ``sqrt(lambda J / 2)`` of the foil's thickness. The real part moves the edge inwards, the
    imaginary one softens it (`RectanglePattern.softness`). Both fade as the rims part: by
    `apart_mm` (N, 2), of which half is the shadow.
    """
    if thickness_mm == 0:
        return apart_mm / 2.0, np.zeros(apart_mm.shape)
    spread = matrix(directions, np.full(len(directions), thickness_mm), CoverGlass())
    fringe = _ROOT * np.sqrt(np.stack(spread[:2], axis=1) / 2.0)
    share = 1.0 / (1.0 + math.pi * apart_mm / fringe)
    return apart_mm / 2.0 + fringe / (2.0 * math.pi) * share, share


def apart(
    directions: Floats, soft: Floats, thickness_mm: float, spread: tuple[Floats, ...]
) -> Floats:
    """(N, 2) by which share J is larger at a rectangle's edges of positive x and y.

    And smaller at the other ones: oblique light is cut by the lower rim where it goes to and by
    the upper one where it comes from. `soft` (N, 2) are the shares of `shade_edges`, by which both
    rims cut alike.
    """
    foil = matrix(directions, np.full(len(directions), thickness_mm), CoverGlass())
    share = np.stack(foil[:2], axis=1) / np.stack(spread[:2], axis=1) / 2.0
    return np.asarray(-np.sign(directions[:, :2]) * share * (1.0 - soft))


def disc_image(directions: Floats, spread: tuple[Floats, ...], radius: float) -> Floats:
    """(N, 3) what the unit disc becomes: x = l_0 p + l_1 q, y = l_2 q for its points (p, q).

    A turn of the disc is left out, which nobody sees.
    """
    xx, yy, xy = spread
    x, y = directions[:, 0], directions[:, 1]
    # J (1 - s s^T) J^T, the middle one for the tilt of the disc's own plane
    p, q = 1.0 - x * x, 1.0 - y * y
    r = -x * y
    a, b = xx * p + xy * r, xx * r + xy * q
    c, d = xy * p + yy * r, xy * r + yy * q
    across, both, high = a * xx + b * xy, a * xy + b * yy, c * xy + d * yy
    high = np.sqrt(high)
    shear = both / high
    semi = np.sqrt(np.maximum(across - shear * shear, 0.0))
    return radius * np.stack([semi, shear, high], axis=1)


def disc_strips(darkening: float, strips: int = _STRIPS, points: int = _POINTS) -> Floats:
    """(S, P, 3) nodes of the limb-darkened unit disc in strips: across, height, weight; sum 1."""
    nodes, shares = np.polynomial.legendre.leggauss(points)
    out = np.empty((strips, points, 3))
    for j in range(strips):
        angle = math.pi * (j + 1.0) / (strips + 1.0)
        height, chord = math.cos(angle), math.sin(angle)
        for i in range(points):
            t = float(nodes[i])
            radiance = 1.0 - darkening + darkening * chord * math.sqrt(1.0 - t * t)
            out[j, i] = chord * t, height, chord * chord * float(shares[i]) * radiance
    out[..., 2] /= math.fsum(out[..., 2].ravel())
    return out


@dataclass(frozen=True)
class RectanglePattern:
    """The light behind a rectangle, for incidences up to `widest_deg` an axis.

    Attributes
    ----------
    half_mm
        Half sizes along its own axes.
    thickness_mm
        Of the foil: what both of its displaced rims leave open lies in its middle.
    height_mm, glass
        From the foil's middle down to the detector, glass included.
    sun, spectrum
        What shines.
    pitch_mm
        Of the pixels.
    reach_mm
        Distance from the spot's middle that is looked at.
    widest_deg
        Largest incidence; beyond, patterns keep this one's Fresnel numbers.
    """

    half_mm: tuple[float, float]
    thickness_mm: float
    height_mm: float
    glass: CoverGlass
    sun: SolarDisc
    spectrum: Spectrum
    pitch_mm: float
    reach_mm: float
    widest_deg: float

    def widths(self) -> tuple[Slits, Slits]:
        """Return running integrals of the slits' patterns along both axes."""
        return self._slits(self.half_mm[0]), self._slits(self.half_mm[1])

    def corners(self) -> tuple[Floats, Floats, Floats, float]:
        """Return what coupling adds, and steps a root of mm.

        (T, T, 2, M, M) about corners by themselves; (U, U, 1, L, L) about both ends along the
        rectangle, where corners across from each other are near, and about both across it. U is
        0 where they are far apart. The incidences are those of `place`.
        """
        # a corner by itself does not know how far the others are
        alone = replace(self, half_mm=(0.0, 0.0), thickness_mm=0.0, reach_mm=0.0)
        return _corners(alone), _ends(self), _sides(self), _per_root()

    @property
    def softness(self) -> float:
        """Imaginary part by which a foil moves an edge, in the unit of Fresnel's integrals."""
        return round(math.sqrt(self.thickness_mm / self.height_mm) / (2.0 * math.pi), 4)

    def waves(self) -> Floats:
        """(L, 2) wavelengths in mm and weights."""
        nm = np.array(self.spectrum.wavelengths_nm)
        return np.column_stack([nm * 1e-6, np.array(self.spectrum.weights)])

    def place(self, directions: Floats) -> Floats:
        """(N, 4) coordinates among the corners' and the ends' incidences, in the own axes."""
        last, end = _INCIDENCES - 1, _SLOPES - 1
        widest = math.radians(self.widest_deg)
        rows = [
            (math.atan2(abs(x), z) / widest * last, math.atan2(abs(y), z) / widest * last)
            for x, y, z in directions.tolist()
        ]
        slopes = np.abs(directions[:, :2]) / directions[:, 2:] / math.tan(widest) * end
        places = np.column_stack([np.array(rows).reshape(-1, 2), slopes])
        return np.asarray(np.minimum(places, [last, last, end, end]))

    def _slits(self, half: float) -> Slits:
        limit = math.radians(self.widest_deg)
        edge = np.array([[0.0, 0.0, 1.0], [math.sin(limit), 0.0, math.cos(limit)]])
        along, across = spreading(edge, np.full(2, self.height_mm), self.glass)
        waves = self.spectrum.wavelengths_nm
        narrowest = max(half - self.thickness_mm / 2.0 * math.tan(limit), 0.1 * half)
        # a little more than needed: assembly drifts
        highest = 1.02 * half**2 / (min(waves) * 1e-6 * float(across[0]))
        lowest = 0.98 * narrowest**2 / (max(waves) * 1e-6 * float(along[1]))
        highest, lowest = min(highest, _WIDEST_NUMBER), min(lowest, _WIDEST_NUMBER)
        far = min(1.0 + self.reach_mm / narrowest, _FAR)
        return _running(round(lowest, 3), round(highest, 3), round(far, 1), self.softness)

    def _patches(self, directions: Floats) -> Floats:
        """(2, M, M) about a corner for one direction (1, 3) in the own axes."""
        from benchmark.simulator.kernels.corner_patches import (  # noqa: PLC0415 - Numba
            corner_patches,
        )

        steps = round(_CORNER_REACH / _CORNER_STEP)
        out = np.empty((2, 2 * steps + 1, 2 * steps + 1))
        design, grid = self._frequencies(directions, _CORNER_REACH)
        corner_patches(out, design, self.waves(), _transform(self.sun.limb_darkening), grid)
        return np.asarray(out * _window(steps, _CORNER_FADE))

    def _end(self, directions: Floats) -> Floats:
        """(1, L, L) about the end for one direction (1, 3) off both own axes."""
        from benchmark.simulator.kernels.corner_patches import (  # noqa: PLC0415 - Numba
            end_patch,
        )

        steps = round(_END_REACH / _CORNER_STEP)
        out = np.zeros((1, 2 * steps + 1, 2 * steps + 1))
        parted = self.thickness_mm * np.abs(directions[:, :2]) / directions[:, 2:]
        shade, _ = shade_edges(directions, parted, self.thickness_mm)
        half = self.half_mm[0] - float(shade[0, 0])
        if half > 0.0:
            design, grid = self._frequencies(directions, _END_REACH)
            end_patch(
                out[0],
                np.append(design, 2.0 * half),
                self.waves(),
                _transform(self.sun.limb_darkening),
                grid,
            )
        return np.asarray(out * _window(steps, _END_FADE))

    def _frequencies(self, directions: Floats, reach: float) -> tuple[Floats, Floats]:
        """Return `design` and `grid` of `corner_patches`."""
        spread = matrix(directions, np.array([self.height_mm]), self.glass)
        across, along, both = (float(j[0]) for j in spread)
        radius = math.sin(math.radians(self.sun.diameter_deg / 2.0))
        image = disc_image(directions, spread, radius)[0]
        periods = [2.0 * _CORNER_PERIOD * reach * _ROOT * math.sqrt(j) for j in (across, along)]
        # the Sun's image and the pixel let nothing finer through
        most = min(2.0 / self.pitch_mm, _CYCLES / max(float(image.max()), 1e-9))
        design = np.array([across, along, both, *image, self.pitch_mm, _per_root()])
        return design, np.array([1.0 / periods[0], 1.0 / periods[1], most])


def _window(steps: int, fade: float) -> Floats:
    """(M, M) by which tables end without a step, over so many of their last roots."""
    shares = [min(1.0, (steps - abs(i)) * _CORNER_STEP / fade) for i in range(-steps, steps + 1)]
    ends = np.array([t * t * (3.0 - 2.0 * t) for t in shares])
    return np.asarray(ends[:, None] * ends)


def _per_root() -> float:
    return 1.0 / (_CORNER_STEP * _ROOT)


@memory.tables(16)
def _running(lowest: float, highest: float, far: float, softness: float) -> Slits:
    from benchmark.simulator.kernels.slit_integrals import (  # noqa: PLC0415 - Numba on demand
        running_integrals,
        skew_integrals,
    )

    rows = max(math.ceil((highest - lowest) * _ROWS) + 1, 4)
    numbers = lowest + np.arange(rows) / _ROWS
    per_half = max(_FRINGE * highest, 32.0)
    sums = np.zeros((4, rows, math.ceil(far * per_half) + 2))
    running_integrals(sums[0], numbers, 1.0 / per_half, 0.0, fresnel_table())
    if softness > 0:
        running_integrals(sums[1], numbers, 1.0 / per_half, softness, fresnel_table())
        sums[1] -= sums[0]
    skew_integrals(sums[2:], numbers, 1.0 / per_half, fresnel_table())
    sums.flags.writeable = False
    return sums, lowest, _ROWS, per_half


@memory.tables(8)
def _corners(pattern: RectanglePattern) -> Floats:
    angles = [math.radians(pattern.widest_deg) * n / (_INCIDENCES - 1) for n in range(_INCIDENCES)]
    slopes = [math.tan(angle) for angle in angles]
    found = [[pattern._patches(_towards(x, y)) for y in slopes] for x in slopes]  # noqa: SLF001 - cached here: a dataclass method cannot be
    tables = np.array(found)
    tables.flags.writeable = False
    return tables


@memory.tables(8)
def _ends(pattern: RectanglePattern) -> Floats:
    slopes = [
        math.tan(math.radians(pattern.widest_deg)) * n / (_SLOPES - 1) for n in range(_SLOPES)
    ]
    size = 2 * round(_END_REACH / _CORNER_STEP) + 1
    tables = np.zeros((_SLOPES, _SLOPES, 1, size, size))
    # where the Sun stands over an axis nothing is coupled
    for i in range(1, _SLOPES):
        for j in range(1, _SLOPES):
            table = pattern._end(_towards(slopes[i], slopes[j]))  # noqa: SLF001 - as in `_corners`
            if float(np.abs(table).max()) > _NOTHING:
                tables[i, j] = table
    if not tables.any():
        tables = np.zeros((0, 0, 1, size, size))
    tables.flags.writeable = False
    return tables


@memory.tables(8)
def _sides(pattern: RectanglePattern) -> Floats:
    """As `_ends`, of the rectangle on its side."""
    half = pattern.half_mm[1], pattern.half_mm[0]
    tables = np.ascontiguousarray(_ends(replace(pattern, half_mm=half)).transpose(1, 0, 2, 4, 3))
    tables.flags.writeable = False
    return tables


def _towards(x: float, y: float) -> Floats:
    length = math.sqrt(x * x + y * y + 1.0)
    return np.array([[x / length, y / length, 1.0 / length]])


@memory.tables(8)
def _transform(darkening: float) -> Floats:
    """(Z,) transform of the unit disc, at steps of 1/16 cycle a radius."""
    disc = disc_strips(darkening, 40, 24)
    heights, shares = disc[:, 0, 1].tolist(), disc[..., 2].sum(axis=1).tolist()
    return np.array(
        [
            math.fsum(
                share * math.cos(2.0 * math.pi * step / _STEPS * height)
                for height, share in zip(heights, shares, strict=True)
            )
            for step in range(_CYCLES * _STEPS + 1)
        ]
    )
