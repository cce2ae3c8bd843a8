"""Single discs (or Gaussian spots) in Gaussian noise of a stated share of their peak.

The discs are those of `benchmark.synthetic_features`: radius 8 px, rim of 0.7 px, 64 x 64 px,
anywhere within 16 px of the middle. The light's peak is one. `frames` are what is left when a
camera's known dark level is taken off, so that noise is of both signs and nothing but noise
disturbs a centroid; `digital` are the same as whole numbers above a pedestal, as a camera hands
them over.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Extractor, Floats, SensorGeometry
from benchmark.seeds import generator
from benchmark.synthetic_features.light import Profile, position_bound, spots
from benchmark.synthetic_features.spots import DiscSeries

RADIUS_PX: Final = 8.0
SIZE_PX: Final = 64
#: Noise from which methods are compared to where a disc is lost: shares of the peak.
NOISES: Final = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
#: A detector's frame as it is read out whole, for run times.
DETECTOR_PX: Final = 512

_RANGE_PX = 16.0
_FRAMES = 200
#: The bound varies with the sub-pixel phase only.
_BOUND_FRAMES = 24
_PEAK_DN, _PEDESTAL_DN = 2000.0, 4000.0


@dataclass(frozen=True)
class Spots:
    """Spots of peak one with their centres, and noise of deviation one.

    Attributes
    ----------
    light, noise
        (N, H, W).
    centres
        (N, 2) px.
    scale_px, profile
        Radius of a disc or sigma of a Gaussian.
    """

    light: Floats
    noise: Floats
    centres: Floats
    scale_px: float
    profile: Profile

    def frames(self, share: float) -> Floats:
        """Frames (N, H, W) with noise of a share of the peak, dark level taken off."""
        return self.light + share * self.noise

    def digital(self, share: float) -> NDArray[np.uint16]:
        """Return the same as digital numbers above a pedestal that holds the noise."""
        numbers = np.rint(_PEDESTAL_DN + _PEAK_DN * self.frames(share))
        return np.clip(numbers, 0, 2**16 - 1).astype(np.uint16)

    def bound_px(self, share: float) -> float:
        """Cramer-Rao bound of one coordinate; unknown are brightness and background, too."""
        size = self.light.shape[1]

        def mean(centres: Floats) -> Floats:
            return spots(size, centres[:, None], self.scale_px, self.profile)

        unit = position_bound(
            mean,
            self.centres[:_BOUND_FRAMES],
            lambda here: [here, np.ones_like(here)],
            np.ones_like,
        )
        return share * unit

    def error_px(self, found: Floats) -> float:
        """Root mean square error of one coordinate over the frames that are answered."""
        return error_px(found, self.centres)


def single(
    claim: str,
    number: int,
    *,
    profile: Profile = "flat",
    scale_px: float = RADIUS_PX,
    size_px: int = SIZE_PX,
    frames: int = _FRAMES,
) -> Spots:
    """Draw the spots of one trial of a claim."""
    rng = generator("claims", claim, number, "places")
    centres = (size_px - 1) / 2.0 + rng.uniform(-_RANGE_PX, _RANGE_PX, (frames, 2))
    noise = generator("claims", claim, number, "noise").standard_normal((frames, size_px, size_px))
    light = spots(size_px, centres[:, None], scale_px, profile)
    return Spots(light, noise, centres, scale_px, profile)


def ship(method: type[Extractor]) -> Extractor:
    """Return the method as it ships for a sensor whose round aperture casts these discs."""
    return method.for_sensor(disc_geometry())


def disc_geometry() -> SensorGeometry:
    """Return the design of that sensor."""
    series = DiscSeries()
    return series.geometry(series.settings()[0])


def errors_px(
    drawn: Spots, methods: Mapping[str, Extractor], noises: tuple[float, ...]
) -> dict[str, list[float]]:
    """Error of each method at each noise; NaN where fewer than half of the frames are answered."""
    errors: dict[str, list[float]] = {name: [] for name in methods}
    for share in noises:
        frames = drawn.frames(share)
        for name, method in methods.items():
            errors[name].append(drawn.error_px(method.extract(frames)))
    return errors


def error_px(found: Floats, truth: Floats) -> float:
    """Root mean square over both coordinates of answers (N, 2); NaN where half or more are none."""
    there = ~np.isnan(found).any(axis=1)
    if 2 * int(there.sum()) <= len(found):
        return math.nan
    return math.sqrt(float(np.mean((found[there] - truth[there]) ** 2)))
