"""Readings of lines of pixels handed on as signals, whole (Direct) or above a threshold (BCTM)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from algorithms.contract import (
    AboutExtractor,
    Extractor,
    FeatureKind,
    Floats,
    Observation,
)
from algorithms.documented import documented
from algorithms.extractors.profiles.slit_lines import dark_level
from algorithms.inputs import as_currents
from algorithms.parameters import require_positive, require_within

_NEEDS = ("line_axes", "line_pixels", "slits")


@documented
@dataclass(frozen=True)
class DirectProfile(Extractor):
    """Light of every pixel of every line: reading minus the dark level of the line.

    No position is computed; a model correlates the signal with the pattern of the slits.

    Notes
    -----
    Implements: fe:direct (Tsuno2019, Kondo2024): ``I = Q - Q_dark``, Q_dark the median of the
    line, which is dark while light covers less than half of it.

    Shapes: profiles (N, A L) of A lines of L pixels to signals (N, A L) in the same order, in the
    readings' unit.

    Failure: a NaN row where a reading is NaN or infinite, or where a line has no light above its
    median.

    Cost: a median and one operation per pixel.

    Examples
    --------
    >>> DirectProfile(line_axes=("x",), line_pixels=5).extract([[7, 7, 9, 8, 7]])
    array([[0., 0., 2., 1., 0.]])
    """

    about: ClassVar = AboutExtractor(
        name="direct-profile",
        taxonomy="Direct",
        studies=("Tsuno2019", "Kondo2024"),
        labels=("fe:direct",),
        origin="survey",
        needs=_NEEDS,
        observation=Observation.PROFILES,
        kind=FeatureKind.SIGNALS,
    )

    line_axes: tuple[Literal["x", "y"], ...]
    line_pixels: int

    def __post_init__(self) -> None:
        _require_lines(self.about.name, self.line_axes, self.line_pixels)

    @property
    def features(self) -> tuple[str, ...]:
        """One name a pixel, line after line."""
        return _pixel_names(self.line_axes, self.line_pixels)

    def extract(self, observations: ArrayLike) -> Floats:
        """Signals (N, A L) of profiles (N, A L); ValueError on wrong input."""
        return _light(observations, len(self.line_axes), self.line_pixels, self.about.name)


@documented
@dataclass(frozen=True)
class ThresholdProfile(Extractor):
    """Light of every pixel above a fraction of the line's maximum; zero elsewhere.

    This is the thresholded light without the computation of its centroid; the vernier model
    evaluates it mark by mark.

    Parameters
    ----------
    threshold : float
        The fraction mu, in (0, 1), of the line's brightest pixel above what is dark. The survey
        gives no value; 0.1 is ours: the few large pixels of a periodic mask's sensor share a slit's
        light, and what the dim one has of it counts.

    Notes
    -----
    Implements: alg:BCTM (fe:bctm, Chen2006) up to its first moment: ``I' = max(I - mu I_max, 0)``,
    I counted from the median of the line.

    Shapes: profiles (N, A L) of A lines of L pixels to signals (N, A L) in the same order, in the
    readings' unit.

    Failure: a NaN row where a reading is NaN or infinite, or where a line has no light above its
    median.

    Cost: a median and 3 operations per pixel.

    Examples
    --------
    >>> ThresholdProfile(("x",), line_pixels=5, threshold=0.5).extract([[7, 7, 11, 10, 7]])
    array([[0., 0., 2., 1., 0.]])
    """

    about: ClassVar = AboutExtractor(
        name="threshold-profile",
        taxonomy="BCTM",
        studies=("Chen2006",),
        labels=("fe:bctm", "alg:BCTM"),
        origin="survey",
        needs=_NEEDS,
        observation=Observation.PROFILES,
        kind=FeatureKind.SIGNALS,
    )

    line_axes: tuple[Literal["x", "y"], ...]
    line_pixels: int
    threshold: float = 0.1

    def __post_init__(self) -> None:
        _require_lines(self.about.name, self.line_axes, self.line_pixels)
        require_within(self.about.name, "(0, 1)", threshold=self.threshold)

    @property
    def features(self) -> tuple[str, ...]:
        """One name a pixel, line after line."""
        return _pixel_names(self.line_axes, self.line_pixels)

    def extract(self, observations: ArrayLike) -> Floats:
        """Signals (N, A L) of profiles (N, A L); ValueError on wrong input."""
        count, pixels = len(self.line_axes), self.line_pixels
        light = _light(observations, count, pixels, self.about.name).reshape(-1, count, pixels)
        above = light - self.threshold * light.max(axis=2, keepdims=True)
        return np.asarray(np.maximum(above, 0.0).reshape(len(light), -1))


def _require_lines(by: str, axes: tuple[str, ...], pixels: int) -> None:
    if not axes or any(axis not in {"x", "y"} for axis in axes):
        raise ValueError(f"{by}: line_axes must be 'x' or 'y', one a line; got {axes!r}")
    require_positive(by, line_pixels=pixels)


def _pixel_names(axes: tuple[str, ...], pixels: int) -> tuple[str, ...]:
    return tuple(f"line_{n}_{axis}_{k}" for n, axis in enumerate(axes) for k in range(pixels))


def _light(observations: ArrayLike, count: int, pixels: int, by: str) -> Floats:
    """Light (N, count pixels) above the medians of the lines; NaN rows where there is none."""
    profiles = as_currents(observations, count * pixels, by)
    lost = ~np.isfinite(profiles).all(axis=1)
    profiles[lost] = 0.0
    lines = profiles.reshape(-1, pixels)
    lines = lines - dark_level(lines)[:, None]
    unlit = ~(lines.max(axis=1) > 0).reshape(-1, count).all(axis=1)
    signals = lines.reshape(len(profiles), -1)
    signals[lost | unlit] = np.nan
    return signals
