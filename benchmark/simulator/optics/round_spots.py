"""The diffracted spots of many round holes on one detector: `RoundSpots`, `RoundLight`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.optics.diffraction import Spectrum
from benchmark.simulator.optics.diffraction_tables import RoundPattern, landing_points, layers
from benchmark.simulator.optics.projection import Camera

Integers = NDArray[np.int64]

#: Tables end this far outside the shadow, in ``k a`` times the direction cosine, where the skirt
#: has 8e-5 of the peak of a far pattern; further out they fall with the cube of the distance.
_TABULATED = 25.0
#: Largest phase across a cell, of waves at half the highest frequency, for which averaging over
#: all ways to turn it will do. The Sun and the colours leave little of such waves: frames of the
#: standard datasets are within 0.4 % of peak of 4 x 4 cells a pixel.
_CELL_RAD = 5.5
#: The smaller and the larger tabulated hole are off by so many standard deviations of built radii:
#: the parabola through the three is out by as much at 2.6 of them as anywhere between.
_DEVIATIONS = 2.25
#: And by so much of the radius, at least and at most.
_LEAST_GROWTH, _MOST_GROWTH = 1e-2, 0.5
#: A hole so many times as far off as those two is refused: the parabola is out by per cents there.
_FARTHEST = 2.5
#: Points a pixel, an axis, of the lattice that holes share: frames of the standard data sets are
#: within 8e-4 of peak of looking every pixel up.
_LATTICE = 4


@dataclass(frozen=True)
class _Holes:
    """Holes of one drawn diameter, and what their light is looked up in."""

    diameter_mm: float
    mine: NDArray[np.int64]
    #: Of holes smaller than drawn, as drawn, and larger.
    sizes: tuple[RoundPattern, RoundPattern, RoundPattern]
    #: Light below which a spot is left out.
    level: float
    #: (Q, 2) nodes in a pixel, mm from its first edge, and their weights.
    nodes: Floats
    pitch_mm: float
    #: Points a pixel of the lattice that the holes share; 0 for none.
    lattice: int

    @property
    def drawn(self) -> RoundPattern:
        """Of the hole as drawn."""
        return self.sizes[1]

    def tables(self, shares: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the three sizes'; holes as drawn need no others: theirs three times."""
        # not kept: holes live as long as their data set, tables while it is looked at
        small, drawn, large = self.sizes
        if not shares[:, ::2].any():
            small = large = drawn
        return small.tables(), drawn.tables(), large.tables()

    def shares(self, radii_mm: Floats) -> Floats:
        """Return (A, 3) weights of the tables for holes of these radii: Lagrange's parabola.

        Raises
        ------
        ValueError
            When a hole is further from its drawing than the mask's errors let expect.
        """
        growth = self.sizes[2].growth
        place = (radii_mm / self.drawn.radius_mm - 1.0) / growth
        off = np.abs(place).max()
        if off > _FARTHEST:
            raise ValueError(
                f"holes drawn {self.diameter_mm} mm wide must be built within "
                f"{100.0 * _FARTHEST * growth:.3g} % of it, as the mask's errors let expect; got "
                f"one {100.0 * off * growth:.3g} % off"
            )
        # drawn, but for rounding
        place = np.where(np.abs(place) < 1e-9, 0.0, place)
        square = place * place
        return np.column_stack([(square - place) / 2.0, 1.0 - square, (square + place) / 2.0])


@dataclass(frozen=True)
class RoundSpots:
    """Light of a camera's round holes on pixels, by Fresnel diffraction of each hole.

    Holes of one drawn diameter share three tables (`RoundPattern`), between which their light is
    interpolated: of the drawn radius, and of radii smaller and larger by 2.25 `size_mm`.

    Attributes
    ----------
    camera
        Its mask has round holes only.
    spectrum
        Wavelengths and weights.
    pitch_mm
        Of the pixels.
    size_px
        Columns and rows of the detector.
    widest_deg
        Largest incidence tabulated; beyond, the pattern keeps this one's Fresnel numbers.
    size_mm
        Standard deviation of built radii from the drawn one (`MaskErrors.radius_mm`).
    skirt
        Share of the peak at normal incidence below which light is left out.

    Notes
    -----
    It is interpolated by a parabola in the radius a, with the error ``x (x^2 - g^2) / 6`` times the
    third derivative over a, x the hole's excess and g that of the larger table. Against a table of
    every hole's own radius, six units of each: 1.0e-3 of peak on `ccd-multi-aperture`, 4e-4 on
    `cmos-multi-aperture` (1.1e-3 where a unit's holes are 2.5 % too small) and 4e-5 on
    `cmos-encoded`. It grows with the cube of x. With lattice and height (below), frames of standard
    units are within 1.9e-3 of peak.

    Tables are for the drawn height, whatever the built one: light that has gone ``r`` times as far
    has the Fresnel numbers, and so the pattern, of a hole ``sqrt(r)`` times smaller, ``sqrt(r)``
    times as large. This leaves out ``(r - 1) / 2`` of the width of the Sun's image and the pixel,
    up to 1.2e-3 of peak for the heights of the standard data sets (0.3 % off).

    A pixel is divided into cells over which tables are averaged whichever way they are turned
    (`RoundPattern.cell_mm`): one look-up a cell. Where many holes light one frame, their common
    pattern is looked up once, on a lattice finer than the pixels, and interpolated by Lagrange's
    quintic along rows and columns at the place of each.

    Light of a spot is left out where its skirt - ``4 pi N_r N_t / v^3`` of the open light, v the
    ``k a`` times the direction cosine, on average over the rings of Airy's pattern - is below
    `skirt` of the brightest spot at normal incidence: of 1e-4, that is 2 to 4 % of the light,
    spread all over the detector.
    """

    camera: Camera
    spectrum: Spectrum
    pitch_mm: float
    size_px: tuple[int, int]
    widest_deg: float
    size_mm: float
    skirt: float

    @cached_property
    def groups(self) -> tuple[_Holes, ...]:
        """Holes by their drawn diameters."""
        widths = np.array([aperture.width_mm for aperture in self.camera.mask.apertures])
        return tuple(
            self._group(float(width), np.flatnonzero(widths == width))
            for width in np.unique(widths)
        )

    def _group(self, diameter_mm: float, mine: NDArray[np.int64]) -> _Holes:
        cells = self.cells(diameter_mm)
        sizes = self.sizes(diameter_mm)
        _, unit = sizes[1].scales(np.zeros(1))
        inside = (np.arange(cells) + 0.5) * (self.pitch_mm / cells)
        # as many as lie over the detector light it at a time
        half = np.array(self.size_px) * self.pitch_mm / 2.0
        places = np.array([(a.x_mm, a.y_mm) for a in self.camera.mask.apertures])[mine]
        shown = int((np.abs(places) <= half).all(axis=1).sum())
        return _Holes(
            diameter_mm,
            mine,
            sizes,
            self.skirt * float(sizes[1].tables()[0].max() * unit[0]),
            np.column_stack([inside, np.full(cells, 1.0 / cells)]),
            self.pitch_mm,
            # three tables on every point of it, against one look-up a pixel
            _LATTICE if shown > 4 * _LATTICE**2 else 0,
        )

    @cached_property
    def _stretch(self) -> float:
        """How many times larger a spot is than from the drawn height: the root of the way's."""
        ways = [
            float(landing_points(np.zeros(1), layers(height, self.camera.glass))[0, 1])
            for height in (self.camera.height_mm, self.camera.focal_length_mm)
        ]
        return math.sqrt(ways[0] / ways[1])

    @cached_property
    def _wave_mm(self) -> float:
        waves = np.array(self.spectrum.wavelengths_nm) * 1e-6
        return float(np.sum(waves * np.array(self.spectrum.weights)))

    def cells(self, diameter_mm: float) -> int:
        """Cells a side of a pixel."""
        across = float(
            landing_points(np.zeros(1), self._pattern(diameter_mm, 0.0, 1).layers())[0, 2]
        )
        phase = math.pi * diameter_mm / (self._wave_mm * across) * self.pitch_mm
        return max(1, math.ceil(phase / _CELL_RAD))

    def sizes(self, diameter_mm: float) -> tuple[RoundPattern, RoundPattern, RoundPattern]:
        """Return patterns of holes smaller than drawn, as drawn, and larger."""
        growth = 2.0 * _DEVIATIONS * self.size_mm / diameter_mm
        growth = min(max(growth, _LEAST_GROWTH), _MOST_GROWTH)
        of = partial(self._pattern, diameter_mm, cells=self.cells(diameter_mm))
        return of(growth=-growth), of(growth=0.0), of(growth=growth)

    def _pattern(self, diameter_mm: float, growth: float, cells: int) -> RoundPattern:
        camera = self.camera
        radius, height = diameter_mm / 2.0, camera.focal_length_mm
        reach = _TABULATED * self._wave_mm * height / (2.0 * math.pi * radius)
        return RoundPattern(
            radius_mm=radius,
            height_mm=height,
            glass=camera.glass,
            sun=camera.sun,
            spectrum=self.spectrum,
            reach_mm=radius + reach,
            widest_deg=self.widest_deg,
            thickness_mm=camera.mask.thickness_mm,
            growth=growth,
            cell_mm=self.pitch_mm / cells,
        )

    def _half_axes(self, head: Floats, group: _Holes) -> Floats:
        """(N, 2) of the ellipses that hold a spot, along and across the plane of incidence, mm."""
        pattern = group.drawn
        sine = np.sqrt(np.sum(head[:, :2] ** 2, axis=1))
        spread = landing_points(sine, pattern.layers())[:, 1:]
        numbers = pattern.numbers_where(spread, self._wave_mm)
        light = 4.0 * math.pi * numbers[:, 0] * numbers[:, 1] * head[:, 2]
        out = np.array([(float(share) / group.level) ** (1.0 / 3.0) for share in light])
        turned = out[:, None] * self._wave_mm / (2.0 * math.pi * pattern.radius_mm)
        turned += math.sin(math.radians(self.camera.sun.diameter_deg / 2.0))
        return np.asarray(spread * turned + pattern.radius_mm + self.pitch_mm)

    def boxes(self, sun: Floats, holes_mm: Floats, margin: int = 0) -> Integers:
        """(N, A, 4) first and past-last column and row each hole lights, within the detector.

        Parameters
        ----------
        sun
            (N, 3) directions.
        holes_mm
            (A, 3) built x and y from the detector's first corner, and radius.
        margin
            Pixels added all around.
        """
        head, front = self._head(sun)
        sine = np.sqrt(np.sum(head[:, :2] ** 2, axis=1))
        safe = np.where(sine > 0.0, sine, 1.0)
        turn = np.where(sine[:, None] > 0.0, head[:, :2] / safe[:, None], [1.0, 0.0])
        chief = self.camera.glass.displacement(head, self.camera.height_mm)
        boxes = np.zeros((len(sun), len(holes_mm), 4), dtype=np.int64)
        for group in self.groups:
            half, mine = self._half_axes(head, group), group.mine
            wide = np.stack(
                [
                    np.sqrt((half[:, 0] * turn[:, 0]) ** 2 + (half[:, 1] * turn[:, 1]) ** 2),
                    np.sqrt((half[:, 0] * turn[:, 1]) ** 2 + (half[:, 1] * turn[:, 0]) ** 2),
                ],
                axis=1,
            )
            middle = chief[:, None, :] + holes_mm[None, mine, :2]
            low = (middle - wide[:, None, :]) / self.pitch_mm - margin
            high = (middle + wide[:, None, :]) / self.pitch_mm + margin
            limit = np.array(self.size_px, dtype=np.float64)
            first = np.clip(np.floor(low), 0.0, limit).astype(np.int64)
            last = np.clip(np.ceil(high), 0.0, limit).astype(np.int64)
            empty = (last <= first).any(axis=2) | ~front[:, None]
            last[empty] = first[empty]
            boxes[:, mine] = np.stack(
                [first[..., 0], last[..., 0], first[..., 1], last[..., 1]], axis=-1
            )
        return boxes

    def light(self, sun: Floats, holes_mm: Floats, passed: Floats) -> RoundLight:
        """Return the light of Suns (N, 3), in units of mean sunlight, to be added to frames.

        Parameters
        ----------
        sun
            (N, 3) directions.
        holes_mm
            As of `boxes`.
        passed
            (N, A) light that each hole passes; 0 where it is closed.
        """
        head, front = self._head(sun)
        boxes = self.boxes(sun, holes_mm)
        boxes[(passed == 0.0) | ~front[:, None]] = 0
        sine = np.sqrt(np.sum(head[:, :2] ** 2, axis=1))
        known = np.minimum(sine, math.sin(math.radians(self.widest_deg)))
        transmitted = head[:, 2] * self.camera.glass.transmission(head)
        wide = self._stretch
        # tables are of the drawn height: so much smaller is a hole that looks alike there
        alike = holes_mm[:, 2] / wide
        numbers, axes, shares = [], [], np.empty((len(holes_mm), 3))
        for group in self.groups:
            steps, unit = group.drawn.scales(known)
            # lengths of the drawn height's pattern, on the built one's
            seen = group.drawn.seen(known) * np.array([wide, *(1.0 / wide,) * 5])
            place = group.drawn.place(known)
            light = transmitted * unit
            numbers.append(np.column_stack([light, place, wide / steps, seen]))
            axes.append(self._half_axes(head, group))
            shares[group.mine] = group.shares(alike[group.mine])
        return RoundLight(
            self.groups,
            layers(self.camera.height_mm, self.camera.glass),
            holes_mm[:, :2],
            shares,
            head,
            passed,
            boxes,
            (tuple(numbers), tuple(axes)),
        )

    def _head(self, sun: Floats) -> tuple[Floats, NDArray[np.bool_]]:
        """(N, 3) the Sun as the head sees it, (N,) if in front; straight above where it is not."""
        head = self.camera.assembly.to_head(sun)
        front = head[:, 2] > 1e-6
        return np.where(front[:, None], head, [0.0, 0.0, 1.0]), front


@dataclass(frozen=True, eq=False)
class RoundLight:
    """The spots of some samples, rendered one sample at a time.

    Attributes
    ----------
    groups, layers
        Of `RoundSpots`; (L, 2) of the built camera.
    holes_mm
        (A, 2) built x and y from the detector's first corner.
    shares
        (A, 3) of the tables in each hole.
    head
        (N, 3) the Sun as the head sees it.
    passed
        (N, A) light that each hole passes.
    boxes
        (N, A, 4) pixels that each hole lights; empty where none.
    patterns
        Of every group (N, 10) light of an open pixel, place among the tables, steps a unit of
        direction cosine (2), and `RoundPattern.seen` (6); and (N, 2) half axes of spots.
    """

    groups: tuple[_Holes, ...]
    layers: Floats
    holes_mm: Floats
    shares: Floats
    head: Floats
    passed: Floats
    boxes: Integers
    patterns: tuple[tuple[Floats, ...], tuple[Floats, ...]]

    @cached_property
    def _tables(self) -> tuple[tuple[Floats, Floats, Floats], ...]:
        return tuple(group.tables(self.shares[group.mine]) for group in self.groups)

    def add(self, frame: Floats, n: int) -> Integers:
        """Add the light of sample n to a frame (rows, columns).

        Returns
        -------
        (B, 4) the boxes outside of which nothing was added.
        """
        from benchmark.simulator.kernels.diffraction import (  # noqa: PLC0415 - Numba
            add_spots,
            add_spots_alike,
        )

        boxes = self.boxes[n]
        lit = (boxes[:, 1] > boxes[:, 0]) & (boxes[:, 3] > boxes[:, 2])
        kinds = zip(self.groups, self._tables, *self.patterns, strict=True)
        for group, tables, numbers, axes in kinds:
            mine = group.mine[lit[group.mine]]
            if not len(mine):
                continue
            sample, shares = (self.head[n], numbers[n], axes[n]), self.shares[mine]
            rows = np.column_stack([self.holes_mm[mine], self.passed[n, mine], shares])
            holes = rows, np.ascontiguousarray(boxes[mine])
            if group.lattice:
                optics = self.layers, group.nodes, group.lattice
                add_spots_alike(frame, tables, sample, holes, optics)
            else:
                add_spots(frame, tables, sample, holes, (self.layers, group.nodes))
        return np.asarray(boxes[lit])

    def mark(self, near: NDArray[np.bool_], n: int, margin_px: int) -> None:
        """Mark pixels (rows, columns) in sample n's spots, or within `margin_px` of them."""
        from benchmark.simulator.kernels.ellipses import mark_ellipses  # noqa: PLC0415 - Numba

        boxes, sun = self.boxes[n], self.head[n]
        lit = (boxes[:, 1] > boxes[:, 0]) & (boxes[:, 3] > boxes[:, 2])
        sine = math.hypot(sun[0], sun[1])
        direction = sun[:2] / sine if sine > 0.0 else np.array([1.0, 0.0])
        chief = direction * float(landing_points(np.array([sine]), self.layers)[0, 0])
        for group, axes in zip(self.groups, self.patterns[1], strict=True):
            mine = group.mine[lit[group.mine]]
            middles = (self.holes_mm[mine] + chief) / group.pitch_mm
            mark_ellipses(near, middles, axes[n] / group.pitch_mm + margin_px, direction)
