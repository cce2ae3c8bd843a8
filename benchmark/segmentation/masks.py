"""Masks of frames: by thresholds, by a template and by a network; and frames under a mask."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.learned.network import Network
from benchmark.segmentation.unet import block_of, chances

Pixels = NDArray[np.bool_]

#: Chance from which a pixel is taken for the Sun's, and mean chance of a mask that is sure.
_LIKELY, _SURE = 0.5, 0.8
#: Averaged pixels of a part that counts; areas accepted over those of the calibration.
_PART_PX, _SMALLER, _LARGER = 4, 0.6, 1.2
#: Deviations of dark pixels that light exceeds, as of the extractor bctm.
_DEVIATIONS = 6.0
#: Pixels that a mask is widened by before its frame is read; from how far beside it background is
#: taken, and weight of such pixels below which it is not known.
_MARGIN_PX, _AROUND_PX, _LEAST_WEIGHT = 3, 5.0, 1e-6
#: Deviations from the background beyond which a pixel is of another light.
_DEVIANT = 3.0


class Masks(NamedTuple):
    """Pixels (N, H, W), and the frames (N,) that are refused."""

    pixels: Pixels
    refused: NDArray[np.bool_]


def above_share(frames: Floats, share: float) -> Pixels:
    """Pixels above a share of the peak, counted from the median."""
    base = np.median(frames, axis=(1, 2), keepdims=True)
    return np.asarray(frames > base + share * (frames.max(axis=(1, 2), keepdims=True) - base))


def above_dark(frames: Floats) -> Masks:
    """Pixels above what dark ones stay below; refused without any."""
    from algorithms.kernels import moments  # noqa: PLC0415 - Numba, at first use

    found = frames > moments.dark_levels(frames, _DEVIATIONS)[:, None, None]
    return Masks(found, np.asarray(~found.any(axis=(1, 2))))


def discs(frames: Floats, centres: Floats, radius_px: float) -> Pixels:
    """Pixels of round templates at centres (N, 2); none where there is no centre."""
    y, x = np.mgrid[: frames.shape[1], : frames.shape[2]]
    far = np.hypot(x - centres[:, 0, None, None], y - centres[:, 1, None, None])
    return np.asarray(far <= radius_px)


@dataclass(frozen=True)
class NetworkMasks:
    """Masks by a network, refused where they are unlike those of a calibration.

    Attributes
    ----------
    network
        As trained.
    areas, parts
        Least and largest number of pixels and of parts that are accepted.
    """

    network: Network
    areas: tuple[float, float] = (0.0, math.inf)
    parts: tuple[float, float] = (0.0, math.inf)

    def calibrated(self, frames: Floats) -> Self:
        """Return one that accepts what is like the masks of clean frames."""
        found, _ = self._marked(frames)
        areas, parts = found.sum(axis=(1, 2)), _parts(found)
        return type(self)(
            self.network,
            (_SMALLER * float(areas.min()), _LARGER * float(areas.max())),
            (float(parts.min()), float(parts.max())),
        )

    def __call__(self, frames: Floats) -> Masks:
        """Mark frames (N, H, W)."""
        found, sure = self._marked(frames)
        areas, parts = found.sum(axis=(1, 2)), _parts(found)
        refused = sure < _SURE
        for number, (least, largest) in ((areas, self.areas), (parts, self.parts)):
            refused |= (number < max(least, 1.0)) | (number > largest)
        return Masks(found, refused)

    def _marked(self, frames: Floats) -> tuple[Pixels, Floats]:
        likely = chances(self.network, frames)
        found = likely > _LIKELY
        area = np.maximum(found.sum(axis=(1, 2)), 1)
        return found, np.where(found, likely, 0.0).sum(axis=(1, 2)) / area


def _parts(masks: Pixels) -> NDArray[np.int64]:
    """(N,) touching sets of pixels, but for tiny ones."""
    from scipy.ndimage import label  # noqa: PLC0415 - SciPy on demand

    block, found = block_of(masks), []
    for mask in masks[:, ::block, ::block]:
        labels, _ = label(mask)
        found.append(int((np.bincount(labels.ravel())[1:] >= _PART_PX).sum()))
    return np.array(found, dtype=np.int64)


def _widened(masks: Pixels, by: int) -> Pixels:
    from scipy.ndimage import maximum_filter  # noqa: PLC0415 - SciPy on demand

    side = 2 * by + 1
    return np.asarray(maximum_filter(masks.view(np.uint8), (1, side, side)) > 0)


class Marked(NamedTuple):
    """Frames under masks: the pixels, the frames (N,) that are refused, and what is left.

    Attributes
    ----------
    near, light
        Widened masks, and the light above the background about them, both (N, H, W).
    """

    pixels: Pixels
    refused: NDArray[np.bool_]
    near: Pixels
    light: Floats

    @classmethod
    def of(cls, frames: Floats, masks: Masks) -> Self:
        """Take off the background: the mean of pixels beside widened masks, Gaussian weights.

        Of what stands out from a first mean, the second knows nothing.
        """
        near = _widened(masks.pixels, _MARGIN_PX)
        first = frames - _smooth(frames, ~near)
        light = frames - _smooth(frames, ~near & ~_outlying(first, near))
        return cls(*masks, near, light)

    @property
    def cut_out(self) -> Floats:
        """Light under the masks; else zero."""
        return np.where(self.near, self.light, 0.0)

    @property
    def without_others(self) -> Floats:
        """All light but what stands out beside the masks; noise is kept."""
        return np.where(~self.near & _outlying(self.light, self.near), 0.0, self.light)


def _outlying(light: Floats, near: Pixels) -> Pixels:
    """Pixels further from zero than three deviations of those that are not `near`."""
    found = np.zeros_like(near)
    for n in np.flatnonzero(~near.all(axis=(1, 2))):
        spread = 1.4826 * float(np.median(np.abs(light[n, ~near[n]])))
        found[n] = np.abs(light[n]) > _DEVIANT * spread
    return found


def _smooth(frames: Floats, known: Pixels) -> Floats:
    """Mean of known pixels about each pixel, Gaussian weights; the frame's where none is near."""
    from scipy.ndimage import gaussian_filter  # noqa: PLC0415 - SciPy on demand

    reach = (0.0, _AROUND_PX, _AROUND_PX)
    weight = gaussian_filter(known.astype(np.float64), reach, mode="constant")
    light = gaussian_filter(np.where(known, frames, 0.0), reach, mode="constant")
    enough = weight > _LEAST_WEIGHT
    mean = light / np.where(enough, weight, 1.0)
    return np.where(enough, mean, frames.mean(axis=(1, 2), keepdims=True))
