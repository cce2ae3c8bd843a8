"""What diffraction frames are looked up in, computed once a process for each aperture."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.light.memory import memory
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.optics.diffraction import (
    Spectrum,
    fade_half_waves,
    fresnel,
    round_intensity,
    round_skew,
)
from benchmark.simulator.optics.plates import CoverGlass
from benchmark.simulator.optics.table_grids import Cell, both_sides, slopes, spread, turned_cell

#: Steps of a table in ``k a`` times the direction cosine, at the shortest wavelength: of the far
#: pattern, and of a shadow's fringes, of which many wavelengths and the Sun leave only the coarse
#: ones. The intensity holds no angular frequency above 2 in this coordinate.
_FAR_STEP, _NEAR_STEP = 0.2, 0.35
#: Tables end this far outside the shadow's edge, in the same coordinate.
_OUTSIDE = 60.0
#: Where the shadow outgrows the far pattern: first zero of J1.
_AIRY = 3.8317
_FRESNEL_STEPS, _FRESNEL_REACH = 64, 10
#: Turn of the cubic phase, radians, at which terms of first order fade out.
_TURNED = 2.0
Pair = tuple[Floats, Floats]
#: Light at places, for Fresnel numbers, rims so far apart and blurred, and a sine.
Pattern = Callable[[Pair, tuple[float, float], tuple[float, float], float], Floats]


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
    thickness_mm
        Of the foil: oblique light sees the lens that its two rims have in common, at `height_mm`.
    growth
        Relative excess of the opening's radius over `radius_mm`, which lays out the tables: those
        of holes a little smaller and larger are on one grid.
    cell_mm
        Side of a square of the detector over which light is averaged beforehand, whichever way it
        is turned (`turned_cell`); 0: not.
    """

    radius_mm: float
    height_mm: float
    glass: CoverGlass
    sun: SolarDisc
    spectrum: Spectrum
    reach_mm: float
    widest_deg: float
    thickness_mm: float = 0.0
    growth: float = 0.0
    cell_mm: float = 0.0

    def __post_init__(self) -> None:
        if not min(self.thickness_mm, self.cell_mm) >= 0.0:
            raise ValueError(
                "thickness_mm and cell_mm must not be negative; got "
                f"{self.thickness_mm} and {self.cell_mm}"
            )
        if not self.growth > -1.0:
            raise ValueError(f"growth must be above -1; got {self.growth}")

    @property
    def _wavelength_mm(self) -> float:
        return min(self.spectrum.wavelengths_nm) * 1e-6

    @property
    def _middle_mm(self) -> float:
        waves = np.array(self.spectrum.wavelengths_nm) * 1e-6
        return float(np.sum(waves * np.array(self.spectrum.weights)))

    def layers(self) -> Floats:
        """(L, 2) thickness and index from the aperture down; the first is empty."""
        return self._layers

    @cached_property
    def _layers(self) -> Floats:
        return layers(self.height_mm, self.glass)

    def numbers(self, sine: Floats, wavelength_mm: float) -> Floats:
        """(N, 2) Fresnel numbers along and across the plane of incidence."""
        return self.numbers_where(landing_points(sine, self._layers)[:, 1:], wavelength_mm)

    def numbers_where(self, spread: Floats, wavelength_mm: float) -> Floats:
        """(N, 2) `numbers`, of J_r and J_t (N, 2) that are known already."""
        return np.asarray(self.radius_mm**2 / (wavelength_mm * spread))

    @cached_property
    def _upright(self) -> Floats:
        """(1, 2) `numbers` at normal incidence and the shortest wavelength."""
        return self.numbers(np.zeros(1), self._wavelength_mm)

    def scales(self, sine: Floats) -> tuple[Floats, Floats]:
        """Return direction cosines a step of the tables (N, 2), and the tables' unit (N,).

        The steps follow the shadow where the aperture is many fringes wide, the far pattern where
        it is not, so that tables of neighbouring incidences resemble each other.
        """
        normal = self._upright
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
        return 12 + math.ceil(2.5 * float(self._upright[0, 0]))

    def seen(self, sine: Floats) -> Floats:
        """(N, 6) what `diffraction.add_round` takes points of the detector to the tables by.

        The phase's cubic term (see `diffraction`) is that of light whose ``J`` grows towards the
        horizon. A distance ``rho = delta - q``, in radii, counts as ``rho_r - A rho_r^2 / 2`` along
        and ``rho_t - B rho_r rho_t / 2`` across, with ``A = a J_r' / (3 J_r^2)`` and
        ``B = a (J_r - J_t) / (J_r J_t s)``, which are the same without glass. Multiplied out, that
        is to first order a round hole again, ``(3 A + B) / 8`` further out, as seen from delta with
        Fresnel numbers ``N_r (1 - 2 A delta_r)`` and ``N_t (1 - B delta_r)`` and, beside the plane
        of incidence, with turned axes. Tables of neighbouring incidences hold nearly such numbers:
        their rows are taken from where the product of both is right, and what is left is a scale of
        what has turned (`share`). That far, light also spreads thinner by ``A delta_r``.

        Returns
        -------
        Rows ``c_0`` to ``c_5``, lengths in mm: the tables' row is that of
        ``x + c_0 + c_1 x^2 + c_2 y^2``, the column that of ``y (1 + c_3 x)``, light is multiplied
        by ``1 + c_4 x``, x along and y across from the chief ray; the incidence moves by ``c_5 x``
        nodes.
        """
        limit = math.sin(math.radians(self.widest_deg))
        sine = np.minimum(sine, limit)
        small = 1e-4
        low, high = np.maximum(sine - small, 0.0), np.minimum(sine + small, limit)
        stack = self.layers()
        _, along, across = landing_points(sine, stack).T
        before, after = landing_points(low, stack), landing_points(high, stack)
        change = (after[:, 1] - before[:, 1]) / (high - low)
        safe = np.maximum(sine, small)
        third = change / (3.0 * along**2)
        beside = (along - across) / (along * across * safe)
        part = (2.0 * third + beside) / np.maximum(3.0 * third + beside, 1e-30)
        moved = part / along / (high - low)
        (one, unit), (two, thin) = self.scales(high), self.scales(low)
        # how the tables' steps and unit grow from one incidence to the next
        grown = [
            moved * np.array([math.log(float(v)) for v in a / b])
            for a, b in (
                (one[:, 0] * after[:, 1], two[:, 0] * before[:, 1]),
                (one[:, 1] * after[:, 2], two[:, 1] * before[:, 2]),
                (unit, thin),
            )
        ]
        share = self.share(sine)
        # axes turn by this much a mm beside the plane of incidence; not where there are none
        apart = 1.0 - across / along
        certain = apart**2 / (apart**2 + 1e-3)
        turned = 0.5 * beside * certain / np.maximum(apart, 1e-9)
        leaning = 0.5 * beside * (1.0 - certain) * share
        return np.column_stack(
            [
                -(3.0 * third + beside) / 8.0 * self.radius_mm**2,
                0.5 * third + share * (3.0 * part - 2.0) * third - grown[0],
                turned - leaning * along / across,
                0.5 * beside - turned - leaning + share * (part - 1.0) * beside - grown[1],
                grown[2] - third * share,
                moved * (self.place(high) - self.place(low)),
            ]
        )

    def share(self, sine: Floats) -> Floats:
        """(N,) which part of a distance from the shadow's middle is turning of the light.

        Light from the point q of the aperture that lands at delta has turned by ``delta - q``. A
        far pattern is all turning, a shadow is none. Between them the
        mean of ``delta - q``, given delta, is ``s^2 / (s^2 + a^2 / 4)`` of delta for normal
        distributions: ``a / 2`` is the aperture's, ``s = 0.42 lambda J_r / (2 a)`` that of a
        pattern of the width of Airy's. At the middle of the spectrum, with ``J_r`` the larger one,
        and a half the width of the lens that a thick foil leaves.
        """
        shade = self.thickness_mm * sine / np.sqrt(1.0 - sine * sine) / (2.0 * self.radius_mm)
        square = (
            self.numbers(sine, self._middle_mm)[:, 0] * np.maximum(1.0 - shade, 0.0) ** 2
        ) ** 2
        return np.asarray(1.0 / (1.0 + square / 0.42**2))

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
        shifts, weights, cell, margin = self._sun_on_table(sine)
        light, _ = self._quadrants(sine, reach + margin + 1, skewed=False)
        return spread(both_sides(light), shifts, weights, margin, cell)

    def fill(self, reach: int) -> Floats:
        """(T, 2 n + 1, n + 1) tables, with what `seen` leaves of the cubic phase.

        And of the rims' own depths. To first order: the whole of it less what taking points to
        other places of the tables, and to neighbouring incidences, does.
        """
        last = self.nodes - 1
        sines = [math.sin(math.radians(self.widest_deg) * node / last) for node in range(last + 1)]
        suns = [self._sun_on_table(sine) for sine in sines]
        size = reach + max(margin for *_, margin in suns) + 1
        lights, skews = np.array([self._quadrants(sine, size) for sine in sines]).swapaxes(0, 1)
        nodes = slopes(lights, 0)
        out = np.empty((last + 1, 2 * reach + 1, reach + 1))
        for node, (shifts, weights, cell, margin) in enumerate(suns):
            part = reach + margin + 1
            rest = self._rest(sines[node], lights[node], nodes[node], skews[node])
            both = both_sides(lights[node, :part, :part], rest[:part, :part])
            out[node] = spread(both, shifts, weights, margin, cell)
        return out

    def _rest(self, sine: float, light: Floats, change: Floats, whole: Floats) -> Floats:
        """(S, S) what is left of first order, of light and its change a node; odd along."""
        if sine == 0.0:
            return np.zeros(light.shape)
        steps, _ = self.scales(np.array([sine]))
        _, along, across = landing_points(np.array([sine]), self.layers())[0]
        c = self.seen(np.array([sine]))[0]
        places = np.arange(len(light))
        x, y = places[:, None] * (steps[0, 0] * along), places * (steps[0, 1] * across)
        done = slopes(light, 0) / (steps[0, 0] * along) * (c[0] + c[1] * x * x + c[2] * y * y)
        done += slopes(light, 1) / (steps[0, 1] * across) * c[3] * x * y
        done += c[4] * x * light + c[5] * x * change
        number = float(self.numbers(np.array([sine]), self._middle_mm)[0, 0])
        place = x / self.radius_mm
        waves = number * place * place / fade_half_waves(number)
        turned = math.pi * number * self._changes(sine)[0] * place**3 / _TURNED
        rest = np.exp(-turned * turned) * (whole - np.exp(-waves * waves) * done)
        # odd: the finite differences of `slopes` leave a little in the middle
        rest[0] = 0.0
        return np.asarray(rest)

    def _changes(self, sine: float) -> tuple[float, float, float, float]:
        """Return A and B of `seen`, and by how much J differs at the lens' arcs."""
        small = 1e-4
        angle = np.array([max(sine, small)])
        stack = self.layers()
        _, along, across = landing_points(angle, stack)[0]
        slope = (landing_points(angle + small, stack) - landing_points(angle - small, stack))[
            0, 1
        ] / (2 * small)
        foil = landing_points(angle, np.array([[self.thickness_mm, 1.0]]))[0] / 2.0
        share = self.radius_mm * sine / float(angle[0])
        return (
            share * slope / (3.0 * along**2),
            share * (along - across) / (along * across * float(angle[0])),
            -foil[1] / along,
            -foil[2] / across,
        )

    def _quadrants(self, sine: float, size: int, *, skewed: bool = True) -> tuple[Floats, Floats]:
        """(S, S) light of a point, of all wavelengths, in the tables' unit and steps, and its skew.

        The skew is what the phase's cubic term and the rims' own depths change, to first order; 0
        where it is not asked for, and at normal incidence.
        """
        steps, unit = self.scales(np.array([sine]))
        grid = np.arange(size) * steps.T
        light, skew = np.zeros((2, size, size))
        grown = 1.0 + self.growth
        radius = self.radius_mm * grown
        through = self.thickness_mm / math.sqrt(1.0 - sine * sine)
        apart = through * sine / radius
        if apart >= 2.0:
            return light, skew
        third, beside, more, other = self._changes(sine)
        for wavelength, weight in zip(
            self.spectrum.wavelengths_nm, self.spectrum.weights, strict=True
        ):
            # positions in units of the radius: cosines times J over a
            wave = wavelength * 1e-6
            along, across = self.numbers(np.array([sine]), wave)[0] * grown**2
            turn = radius / wave
            places = grid[0] * turn / along, grid[1] * turn / across
            blur = math.sqrt(wave * through / 2.0) / radius
            numbers = along, across
            if not skewed or sine == 0.0:
                light += weight * round_intensity(*places, numbers, apart=apart, blur=blur)
                continue
            # rims that lie upon each other cut alike
            part = 1.0 - 1.0 / (1.0 + math.pi * apart / blur) if blur > 0.0 else 0.0
            changes = third * grown, beside * grown, part * more, part * other
            own, change = round_skew(*places, numbers, changes, apart=apart, blur=blur)
            light += weight * own
            skew += weight * change
        return light / unit[0], skew / unit[0]

    def _sun_on_table(self, sine: float) -> tuple[Floats, Floats, Cell, int]:
        """Return `_spread` in steps of the table, and by how many it reaches beyond."""
        steps, _ = self.scales(np.array([sine]))
        shifts, weights, cell = self._spread(sine, steps[0])
        ends = shifts.max(axis=0) + cell[0].max(axis=0), shifts.min(axis=0) + cell[0].min(axis=0)
        return shifts, weights, cell, math.ceil(float(np.abs(ends).max())) + 3

    def _spread(self, sine: float, steps: Floats) -> tuple[Floats, Floats, Cell]:
        """(K, 2) shifts in steps of the table and (K,) weights of the Sun's disc, and the cell."""
        centre = np.array([[sine, 0.0, math.sqrt(1.0 - sine * sine)]])
        points = self.sun.directions(centre)
        chief, along, across = landing_points(np.array([sine]), self.layers())[0]
        sines = np.sqrt(np.sum(points[0, :, :2] ** 2, axis=1))
        places = points[0, :, :2] * landing_points(sines, self.layers())[:, 2:]
        shifts = (places - np.array([chief, 0.0])) / (np.array([along, across]) * steps)
        _, shares = self.sun.quadrature()
        passed = self.glass.transmission(points)[0] / self.glass.transmission(centre)[0]
        weights = shares * points[0, :, 2] / centre[0, 2] * passed
        if self.cell_mm == 0.0:
            return shifts, weights, (np.zeros((1, 2)), np.ones(1))
        per_mm = 1.0 / (np.array([along, across]) * steps)
        corner, share = turned_cell(max(2, math.ceil(self.cell_mm * float(per_mm.max())) + 1))
        return shifts, weights, (corner * self.cell_mm * per_mm, share)


@memory.tables(40, mapped=True)
def _tables(pattern: RoundPattern) -> Floats:
    return memory.mapped(pattern, partial(_filled, pattern))


def _filled(pattern: RoundPattern) -> Floats:
    steps, _ = pattern.scales(np.zeros(1))
    across = landing_points(np.zeros(1), pattern.layers())[0, 1]
    wave = min(pattern.spectrum.wavelengths_nm) * 1e-6 / (2.0 * math.pi * pattern.radius_mm)
    widest = min(pattern.reach_mm / across, pattern.radius_mm / across + _OUTSIDE * wave)
    reach = math.ceil(widest / float(steps[0, 0])) + 3
    return pattern.fill(reach)


def layers(height_mm: float, glass: CoverGlass) -> Floats:
    """(L, 2) thickness and index from an aperture down; the first is empty."""
    rows = [(height_mm - glass.thickness_mm, 1.0)]
    return np.array(rows + [(plate.thickness_mm, plate.index) for plate in glass.plates])


def landing_points(sine: Floats, stack: Floats) -> Floats:
    """(N, 3) where rays of these sines of incidence land, and J_r, J_t (see `diffraction`)."""
    indices = stack[:, 1] ** 2
    square = indices - sine[:, None] ** 2
    share = stack[:, 0] / np.sqrt(square)
    # asked for a few rays at a time, very often: with as few calls of NumPy as there can be
    found = np.empty((len(sine), 3))
    across = share.sum(axis=1, out=found[:, 2])
    (share * indices / square).sum(axis=1, out=found[:, 1])
    np.multiply(sine, across, out=found[:, 0])
    return found


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
