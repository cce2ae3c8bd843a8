"""The diffracted spots of many round holes on one detector: `RoundSpots`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.optics.diffraction import Spectrum
from benchmark.simulator.optics.diffraction_tables import RoundPattern, landing
from benchmark.simulator.optics.projection import Camera

Integers = NDArray[np.int64]

#: Tables end this far outside the shadow, in ``k a`` times the direction cosine, where the skirt
#: has 8e-5 of the peak of a far pattern; further out they fall with the cube of the distance.
_TABULATED = 25.0
#: Largest phase across a cell, of waves at half the highest frequency, for which averaging over
#: all ways to turn it will do. The Sun and the colours leave little of such waves: frames of the
#: standard datasets are within 0.4 % of peak of 4 x 4 cells a pixel.
_CELL_RAD = 5.5
#: Sizes of the tabulated holes differ at least so much, relatively.
_LEAST_GROWTH = 1e-3


@dataclass(frozen=True)
class RoundSpots:
    """What a camera's round holes put on pixels: Fresnel diffraction of every hole by itself.

    Holes of one drawn diameter share two tables (`RoundPattern`), of holes smaller and larger by
    `size_mm` than their built mean, between which each is interpolated linearly in its radius a:
    the edges lie where the built rim puts them and the light follows the built area, to first
    order. What is left is ``(da^2 - size_mm^2) / 2`` times the second derivative over the radius,
    which is at most ``(2 pi N / a)^2`` times the peak: 1e-3 of it for a = 50 um, N = 4 and 0.25 um.

    A pixel is divided into cells over which tables are averaged whichever way they are turned
    (`RoundPattern.cell_mm`): one look-up a cell.

    Light of a spot is left out where its skirt - ``4 pi N_r N_t / v^3`` of the open light, v the
    ``k a`` times the direction cosine, on average over the rings of Airy's pattern - is below
    `skirt` of the brightest spot at normal incidence: of 1e-4, that is 2 to 4 % of the light,
    spread all over the detector.

    Attributes
    ----------
    camera
        Its mask has round holes only.
    spectrum
        Wavelengths and weights.
    pitch_mm
        Of the pixels.
    widest_deg
        Largest incidence tabulated; beyond, the pattern keeps this one's Fresnel numbers.
    size_mm
        By how much radii of built holes typically differ from each other's mean.
    skirt
        Share of the peak at normal incidence below which light is left out.
    """

    camera: Camera
    spectrum: Spectrum
    pitch_mm: float
    widest_deg: float
    size_mm: float
    skirt: float

    @cached_property
    def _groups(self) -> tuple[tuple[float, NDArray[np.int64]], ...]:
        """Drawn diameters and the holes that have them."""
        widths = np.array([aperture.width_mm for aperture in self.camera.mask.apertures])
        return tuple((float(width), np.flatnonzero(widths == width)) for width in np.unique(widths))

    @cached_property
    def _wave_mm(self) -> float:
        waves = np.array(self.spectrum.wavelengths_nm) * 1e-6
        return float(np.sum(waves * np.array(self.spectrum.weights)))

    def cells(self, diameter_mm: float) -> int:
        """Cells a side of a pixel."""
        across = float(landing(np.zeros(1), self._pattern(diameter_mm, 0.0, 1).layers())[0, 2])
        phase = math.pi * diameter_mm / (self._wave_mm * across) * self.pitch_mm
        return max(1, math.ceil(phase / _CELL_RAD))

    def patterns(self, diameter_mm: float, radii_mm: Floats) -> tuple[RoundPattern, RoundPattern]:
        """Return tables of a smaller and a larger hole than the mean of the built radii."""
        mean = math.fsum(radii_mm) / len(radii_mm) / (diameter_mm / 2.0) - 1.0
        growth = max(2.0 * self.size_mm / diameter_mm, _LEAST_GROWTH)
        cells = self.cells(diameter_mm)
        return (
            self._pattern(diameter_mm, mean - growth, cells),
            self._pattern(diameter_mm, mean + growth, cells),
        )

    def _pattern(self, diameter_mm: float, growth: float, cells: int) -> RoundPattern:
        camera = self.camera
        radius = diameter_mm / 2.0
        reach = _TABULATED * self._wave_mm * camera.height_mm / (2.0 * math.pi * radius)
        return RoundPattern(
            radius_mm=radius,
            height_mm=camera.height_mm,
            glass=camera.glass,
            sun=camera.sun,
            spectrum=self.spectrum,
            reach_mm=radius + reach,
            widest_deg=self.widest_deg,
            thickness_mm=camera.mask.thickness_mm,
            growth=growth,
            cell_mm=self.pitch_mm / cells,
        )

    def _half_axes(self, head: Floats, pattern: RoundPattern) -> Floats:
        """(N, 2) of the ellipses that hold a spot, along and across the plane of incidence, mm."""
        sine = np.sqrt(np.sum(head[:, :2] ** 2, axis=1))
        spread = landing(sine, pattern.layers())[:, 1:]
        numbers = pattern.numbers(sine, self._wave_mm)
        _, unit = pattern.scales(np.zeros(1))
        level = self.skirt * float(pattern.tables()[0].max() * unit[0])
        light = 4.0 * math.pi * numbers[:, 0] * numbers[:, 1] * head[:, 2]
        out = np.array([(float(share) / level) ** (1.0 / 3.0) for share in light])
        turned = out[:, None] * self._wave_mm / (2.0 * math.pi * pattern.radius_mm)
        turned += math.sin(math.radians(self.camera.sun.diameter_deg / 2.0))
        return np.asarray(spread * turned + pattern.radius_mm + self.pitch_mm)

    def boxes(self, sun: Floats, holes_mm: Floats, size: tuple[int, int], margin: int) -> Integers:
        """(N, A, 4) first and past-last column and row each hole lights, within the detector.

        Parameters
        ----------
        sun
            (N, 3) directions.
        holes_mm
            (A, 3) built x and y from the detector's first corner, and radius.
        size
            Columns and rows.
        margin
            Pixels added all around.
        """
        head, front = self._head(sun)
        sine = np.sqrt(np.sum(head[:, :2] ** 2, axis=1))
        safe = np.where(sine > 0.0, sine, 1.0)
        turn = np.where(sine[:, None] > 0.0, head[:, :2] / safe[:, None], [1.0, 0.0])
        chief = self.camera.glass.displacement(head, self.camera.height_mm)
        boxes = np.zeros((len(sun), len(holes_mm), 4), dtype=np.int64)
        for diameter, mine in self._groups:
            half = self._half_axes(head, self.patterns(diameter, holes_mm[mine, 2])[0])
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
            limit = np.array(size, dtype=np.float64)
            first = np.clip(np.floor(low), 0.0, limit).astype(np.int64)
            last = np.clip(np.ceil(high), 0.0, limit).astype(np.int64)
            empty = (last <= first).any(axis=2) | ~front[:, None]
            last[empty] = first[empty]
            boxes[:, mine] = np.stack(
                [first[..., 0], last[..., 0], first[..., 1], last[..., 1]], axis=-1
            )
        return boxes

    def add(
        self, frame: Floats, sun: Floats, holes_mm: Floats, passed: Floats, boxes: Integers
    ) -> None:
        """Add the light of one sample, in units of mean sunlight, to a frame (rows, columns).

        Parameters
        ----------
        frame
            Added to.
        sun
            (1, 3) direction.
        holes_mm
            As of `boxes`.
        passed
            (A,) light that each hole passes.
        boxes
            (A, 4) as of `boxes`, without a margin.
        """
        from benchmark.simulator.kernels.diffraction import add_spots  # noqa: PLC0415 - Numba

        head, front = self._head(sun)
        if not front[0]:
            return
        sine = np.sqrt(np.sum(head[:, :2] ** 2, axis=1))
        known = np.minimum(sine, math.sin(math.radians(self.widest_deg)))
        transmitted = head[0, 2] * self.camera.glass.transmission(head)[0]
        for diameter, mine in self._groups:
            lit = mine[(boxes[mine, 1] > boxes[mine, 0]) & (boxes[mine, 3] > boxes[mine, 2])]
            if not len(lit):
                continue
            small, large = self.patterns(diameter, holes_mm[mine, 2])
            steps, unit = small.scales(known)
            numbers = np.array(
                [
                    transmitted * unit[0],
                    small.place(known)[0],
                    *(1.0 / steps[0]),
                    *small.seen(known)[0],
                ]
            )
            part = (holes_mm[lit, 2] / small.radius_mm - 1.0 - small.growth) / (
                large.growth - small.growth
            )
            cells = self.cells(diameter)
            inside = (np.arange(cells) + 0.5) * (self.pitch_mm / cells)
            add_spots(
                frame,
                (small.tables(), large.tables()),
                (head[0], numbers, self._half_axes(head, small)[0]),
                (
                    np.column_stack([holes_mm[lit, :2], part, passed[lit]]),
                    np.ascontiguousarray(boxes[lit]),
                ),
                (small.layers(), np.column_stack([inside, np.full(cells, 1.0 / cells)])),
            )

    def _head(self, sun: Floats) -> tuple[Floats, NDArray[np.bool_]]:
        """(N, 3) the Sun as the head sees it, (N,) if in front; straight above where it is not."""
        head = self.camera.assembly.to_head(sun)
        front = head[:, 2] > 1e-6
        return np.where(front[:, None], head, [0.0, 0.0, 1.0]), front
