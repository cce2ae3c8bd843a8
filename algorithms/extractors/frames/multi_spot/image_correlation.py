"""Correlation of many spots with templates, summed over the spots, with prediction (FEIC)."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY, dataclass
from functools import lru_cache
from typing import Any, ClassVar, Literal, Self

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
from algorithms.extractors.frames.multi_spot.aperture_design import PATTERN_NEEDS, design_pattern
from algorithms.extractors.frames.multi_spot.aperture_pattern import (
    SHARE,
    Levels,
    Pattern,
    lattice,
    margin_px,
    nearest_distance,
)
from algorithms.extractors.frames.multi_spot.mask_spots import MaskSpots
from algorithms.inputs import Frames, as_frames
from algorithms.parameters import require_choice, require_within

Shape = Literal["round", "square"]

#: Points an axis of a pixel at which a template's coverage is sampled.
_SAMPLES = 16
#: Longest correlation to each side, px: cost grows with its square, accuracy no more.
_LONGEST = 8.0


@documented
@dataclass(frozen=True)
class ImageCorrelation(MaskSpots, Extractor):
    """Our variant of FEIC: centre of the summed correlations of all spots with their templates.

    A window is placed at each predicted spot. Each window is correlated with the expected image of
    its aperture. All spots move together, so the sum of the correlations has one peak that uses
    the light of all spots. A missing spot contributes almost nothing.

    Parameters
    ----------
    shape : {"round", "square"}
        Of the apertures; a square's sides lie along the pixels.
    correlations : int
        N_c, even and at least 2: correlations are taken up to ``N_c / 2`` px to each side.
    blur_px : float
        Width of the Sun's image behind a hole, px, not negative: the template is as much
        larger than the aperture, and its rim as wide.
    presence : float
        Light of a spot in its window, over the mean of all, below which it is missing; in (0, 1).

    Notes
    -----
    Implements: alg:FEIC (fe:feic, Xing2008): ``x_s = int(Dx + x_s + 0.5)``, ``C_s(m, n) = sum_ij
    P_s(m + i, n + j) T_s(i, j)``, ``x_c = Dx + sum C_s (m - N_c / 2) / sum C_s``. The survey
    prints (m - 4); corrected because the middle of 0..N_c is N_c / 2. The survey adds to Dx what
    windows at whole pixels give; corrected because their fractions do not cancel: the windows' own
    mean distance from the apertures, weighted by the light in them, takes its place. The survey
    takes the centroid of all of C; corrected because of a hill cut off by the matrix it moves less
    than the hill: the lowest value is subtracted, and the gain is what leaving out the first or
    the last column, known to be a pixel, changes. Windows are moved until they stand within half a
    pixel of the result. The survey prints m with x, over rows; corrected because x runs along
    columns here.

    The study takes its templates from an earlier frame; here they are computed from the design.
    The prediction is the previous frame's result in `track`; in `extract`, which does not depend
    on order, it is the pattern found in the same frame as MCAM does.

    Failure: a NaN row where the pattern is not found, as for MCAM, where the windows do not come
    to rest, and where fewer than 0.3 of the spots that should be whole in the frame are there.

    Cost: as MCAM, and ``2 (N_c + 1)^2`` operations per pixel of the template and spot.

    Examples
    --------
    >>> from algorithms.examples import mask_frame
    >>> frames, holes = mask_frame(23.4, 18.8)
    >>> ImageCorrelation(holes, shape="square", correlations=4).extract(frames).round(1)
    array([[23.4, 18.8]])
    """

    about: ClassVar = AboutExtractor(
        name="feic",
        taxonomy="FEIC",
        studies=("Xing2008",),
        labels=("fe:feic", "alg:FEIC"),
        origin="survey",
        version=3,
        needs=PATTERN_NEEDS,
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    _: KW_ONLY
    shape: Shape = "round"
    correlations: int = 8
    presence: float = 0.3

    def __post_init__(self) -> None:
        super().__post_init__()
        require_choice(self.about.name, Shape, shape=self.shape)
        if self.correlations < 2 or self.correlations % 2:
            raise ValueError(
                f"{self.about.name}: correlations must be even and at least 2; got "
                f"{self.correlations!r}"
            )
        require_within(self.about.name, "(0, 1)", presence=self.presence)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the method with this sensor's mask.

        UnsuitableDesignError where its light is no spots. Correlations reach half a spot's width
        to each side, 8 px at most, less where the window would hold light of a neighbour.
        """
        design = design_pattern(geometry, cls.about.name)
        shape = geometry.aperture_shape
        if shape is None:  # said above; for the type checker
            raise UnsuitableDesignError(
                f"{cls.about.name} needs the sensor geometry's aperture_shape"
            )
        apertures = np.array(design["apertures_px"])
        width = float(apertures[:, 2].max()) + design["blur_px"]
        room = nearest_distance(apertures) - width - 1.0
        reach = max(int(min(math.ceil(width / 2.0), room, _LONGEST)), 1)
        return cls(shape=shape, correlations=2 * reach, **design)

    def extract(self, observations: ArrayLike) -> Floats:
        """Positions (N, 2) in frames (N, H, W); ValueError on wrong input."""
        return self._read(as_frames(observations))[0][0]

    def track(self, observations: ArrayLike) -> Floats:
        """Positions (N, 2) in successive frames (N, H, W) of one sequence.

        The windows stand where the spots of the frame before were, as published. The pattern is
        found in each frame all the same, to verify them; where a frame alone does not tell it, it
        is the one next to the frame before's. Where it moved by a quarter of the least distance
        of two apertures or more, and where the spots are lost, the windows start anew from it.
        ValueError on wrong input.
        """

        def follow(frames: NDArray[Any], levels: Levels, first: Pattern) -> Floats:
            return self._correlate(frames, levels, first.displacement, sequence=True)[0]

        return self._follow(as_frames(observations), follow)

    def _locate(self, frames: Frames, levels: Levels, pattern: Pattern) -> tuple[Floats, Floats]:
        return self._correlate(frames, levels, pattern.displacement, sequence=False)

    def _correlate(
        self, frames: NDArray[Any], levels: Levels, starts: Floats, *, sequence: bool
    ) -> tuple[Floats, Floats]:
        from algorithms.extractors.frames.multi_spot import correlation_kernel  # noqa: PLC0415 - Numba, at first use

        known = lattice(self.apertures_px).apertures
        widths, kinds = np.unique(known[:, 2], return_inverse=True)
        found = np.full((len(frames), 2), np.nan)
        spots = np.empty((len(frames), len(known), 2))
        floors = np.where(np.isfinite(levels.threshold), levels.floor, np.nan)
        correlation_kernel.correlate_spots(
            frames,
            floors,
            starts,
            known,
            drawn_templates(tuple(widths), self.blur_px, self.shape == "square"),
            kinds.astype(np.int64),
            self.correlations + 1,
            margin_px(self.blur_px),
            (self.presence, SHARE),
            sequence,
            found,
            spots,
        )
        return found, spots


@lru_cache(maxsize=8)
def drawn_templates(widths: tuple[float, ...], blur_px: float, square: bool) -> Floats:
    """Images (K, T, T) of apertures of these widths, px, centred, between 0 and 1.

    A rim of width `blur_px` falls off linearly about the aperture's own; pixels hold its mean.
    """
    half = math.ceil((max(widths) + blur_px) / 2.0 + 0.5)
    steps = (np.arange((2 * half + 1) * _SAMPLES) + 0.5) / _SAMPLES - half - 0.5
    x, y = np.meshgrid(steps, steps)
    away = np.maximum(np.abs(x), np.abs(y)) if square else np.hypot(x, y)
    rim = max(blur_px, 1.0 / _SAMPLES)
    shape = (len(widths), 2 * half + 1, _SAMPLES, 2 * half + 1, _SAMPLES)
    light = np.stack([np.clip((width / 2.0 - away) / rim + 0.5, 0.0, 1.0) for width in widths])
    templates: Floats = light.reshape(shape).mean(axis=(2, 4))
    templates.flags.writeable = False
    return templates
