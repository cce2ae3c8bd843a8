"""Reference profiles: two linear arrays, each behind one slit or behind several."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from algorithms.contract import Floats, Observation, SensorGeometry
from benchmark.seeds import generator
from benchmark.synthetic_features.light import (
    BACKGROUND_E,
    bars,
    detect,
    peak_e,
    position_bound,
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

_PITCH_MM = 0.0125
_FOCAL_MM = 1.25
#: Places of several slits from the middle, px: no two distances are alike, nor two phases.
_PLACES_PX = (-50.63, -27.18, 0.0, 22.37, 48.91)
_BOUND_SAMPLES = 24


@dataclass(frozen=True)
class SlitSeries:
    """Profiles (N, 256): 128 pixels along x behind a slit or several, then 128 along y."""

    name: str = "slit"
    description: str = (
        "one bar of half width 8 px with edges of 0.7 px on each of two arrays of 128 pixels, "
        "background 20 e-, read noise 10 e-"
    )
    slits: int = 1
    half_px: float = 8.0
    observation: Observation = Observation.PROFILES
    unit: str = "px"
    pixels: int = 128
    frames: int = 300

    def settings(self) -> tuple[SeriesPoint, ...]:
        """Return every point."""
        several = self.slits > 1
        base = SeriesPoint("reference", self.name, None, self.frames, size_px=self.half_px)
        base = replace(base, range_px=4.0 if several else 20.0, features=self.slits)
        sizes = (2.0, 3.0, 4.0, 6.0) if several else (2.0, 3.0, 4.0, 6.0, 8.0, 12.0)
        counts = tuple(number("features", n, base, features=n) for n in (1, 2, 3, 5))
        return (
            base,
            *noise(base),
            *(number("size", half, base, size_px=half) for half in sizes),
            *phases(base),
            *pedestals(base),
            word("profile", "flat", base),
            word("profile", "gaussian", base, profile="gaussian", size_px=self.half_px / 2.0),
            *locations(base, anywhere_px=6.0 if several else 45.0),
            *missing_features(base),
            *(counts if several else ()),
            word("tracking", "glint", base, range_px=4.0 if several else 10.0, tracking=True),
        )

    def geometry(self, setting: SeriesPoint) -> SensorGeometry:
        """Return a sensor whose slits cast these bars (their light at half)."""
        half = setting.size_px * (
            math.sqrt(2.0 * math.log(2.0)) if setting.profile == "gaussian" else 1.0
        )
        width = 2.0 * half * _PITCH_MM
        middle = (self.pixels - 1) / 2.0
        reach = 8.0 if self.slits > 1 else middle
        return SensorGeometry(
            focal_length_mm=_FOCAL_MM,
            pixel_pitch_mm=_PITCH_MM,
            centre_px=(middle, middle),
            aperture_width_mm=width,
            half_fov_deg=math.degrees(math.atan(reach * _PITCH_MM / _FOCAL_MM)),
            line_axes=("x", "y"),
            line_pixels=self.pixels,
            slits=tuple((place * _PITCH_MM, 0.0, width) for place in self._places(setting)),
            mask_thickness_mm=0.0,
        )

    def _places(self, setting: SeriesPoint) -> tuple[float, ...]:
        first = (len(_PLACES_PX) - setting.features) // 2
        return _PLACES_PX[first : first + setting.features]

    def draw(self, setting: SeriesPoint) -> Sample:
        """Return profiles (N, 2 W), where the mask's middle falls (N, 2) and its bound."""
        peak, places = peak_e(setting.snr), np.array(self._places(setting))
        middle = setting.places(self.name) + (self.pixels - 1) / 2.0
        if setting.tracking and self.slits == 1:
            middle -= 25.0  # the glint stands on the other side
        there = np.ones((setting.frames, 2, len(places)))
        rng = generator("sweep", self.name, setting.point, "missing")
        if setting.missing and len(places) > 1:
            for row in there.reshape(-1, len(places)):
                row[rng.integers(len(places))] = 0.0

        def line(at: Floats, axis: int) -> Floats:
            each = at[:, axis, None] + places[None]
            lit = there[: len(at), axis]
            return bars(self.pixels, each, setting.size_px, setting.profile, lit)

        def mean(at: Floats) -> Floats:
            return BACKGROUND_E + peak * np.concatenate([line(at, 0), line(at, 1)], axis=1)

        light = mean(middle)
        if setting.tracking:
            far = np.array([[112.0 if self.slits == 1 else 99.0]])
            glint = bars(self.pixels, far, setting.size_px, setting.profile)[0]
            light[1:] += GLINT * peak * np.concatenate([glint, glint])
        bound = position_bound(
            mean,
            middle[:_BOUND_SAMPLES],
            # brightness and background of the arrays are each their own
            lambda here: [
                part
                for half in (np.arange(2 * self.pixels) < self.pixels,)
                for side in (half, ~half)
                for part in ((here - BACKGROUND_E) * side, np.ones_like(here) * side)
            ],
            lambda here: variance_e(here, peak),
        )
        profiles = detect(light, peak, setting.pedestal, setting.noise(self.name))
        if setting.missing and len(places) == 1:
            profiles[rng.random(profiles.shape) < setting.missing] = 0
        return Sample(profiles, middle, bound)

    def estimates(self, features: Floats) -> Floats:
        """Return the positions themselves."""
        return features


SLIT = SlitSeries()
SLITS = SlitSeries(
    name="slits",
    description=(
        "five bars of half width 4 px with edges of 0.7 px, unevenly spaced, on each of two "
        "arrays of 128 pixels, background 20 e-, read noise 10 e-"
    ),
    slits=5,
    half_px=4.0,
)
