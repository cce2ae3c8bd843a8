"""Reference frames with one disc, and with a grid of discs."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from algorithms.contract import Floats, Observation, SensorGeometry
from benchmark.seeds import generator
from benchmark.synthetic_features.frames import REFERENCE_SETS
from benchmark.synthetic_features.light import (
    BACKGROUND_E,
    detect,
    peak_e,
    position_bound,
    spots,
    variance_e,
)
from benchmark.synthetic_features.series import (
    GLINT,
    Sample,
    SeriesPoint,
    locations,
    missing_features,
    noise,
    number,
    pedestals,
    phases,
    word,
)

_PITCH_MM, _FOCAL_MM = 0.05, 1.5
#: Samples the bound is averaged over: it varies with the sub-pixel phase only.
_BOUND_SAMPLES = 24


@dataclass(frozen=True)
class DiscSeries:
    """One disc in a frame of 64 x 64: the reference sets of `make bench`, and around them."""

    name: str = "disc"
    observation: Observation = Observation.FRAMES
    unit: str = "px"
    description: str = (
        "one disc of radius 8 px with a rim of 0.7 px in a frame of 64 x 64, background 20 e-, "
        "read noise 10 e-"
    )
    size_px: int = 64
    frames: int = 300

    def settings(self) -> tuple[SeriesPoint, ...]:
        """Return every point: the reference sets themselves, and one change at a time."""
        # signal over noise of the reference set: 2000 e- on 20 e-, read noise 10 e-
        snr = 2000.0 / math.sqrt(2120.0)
        base = SeriesPoint("reference", "disc", None, self.frames, snr, size_px=8.0, range_px=16.0)
        gaussian = replace(base, size_px=3.0, profile="gaussian", snr=200.0 / math.sqrt(320.0))
        return (
            base,
            replace(gaussian, point="gaussian"),
            *noise(base),
            *(number("size", r, base, size_px=r) for r in (2.0, 3.0, 4.0, 6.0, 8.0, 12.0)),
            *phases(base),
            *pedestals(base),
            word("profile", "flat", base),
            word("profile", "gaussian", replace(gaussian, snr=snr)),
            *locations(base, anywhere_px=20.0),
            *missing_features(base),
            word("tracking", "glint", base, range_px=10.0, tracking=True),
        )

    def geometry(self, setting: SeriesPoint) -> SensorGeometry:
        """Return a sensor whose one round aperture casts this disc (its light at half)."""
        half = setting.size_px * (
            math.sqrt(2.0 * math.log(2.0)) if setting.profile == "gaussian" else 1.0
        )
        middle = (self._side(setting) - 1) / 2.0
        return SensorGeometry(
            focal_length_mm=_FOCAL_MM,
            pixel_pitch_mm=_PITCH_MM,
            centre_px=(middle, middle),
            aperture_width_mm=2.0 * half * _PITCH_MM,
            aperture_shape="round",
            half_fov_deg=math.degrees(math.atan(middle * _PITCH_MM / _FOCAL_MM)),
        )

    def _side(self, setting: SeriesPoint) -> int:
        return 2 * self.size_px if setting.tracking else self.size_px

    def draw(self, setting: SeriesPoint) -> Sample:
        """Return frames (N, H, W), centres (N, 2) and their bound."""
        if setting.sweep == "reference":
            return self._reference(setting)
        side, peak = self._side(setting), peak_e(setting.snr)
        places = setting.places(self.name) + (
            np.array([32.0, 32.0]) if setting.tracking else (side - 1) / 2.0
        )

        def mean(centres: Floats) -> Floats:
            light = spots(side, centres[:, None], setting.size_px, setting.profile)
            return BACKGROUND_E + peak * light

        light = mean(places)
        if setting.tracking:
            glint = np.array([[[92.0, 90.0]]])
            light[1:] += GLINT * peak * spots(side, glint, setting.size_px, setting.profile)
        bound = position_bound(
            mean,
            places[:_BOUND_SAMPLES],
            lambda here: [here - BACKGROUND_E, np.ones_like(here)],
            lambda here: variance_e(here, peak),
        )
        frames = detect(light, peak, setting.pedestal, setting.noise(self.name))
        if setting.missing:
            dead = generator("sweep", self.name, setting.point, "dead").random(frames.shape)
            frames[dead < setting.missing] = 0
        return Sample(frames, places, bound)

    def _reference(self, setting: SeriesPoint) -> Sample:
        chosen = REFERENCE_SETS[setting.point]
        frames, centres = chosen.frames(setting.frames)
        return Sample(frames, centres, chosen.bound_px(centres[:_BOUND_SAMPLES]))

    def estimates(self, features: Floats) -> Floats:
        """Return the positions themselves."""
        return features


@dataclass(frozen=True)
class GridSeries:
    """A grid of equal discs that move together; the truth is where the grid's middle falls."""

    name: str = "grid"
    observation: Observation = Observation.FRAMES
    unit: str = "px"
    description: str = (
        "5 x 5 discs of radius 4 px, 16.37 px apart (no two fall alike on the pixels), in a frame "
        "of 128 x 128, background 20 e-, read noise 10 e-"
    )
    size_px: int = 128
    spacing_px: float = 16.37
    frames: int = 40

    def settings(self) -> tuple[SeriesPoint, ...]:
        """Return every point."""
        base = SeriesPoint("reference", "grid", None, self.frames, size_px=4.0, range_px=4.0)
        base = replace(base, features=5)
        return (
            base,
            *noise(base),
            *(number("size", r, base, size_px=r) for r in (2.0, 3.0, 4.0, 5.0)),
            *phases(base)[::2],
            *pedestals(base),
            *locations(base, anywhere_px=7.5),
            *missing_features(base),
            *(number("features", n * n, base, features=n) for n in (1, 2, 3, 5)),
            word("tracking", "glint", base, range_px=5.0, tracking=True),
        )

    def geometry(self, setting: SeriesPoint) -> SensorGeometry:
        """Return a sensor whose round apertures cast these discs."""
        middle = (self.size_px - 1) / 2.0
        width = 2.0 * setting.size_px * _PITCH_MM
        return SensorGeometry(
            focal_length_mm=_FOCAL_MM,
            pixel_pitch_mm=_PITCH_MM,
            centre_px=(middle, middle),
            aperture_width_mm=width,
            aperture_shape="round",
            # half the spacing: which spot is which is known from the grid's place
            half_fov_deg=math.degrees(math.atan(8.0 * _PITCH_MM / _FOCAL_MM)),
            apertures=tuple(
                (float(x) * _PITCH_MM, float(y) * _PITCH_MM, width) for x, y in self._grid(setting)
            ),
        )

    def _grid(self, setting: SeriesPoint) -> Floats:
        """(S, 2) offsets of the spots from the grid's middle, px, in rows."""
        steps = (np.arange(setting.features) - (setting.features - 1) / 2.0) * self.spacing_px
        x, y = np.meshgrid(steps, steps)
        return np.column_stack([x.ravel(), y.ravel()])

    def draw(self, setting: SeriesPoint) -> Sample:
        """Return frames (N, H, W), the grid's middle (N, 2) and its bound.

        The bound is of one common displacement, of the spots that are there.
        """
        peak, grid = peak_e(setting.snr), self._grid(setting)
        places = setting.places(self.name) + (self.size_px - 1) / 2.0
        there = np.ones((setting.frames, len(grid)))
        if setting.missing:
            rng = generator("sweep", self.name, setting.point, "missing")
            number_missing = round(setting.missing * len(grid))
            for row in there:
                row[rng.choice(len(grid), number_missing, replace=False)] = 0.0

        def mean(centres: Floats) -> Floats:
            each = centres[:, None] + grid[None]
            light = spots(self.size_px, each, setting.size_px, "flat", there[: len(centres)])
            return BACKGROUND_E + peak * light

        light = mean(places)
        if setting.tracking:
            # between the spots of a corner of the grid, where none of them ever is
            glint = np.array([[[119.0, 8.0]]])
            light[1:] += GLINT * peak * spots(self.size_px, glint, setting.size_px, "flat")
        few = places[: _BOUND_SAMPLES // 6]
        bound = position_bound(
            mean,
            few,
            lambda here: [here - BACKGROUND_E, np.ones_like(here)],
            lambda here: variance_e(here, peak),
        )
        return Sample(
            detect(light, peak, setting.pedestal, setting.noise(self.name)), places, bound
        )

    def estimates(self, features: Floats) -> Floats:
        """Return the positions themselves."""
        return features
