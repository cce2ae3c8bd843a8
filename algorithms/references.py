"""Correct readings by a unit's own dark and flat readings, before anything is extracted.

What a bench or a flight takes beside its poses: readings without light, readings in uniform light,
and from both the pixels that are of no use. One stage serves every method.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.contract import Floats
from algorithms.kernels.reference_correction import correct, replace_bad

#: A pixel is bad whose response to the flat's light is less or more than these times the median...
LEAST_RESPONSE, LARGEST_RESPONSE = 0.5, 2.0
#: ... or whose dark signal is above the median by more than this share of the flat's light.
HOT_SHARE = 0.1
#: Dimensions of a detector whose elements have neighbours that can stand in for a bad one.
_PROFILE, _FRAME = 1, 2


@dataclass(frozen=True)
class ReferenceCorrection:
    """Dark subtraction, flat division and replacement of bad pixels.

    ``corrected = (reading - dark) / gain``, the relative gain being ``(flat - dark)`` over its mean
    over good elements. Saturated readings stay one plateau: they become ``full_scale`` less the
    median dark reading. A bad pixel gets the mean of its good neighbours (8 of a frame, 4 of a
    profile); without any it is 0, the level of darkness.

    Parameters
    ----------
    dark, flat : ndarray
        Mean readings of every element of the detector, (rows, columns), (W,) or (K,), in the unit
        of the observations.
    full_scale : float, optional
        Largest reading of the converter; None where readings do not saturate.
    pixels : bool
        Whether the elements are pixels, whose neighbours can stand in for a bad one.

    Raises
    ------
    ValueError
        If dark and flat differ in shape, are not finite, or the flat is not brighter.

    Examples
    --------
    >>> correction = ReferenceCorrection(np.array([1.0, 2.0]), np.array([11.0, 32.0]))
    >>> correction.correct(np.array([[6, 17]]))
    array([[10., 10.]])
    """

    dark: Floats
    flat: Floats
    full_scale: float | None = None
    pixels: bool = False
    gain: Floats = field(init=False, repr=False)
    bad: NDArray[np.bool_] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        dark = np.ascontiguousarray(self.dark, np.float64)
        flat = np.asarray(self.flat, np.float64)
        if dark.shape != flat.shape or dark.ndim not in {_PROFILE, _FRAME}:
            raise ValueError(
                "dark and flat must be of one detector, of one or two dimensions; got shapes "
                f"{dark.shape} and {flat.shape}"
            )
        if not (np.isfinite(dark).all() and np.isfinite(flat).all()):
            raise ValueError("dark and flat must be finite")
        light = flat - dark
        middle = float(np.median(light))
        if not middle > 0:
            raise ValueError(f"the flat must be brighter than the dark; got {middle:g} more")
        bad = np.zeros(dark.shape, dtype=np.bool_)
        if self.pixels:
            bad |= (light < LEAST_RESPONSE * middle) | (light > LARGEST_RESPONSE * middle)
            bad |= dark - np.median(dark) > HOT_SHARE * middle
        gain = light / float(light[~bad].mean())
        object.__setattr__(self, "dark", dark)
        object.__setattr__(self, "bad", bad)
        object.__setattr__(self, "gain", np.where(bad, 1.0, gain))

    def correct(self, observations: ArrayLike, origin_px: ArrayLike | None = None) -> Floats:
        """Return corrected observations (N, ...), float64.

        Parameters
        ----------
        observations : array_like
            (N, H, W) whole frames or windows of them, (N, W) profiles, or (N, K) currents.
        origin_px : array_like, shape (N, 2), optional
            Detector coordinates (x, y) of the first pixel of each window.

        Raises
        ------
        ValueError
            If the observations are not of this detector, or a window reaches beyond it.
        """
        given = np.asarray(observations)
        shape = self.dark.shape
        if given.ndim != len(shape) + 1 or (origin_px is None and given.shape[1:] != shape):
            raise ValueError(f"observations must have shape (N, *{shape}); got {given.shape}")
        origin = np.zeros((len(given), 2), dtype=np.int64)
        if origin_px is not None:
            origin = self._within(given.shape, np.asarray(origin_px, dtype=np.int64))
        # profiles and currents are frames of one row
        rows = (1, *shape)[-2:]
        windows = given.reshape(len(given), *((1, *given.shape[1:])[-2:]))
        found = np.empty(given.shape, dtype=np.float64)
        light = found.reshape(windows.shape)
        scale = np.inf if self.full_scale is None else self.full_scale
        dark, gain = self.dark.reshape(rows), self.gain.reshape(rows)
        correct(windows, origin, dark, gain, scale, scale - self._level, light)
        if len(self._places):
            reach = (1, 1) if len(shape) == _FRAME else (0, 2)
            replace_bad(light, origin, self.bad.reshape(rows), self._places, *reach)
        return found

    @cached_property
    def _level(self) -> float:
        """The median dark reading."""
        return float(np.median(self.dark))

    @cached_property
    def _places(self) -> NDArray[np.int64]:
        """Rows and columns (B, 2) of the bad elements; profiles and currents are one row."""
        return np.argwhere(self.bad.reshape((1, *self.dark.shape)[-2:]))

    def _within(self, shape: tuple[int, ...], origin: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the places (N, 2) of windows; ValueError where one is not on the detector."""
        if len(shape) != _FRAME + 1:
            raise ValueError("only frames have windows; leave origin_px=None")
        count, height, width = shape
        rows, columns = self.dark.shape
        if origin.shape != (count, 2):
            raise ValueError(f"origin_px must have shape ({count}, 2); got {origin.shape}")
        last = origin + np.array([width, height])
        if (origin < 0).any() or (last > np.array([columns, rows])).any():
            raise ValueError(f"a window of {width} by {height} reaches beyond {columns} by {rows}")
        return origin
