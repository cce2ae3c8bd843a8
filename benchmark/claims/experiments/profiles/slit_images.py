"""Images of slits on two arrays of pixels, in closed form, and the errors of who reads them.

Lengths are in pixels of the design, 12.5 um: an image is 16 of them wide, its edges are
blurred by 0.7 (one standard deviation), an array has 128. Brightness is 1 within an image.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from algorithms.contract import Extractor, Floats, SensorGeometry
from benchmark.claims.benches import rms
from benchmark.synthetic_features.light import position_bound

DESIGN_PITCH_MM = 0.0125
_FOCAL_MM = 1.25
_LENGTH_PX = 128
HALF_PX = 8.0
_EDGE_PX = 0.7
#: Farthest that the mask's shadow moves, either way along each array.
_REACH_PX = 20.0
#: Of the line, which the design's field of view reaches.
_MIDDLE_PX = (_LENGTH_PX - 1) / 2.0


@dataclass(frozen=True)
class SlitImages:
    """What two arrays see behind slits.

    Places are those of the slits from the mask's middle; the pitch is that of the pixels, in those
    of the design: a power of two from 1/4 to 4.
    """

    places_px: tuple[float, ...] = (0.0,)
    pitch: float = 1.0

    @property
    def pixels(self) -> int:
        """Number of pixels of an array."""
        return round(_LENGTH_PX / self.pitch)

    def geometry(self) -> SensorGeometry:
        """Return the sensor's drawing."""
        width = 2.0 * HALF_PX * DESIGN_PITCH_MM
        middle = (self.pixels - 1) / 2.0
        return SensorGeometry(
            focal_length_mm=_FOCAL_MM,
            pixel_pitch_mm=DESIGN_PITCH_MM * self.pitch,
            centre_px=(middle, middle),
            aperture_width_mm=width,
            half_fov_deg=math.degrees(math.atan(_MIDDLE_PX * DESIGN_PITCH_MM / _FOCAL_MM)),
            line_axes=("x", "y"),
            line_pixels=self.pixels,
            slits=tuple((place * DESIGN_PITCH_MM, 0.0, width) for place in self.places_px),
            mask_thickness_mm=0.0,
        )

    def light(self, moved_px: Floats) -> Floats:
        """Mean brightness (N, 2 W) of the pixels where the shadow has moved by (N, 2).

        What the images cover twice is twice as bright.
        """
        from scipy.special import ndtr  # noqa: PLC0415 - SciPy, where light is made

        def ramp(t: Floats) -> Floats:
            return np.asarray(t * ndtr(t) + np.exp(-(t**2) / 2.0) / math.sqrt(2.0 * math.pi))

        borders = (np.arange(self.pixels + 1) - self.pixels / 2.0) * self.pitch
        total = np.zeros((len(moved_px), 2, self.pixels))
        for place in self.places_px:
            past = (borders - (moved_px[:, :, None] + place)) / _EDGE_PX
            half = HALF_PX / _EDGE_PX
            light = _EDGE_PX * (ramp(past + half) - ramp(past - half))
            total += np.diff(light, axis=2) / self.pitch
        return total.reshape(len(moved_px), -1)

    def error_px(self, extractor: type[Extractor], profiles: Floats, moved_px: Floats) -> float:
        """Root mean square error of one coordinate, design px, over the profiles answered."""
        return rms(self.errors_px(extractor, profiles, moved_px))

    def errors_px(self, extractor: type[Extractor], profiles: Floats, moved_px: Floats) -> Floats:
        """Errors (N, 2) in design px; NaN where there is no answer."""
        found = extractor.for_sensor(self.geometry()).extract(profiles)
        return np.asarray((found - (self.pixels - 1) / 2.0) * self.pitch - moved_px)

    def bound_px(
        self, moved_px: Floats, brightness: float, variance: Callable[[Floats], Floats]
    ) -> float:
        """Cramer-Rao bound of `error_px` with brightness and dark level of each array unknown.

        `variance` is of the readings, from the expected ones, which are `brightness` in an image
        (a level that all pixels share is left to it).
        """
        first = np.arange(2 * self.pixels) < self.pixels
        return position_bound(
            lambda at: brightness * self.light(at),
            moved_px,
            lambda here: [
                part
                for side in (first, ~first)
                for part in (here * side, np.ones_like(here) * side)
            ],
            variance,
        )


def move(count: int, rng: np.random.Generator) -> Floats:
    """Draw displacements (N, 2) of the shadow."""
    return rng.uniform(-_REACH_PX, _REACH_PX, (count, 2))
