"""Frames of many spots, drawn afresh, at whole-pixel and fractional pitch: clean, with spots
missing, dirty and beside others, with an edge column dark or doubled.

Discs of radius 4 px, peak 2000 e-, background 20 e-, read noise 10 e-, 12 bit. The answer is where
the pattern's middle falls.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from algorithms.contract import Floats, SensorGeometry
from benchmark.seeds import generator
from benchmark.synthetic_features.frame_sets import Scenes
from benchmark.synthetic_features.light import position_bound, spots
from benchmark.synthetic_features.shapes import BACKGROUND_E, read_out, variance_e

_RADIUS_PX, _PEAK_E, _BITS = 4.0, 2000.0, 12
#: Of the sensor behind: any will do.
_PITCH_MM, _FOCAL_MM = 0.05, 1.5
_BATCH = 10
_BOUND_FRAMES = 4
#: How far the middle goes from the frame's, and room around the pattern, px.
_RANGE_PX, _ROOM_PX = 6.0, 26.0
#: Shares of spots that are missing or dirty, and how much light dirt leaves.
_MISSING, _DIRTY = 0.2, 0.3
_DIRT = (0.3, 0.9)
#: Spots of no aperture.
_EXTRA = 3

Spoilt = Literal["", "missing", "dirty", "extra", "dark edge", "double edge"]


@dataclass(frozen=True)
class GridSet:
    """A square grid of spots.

    Attributes
    ----------
    side
        Spots a row.
    spacing_px
        Distance of two.
    spoilt
        What is not as the design says.
    """

    side: int
    spacing_px: float
    spoilt: Spoilt = ""

    @property
    def name(self) -> str:
        """What the table calls it."""
        said = self.spoilt or "clean"
        return f"{self.side}x{self.side} {said}"

    @property
    def group(self) -> str:
        """The table it is printed in."""
        return f"grids {self.spacing_px:g} px apart"

    @property
    def size_px(self) -> int:
        """Side of the frame."""
        return math.ceil((self.side - 1) * self.spacing_px + 2.0 * _ROOM_PX)

    def offsets(self) -> Floats:
        """(S, 2) places of the spots from the grid's middle, px, in rows."""
        steps = (np.arange(self.side) - (self.side - 1) / 2.0) * self.spacing_px
        x, y = np.meshgrid(steps, steps)
        return np.column_stack([x.ravel(), y.ravel()])

    def geometry(self) -> SensorGeometry:
        """Return a sensor whose round apertures cast these spots."""
        middle = (self.size_px - 1) / 2.0
        width = 2.0 * _RADIUS_PX * _PITCH_MM
        return SensorGeometry(
            focal_length_mm=_FOCAL_MM,
            pixel_pitch_mm=_PITCH_MM,
            centre_px=(middle, middle),
            aperture_width_mm=width,
            aperture_shape="round",
            half_fov_deg=math.degrees(math.atan(self.spacing_px / 2.0 * _PITCH_MM / _FOCAL_MM)),
            apertures=tuple(
                (float(x) * _PITCH_MM, float(y) * _PITCH_MM, width) for x, y in self.offsets()
            ),
        )

    def draw(self, seed: int, count: int) -> Scenes:
        """Return the first `count` frames of this set under a seed."""
        frames = np.empty((count, self.size_px, self.size_px), dtype=np.uint16)
        places = np.empty((count, 2))
        bound = math.nan
        for first in range(0, count, _BATCH):
            rng = generator("robustness", seed, self.group, self.name, first // _BATCH)
            middle = (self.size_px - 1) / 2.0
            at = middle + rng.uniform(-_RANGE_PX, _RANGE_PX, (_BATCH, 2))
            offsets, lights = self._spoilt(rng)
            if first == 0:
                number = self.side**2  # of spots beyond them nobody knows the place
                bound = self._bound_px(at, offsets[:, :number], lights[:, :number])
            read = read_out(self._mean(at, offsets, lights), _BITS, rng)
            part = slice(first, min(first + _BATCH, count))
            frames[part], places[part] = read[: count - first], at[: count - first]
        return Scenes(frames, places, bound)

    def _mean(self, at: Floats, offsets: Floats, lights: Floats) -> Floats:
        light = spots(self.size_px, at[:, None] + offsets, _RADIUS_PX, "flat", lights)
        return BACKGROUND_E + _PEAK_E * light

    def _spoilt(self, rng: np.random.Generator) -> tuple[Floats, Floats]:
        """Places (N, S, 2) of spots from the middle, and their light (N, S)."""
        grid = self.offsets()
        number = len(grid)
        offsets = np.repeat(grid[None], _BATCH, axis=0)
        lights = np.ones((_BATCH, number))
        if self.spoilt in {"missing", "dirty"}:
            share = _MISSING if self.spoilt == "missing" else _DIRTY
            for row in lights:
                which = rng.choice(number, round(share * number), replace=False)
                row[which] = 0.0 if self.spoilt == "missing" else rng.uniform(*_DIRT, len(which))
        elif self.spoilt == "extra":
            half = grid.max() + self.spacing_px
            more = rng.uniform(-half, half, (_BATCH, _EXTRA, 2))
            offsets = np.concatenate([offsets, more], axis=1)
            lights = np.concatenate([lights, rng.uniform(0.5, 1.0, (_BATCH, _EXTRA))], axis=1)
        elif self.spoilt:
            axis, sign = rng.integers(2, size=_BATCH), rng.choice((-1.0, 1.0), _BATCH)
            along = grid[:, axis].T * sign[:, None]
            edge = np.isclose(along, along.max())
            if self.spoilt == "dark edge":
                lights[edge] = 0.0
            else:
                step = np.zeros((_BATCH, 1, 2))
                step[np.arange(_BATCH), 0, axis] = sign * self.spacing_px
                twice = edge.reshape(_BATCH, number)
                more = (offsets + step)[twice].reshape(_BATCH, self.side, 2)
                offsets = np.concatenate([offsets, more], axis=1)
                lights = np.concatenate([lights, np.ones((_BATCH, self.side))], axis=1)
        return offsets, lights

    def _bound_px(self, at: Floats, offsets: Floats, lights: Floats) -> float:
        """Bound of the middle by the apertures' spots, their shares of the light known.

        Unknown are the common brightness and the background, as for one spot.
        """
        few = slice(0, _BOUND_FRAMES)
        return position_bound(
            lambda places: self._mean(places, offsets[few], lights[few]),
            at[few],
            lambda here: [here - BACKGROUND_E, np.ones_like(here)],
            variance_e,
        )


_SPOILT: tuple[Spoilt, ...] = ("", "missing", "dirty", "extra", "dark edge", "double edge")
GRID_SETS: tuple[GridSet, ...] = tuple(
    GridSet(side, spacing, spoilt)
    for spacing in (16.0, 16.37)
    for side, spoilt in (
        (2, ""),
        *((5, spoilt) for spoilt in _SPOILT),
        (10, ""),
    )
)
