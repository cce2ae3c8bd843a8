"""Reference events: a time-to-first-spike array behind an L of two slits."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats, Observation, SensorGeometry
from benchmark.synthetic_features.light import bars, position_bound
from benchmark.synthetic_features.series import (
    Sample,
    SeriesPoint,
    locations,
    noise,
    number,
    phases,
)

_PIXELS = 64
_PITCH_MM, _FOCAL_MM = 0.05, 1.0
#: Time of a fully lit pixel, and when the array is reset.
_LIT_US, _RESET_US = 100.0, 400.0
_STRAY = 0.002
_ARM_PX = 60.0
_BOUND_SAMPLES = 12


@dataclass(frozen=True)
class EventSeries:
    """Events (N, M, 3) of an L whose slits' centre lines cross at the truth."""

    name: str = "event-l-slit"
    observation: Observation = Observation.EVENTS
    unit: str = "px"
    description: str = (
        "two bars of 3 px with edges of 0.7 px in the form of an L on 64 x 64 integrate-and-fire "
        "pixels, read for four times as long as a fully lit one takes; the SNR is the inverse of "
        "the relative jitter of a pixel's time"
    )
    frames: int = 100

    def settings(self) -> tuple[SeriesPoint, ...]:
        """Return every point."""
        base = SeriesPoint("reference", self.name, None, self.frames, size_px=1.5, range_px=6.0)
        return (
            base,
            *noise(base),
            *(number("size", half, base, size_px=half) for half in (1.0, 1.5, 2.0, 3.0)),
            *phases(base),
            *locations(base, anywhere_px=14.0),
        )

    def geometry(self, setting: SeriesPoint) -> SensorGeometry:
        """Return the design: the slits' centre lines cross over the middle of the array."""
        middle = (_PIXELS - 1) / 2.0
        return SensorGeometry(
            focal_length_mm=_FOCAL_MM,
            pixel_pitch_mm=_PITCH_MM,
            centre_px=(middle, middle),
            half_fov_deg=math.degrees(math.atan(16.0 * _PITCH_MM / _FOCAL_MM)),
            line_axes=("x", "y"),
            slits=((0.0, 0.0, 2.0 * setting.size_px * _PITCH_MM),),
        )

    def draw(self, setting: SeriesPoint) -> Sample:
        """Return events, where the lines cross (N, 2) and its bound."""
        half = setting.size_px
        places = setting.places(self.name) + (_PIXELS - 1) / 2.0

        def mean(at: Floats) -> Floats:
            # the arm along y holds the corner, the other one begins at its edge
            upright = _box(at + np.array([0.0, _ARM_PX / 2.0 - half]), half, _ARM_PX / 2.0)
            flat = _box(at + np.array([half + _ARM_PX / 2.0, 0.0]), _ARM_PX / 2.0, half)
            return np.asarray(_LIT_US / (upright + flat + _STRAY))

        bound = position_bound(
            mean,
            places[:_BOUND_SAMPLES],
            # by the logarithm of all light, and by stray light in units of a lit pixel
            lambda here: [here, here**2 / _LIT_US],
            lambda here: _variance(here, setting.snr),
        )
        times = mean(places)
        times *= 1.0 + setting.noise(self.name).standard_normal(times.shape) / setting.snr
        return Sample(_events(times.reshape(setting.frames, -1)), places, bound)

    def estimates(self, features: Floats) -> Floats:
        """Return the positions themselves."""
        return features


def _box(centres: Floats, half_x: float, half_y: float) -> Floats:
    """Light (N, H, W) of blurred rectangles at (N, 2)."""
    across = bars(_PIXELS, centres[:, :1], half_x, "flat")
    along = bars(_PIXELS, centres[:, 1:], half_y, "flat")
    return np.asarray(along[:, :, None] * across[:, None, :])


def _variance(times: Floats, snr: float) -> Floats:
    """Squared microseconds that the time of a pixel is worth when the array is reset.

    That a pixel has not fired when the array is reset tells something too: a Gaussian time that
    is only known below ``z`` deviations above its mean has the share ``F - z f + f^2 / (1 - F)``
    of its information on the mean, f and F the normal density and distribution.
    """
    from scipy.special import ndtr  # noqa: PLC0415 - SciPy, where observations are made

    deviation = times / snr
    z = np.clip((_RESET_US - times) / deviation, -30.0, 8.0)
    density = np.exp(-(z**2) / 2.0) / math.sqrt(2.0 * math.pi)
    share = ndtr(z) - z * density + density**2 / ndtr(-z)
    return np.asarray(deviation**2 / np.maximum(share, 1e-12))


def _events(times: Floats) -> Floats:
    """(N, M, 3) events by time of pixels (N, H W), rows of NaN after the last before the reset."""
    times = np.maximum(times, 1e-3)
    order = np.argsort(times, axis=1, kind="stable")
    stamps = np.take_along_axis(times, order, axis=1)
    most = int((stamps <= _RESET_US).sum(axis=1).max())
    order, stamps = order[:, :most], stamps[:, :most]
    events = np.stack([order % _PIXELS, order // _PIXELS, stamps], axis=2).astype(np.float64)
    events[stamps > _RESET_US] = np.nan
    return events


EVENTS = EventSeries()
