"""Correct readings by a unit's own dark and flat readings, before anything is extracted.

What a bench or a flight takes beside its poses: readings without light, readings in uniform light,
and from both the pixels that are of no use. One stage serves every method.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.contract import Floats

#: A pixel is bad whose response to the flat's light is less or more than these times the median...
LEAST_RESPONSE, LARGEST_RESPONSE = 0.5, 2.0
#: ... or whose dark signal is above the median by more than this share of the flat's light.
HOT_SHARE = 0.1
#: Dimensions of a detector whose elements have neighbours that can stand in for a bad one.
_PROFILE, _FRAME = 1, 2
#: A profile of fewer elements is a handful of photodiodes: none can stand in for another.
_FEWEST_PIXELS = 32


@dataclass(frozen=True)
class ReferenceCorrection:
    """Dark subtraction, flat division and replacement of bad pixels.

    ``corrected = (reading - dark) / gain``, the relative gain being ``(flat - dark)`` over its mean
    over good elements. Saturated readings stay one plateau: they become ``full_scale`` less the
    median dark reading. A bad pixel gets the mean of its good neighbours (8 of a frame, 4 of a
    profile); one without any stays NaN-free at 0, the level of darkness.

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
    >>> correction.corrected(np.array([[6, 17]]))
    array([[10., 10.]])
    """

    dark: Floats
    flat: Floats
    full_scale: float | None = None
    pixels: bool = False
    gain: Floats = field(init=False, repr=False)
    bad: NDArray[np.bool_] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        dark, flat = np.asarray(self.dark, np.float64), np.asarray(self.flat, np.float64)
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
        object.__setattr__(self, "bad", bad)
        object.__setattr__(self, "gain", np.where(bad, 1.0, gain))

    def corrected(self, observations: ArrayLike, origin_px: ArrayLike | None = None) -> Floats:
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
        if origin_px is None:
            return self._of(given, self.dark, self.gain, self.bad)
        origin = np.asarray(origin_px, dtype=np.int64)
        places = self._windows(given.shape, origin)
        return self._of(given, self.dark[places], self.gain[places], self.bad[places])

    def _windows(
        self, shape: tuple[int, ...], origin: NDArray[np.int64]
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the rows (N, H, 1) and columns (N, 1, W) of the detector in each window."""
        count, height, width = shape
        rows, columns = self.dark.shape
        if origin.shape != (count, 2):
            raise ValueError(f"origin_px must have shape ({count}, 2); got {origin.shape}")
        last = origin + np.array([width, height])
        if (origin < 0).any() or (last > (columns, rows)).any():
            raise ValueError(f"a window of {width} by {height} reaches beyond {columns} by {rows}")
        down = origin[:, 1, None, None] + np.arange(height)[None, :, None]
        across = origin[:, 0, None, None] + np.arange(width)[None, None, :]
        return down, across

    def _of(
        self, given: NDArray[Any], dark: Floats, gain: Floats, bad: NDArray[np.bool_]
    ) -> Floats:
        found = (given - dark) / gain
        if self.full_scale is not None:
            found[given >= self.full_scale] = self.full_scale - float(np.median(self.dark))
        if bad.any():
            mask = np.broadcast_to(bad, found.shape)
            samples = np.flatnonzero(mask.reshape(len(found), -1).any(axis=1))
            found[samples] = _replaced(found[samples], mask[samples])
        return found


def _replaced(values: Floats, bad: NDArray[np.bool_]) -> Floats:
    """Replace bad elements by the mean of the good ones beside them; 0 where there are none."""
    reach = (2,) if values.ndim == _FRAME else (1, 1)
    padding = [(0, 0), *((size, size) for size in reach)]
    light = np.pad(np.where(bad, 0.0, values), padding)
    good = np.pad(~bad, padding)
    total, count = np.zeros(values.shape), np.zeros(values.shape)
    for shift in np.ndindex(*(2 * size + 1 for size in reach)):
        place = (
            slice(None),
            *(slice(s, s + n) for s, n in zip(shift, values.shape[1:], strict=True)),
        )
        total += light[place]
        count += good[place]
    return np.where(bad, total / np.maximum(count, 1), values)
