"""Beyond the survey: the lines of an L of two slits, each across itself under a moving window."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.contract import (
    AboutExtractor,
    Extractor,
    FeatureKind,
    Floats,
    Observation,
    SensorGeometry,
    UnsuitableDesignError,
)
from algorithms.documented import documented
from algorithms.extractors.frames.single_light import frames_to_measure
from algorithms.inputs import as_frames
from algorithms.measurement import Measurement, QualityFlag
from algorithms.parameters import require_positive

#: Pixels over which the ends of a line fade out, and how far from the other line's edge it ends.
_FADE_PX, _APART_PX = 2.0, 4.0
#: A line's pixels have at least this share of its light; least pixels of a line.
_LIT, _SHORTEST = 0.5, 6
#: Light of a line, over the noise of its mean, that is one.
_SIGNAL = 8.0
#: Steps for a middle, last step and largest one, px.
_STEPS, _SETTLED, _LARGEST = 40, 1e-9, 1.0


@documented
@dataclass(frozen=True)
class LineWindows(Extractor):
    """Middle of each line of an L where odd weights on its two edges balance.

    The line along y gives x and the line along x gives y. Weights of opposite sign lie on the two
    edges of a line and move with it, so that light between them and far from them adds no noise.

    Parameters
    ----------
    width_px : float
        Width of a line, px, positive.
    softness_px : float
        Standard deviation of the weights across each edge, px, positive. A drawing tells how far
        light spreads at an edge.
    offset_px : float
        Where a line falls from the detector's middle when the Sun is on the boresight, px;
        subtracted from both coordinates.

    Notes
    -----
    Implements: nothing printed in the survey. P is the light less the background summed along a
    line, away from its ends and from the other line; its middle c solves ``sum(k(x - c) P(x)) =
    0`` by Newton's method, ``k(u) = exp(-(u - w/2)^2 / 2 s^2) - exp(-(u + w/2)^2 / 2 s^2)``. k is
    odd: c has no bias for any line that is even about its middle, whatever its edges. A line is
    looked for as the brightest columns (rows) as wide as it is, and ends where its light has
    fallen by half.

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px)`` (N, 2), pixel centres at integers, less
    the offset.

    Failure: a NaN row for a frame that is dark, without contrast or holds a NaN or infinity, and
    where a line is shorter than 6 px, is not 8 times its noise, or does not settle.

    Cost: 6 operations per pixel, and 20 per column and row and step, 4 to 8 of them.

    Examples
    --------
    >>> y, x = np.mgrid[:60, :60]
    >>> def line(u): return 1.0 / (1.0 + np.exp(2.0 * (np.abs(u) - 4.0)))
    >>> upright = line(x - 15.3) * ((y > 24) & (y < 55))
    >>> flat = line(y - 12.8) * ((x > 26) & (x < 55))
    >>> LineWindows(8.0).extract(900.0 * (upright + flat)[None]).round(2)
    array([[15.3, 12.8]])
    """

    about: ClassVar = AboutExtractor(
        name="line-windows",
        taxonomy="None",
        origin="ours",
        needs=("pixel_pitch_mm", "focal_length_mm", "slits", "line_axes"),
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    width_px: float
    softness_px: float = 1.5
    offset_px: float = 0.0

    def __post_init__(self) -> None:
        require_positive(self.about.name, width_px=self.width_px, softness_px=self.softness_px)
        if not np.isfinite(self.offset_px):
            raise ValueError(f"{self.about.name}: offset_px must be finite; got {self.offset_px!r}")

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the method for an L of one slit along each axis.

        UnsuitableDesignError for other designs.
        """
        geometry.require(*cls.about.needs, by=cls.about.name)
        slits, axes = geometry.slits or (), geometry.line_axes or ()
        if len(slits) != 1 or sorted(axes) != ["x", "y"] or slits[0][1] != 0.0:
            raise UnsuitableDesignError(
                f"{cls.about.name} reads an L of one slit along each axis; the sensor's design has "
                f"slits {slits} for lines along {axes}"
            )
        pitch, height = geometry.pixel_pitch_mm or 1.0, geometry.focal_length_mm or 0.0
        position, _, width = slits[0]
        # light of 600 nm spreads over the root of wavelength times distance at an edge
        soft = max(1.2 * float(np.sqrt(6e-4 * height)) / pitch, 0.8)
        return cls(width / pitch, softness_px=round(soft, 6), offset_px=position / pitch)

    def extract(self, observations: ArrayLike) -> Floats:
        """Middles (N, 2) in frames (N, H, W); ValueError on wrong input."""
        return self._found(as_frames(observations))[0]

    def measure(self, observations: ArrayLike, bad: ArrayLike | None = None) -> Measurement:
        """Middles, covariances and flags of frames (N, H, W) or of one.

        The variance of a middle is that of the sum over a line's rows (columns), as neighbours
        among them differ: it needs no model of noise. Both axes are of different pixels, and
        their covariance is zero. Bad pixels are replaced by their neighbours.
        """
        found, variances = self._found(frames_to_measure(observations, bad, self.about.name))
        covariance = np.zeros((len(found), 2, 2))
        covariance[:, [0, 1], [0, 1]] = variances
        covariance[np.isnan(found[:, 0])] = np.nan
        missing = np.isnan(found[:, 0])
        return Measurement(found, covariance, np.where(missing, int(QualityFlag.NO_SPOT), 0))

    def _found(self, frames: NDArray[Any]) -> tuple[Floats, Floats]:
        found = np.full((2, len(frames), 2), np.nan)
        for k, frame in enumerate(frames):
            light = frame.astype(np.float64)
            if not np.isfinite(light).all() or light.max() <= light.min():
                continue
            light -= np.median(light)
            middles = self._starts(light)
            lines = [
                self._across(light, middles[0], middles[1]),
                self._across(light.T, middles[1], middles[0]),
            ]
            rows = np.array(lines).T
            if np.isfinite(rows).all():
                found[:, k] = rows
        return found[0] - self.offset_px, found[1]

    def _starts(self, light: Floats) -> tuple[int, int]:
        """Brightest column and row, as wide as a line."""
        wide = np.ones(max(round(self.width_px), 1))
        columns = np.convolve(light.sum(axis=0), wide, "same")
        rows = np.convolve(light.sum(axis=1), wide, "same")
        return int(np.argmax(columns)), int(np.argmax(rows))

    def _across(self, light: Floats, start: int, other: int) -> tuple[float, float]:
        """Middle along the columns of the line along the rows, and its variance; NaN for none."""
        weights = self._along(light, start, other)
        if weights is None:
            return np.nan, np.nan
        at, half, middle = np.arange(light.shape[1]), self.width_px / 2.0, float(start)
        profile, soft2 = weights @ light, self.softness_px**2
        for _ in range(_STEPS):
            near, far = at - middle - half, at - middle + half
            right, left = np.exp(-0.5 * near**2 / soft2), np.exp(-0.5 * far**2 / soft2)
            slope = ((near * right - far * left) * profile).sum() / soft2
            if slope == 0.0:
                return np.nan, np.nan
            step = -float(((right - left) * profile).sum() / slope)
            middle += min(max(step, -_LARGEST), _LARGEST)
            if abs(step) < _SETTLED:
                break
        if not (abs(step) < 1e-6 and abs(middle - start) < self.width_px and slope < 0.0):
            return np.nan, np.nan
        each = light @ (right - left)  # of every row of the line, as many measurements
        # neighbours' differences: a line may be turned, and bend at its ends
        differ = 0.5 * np.diff(each) ** 2 * weights[1:] * weights[:-1]
        return middle, float(differ.sum() / slope**2)

    def _along(self, light: Floats, start: int, other: int) -> Floats | None:
        """Weights (H,) of the rows of a line around the column `start`; None for no line.

        The other line lies on the row `other`.
        """
        reach = max(int(self.width_px / 4.0), 0)
        band = light[:, max(start - reach, 0) : start + reach + 1].mean(axis=1)
        at = np.arange(len(band))
        free = np.abs(at - other) > self.width_px / 2.0 + _APART_PX
        if free.sum() < _SHORTEST:
            return None
        bright = np.sort(band[free])[-_SHORTEST:].mean()
        lit = free & (band > _LIT * bright)
        ends = np.flatnonzero(np.diff(np.concatenate([[0], lit.astype(np.int64), [0]])))
        first, last = max(ends.reshape(-1, 2).tolist(), key=lambda run: run[1] - run[0])
        if last - first < _SHORTEST:
            return None
        dark = light[:, np.abs(np.arange(light.shape[1]) - start) > 2.0 * self.width_px]
        noise = dark[free].std() / np.sqrt(_SHORTEST) if dark.size else 0.0
        if not bright > _SIGNAL * noise:
            return None
        share = np.clip(np.minimum(at - first, last - 1 - at) / _FADE_PX, 0.0, 1.0)
        return np.asarray(0.5 - 0.5 * np.cos(np.pi * share))
