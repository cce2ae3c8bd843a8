"""Mean shift of many spots towards a goal spot's histogram, with tracking (FMMS)."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
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
from algorithms.parameters import require_positive, require_within


@documented
@dataclass(frozen=True)
class MeanShift(MaskSpots, Extractor):
    """Mean of all spots, each moved to where its gray values resemble those of a goal spot.

    A spot is described by a histogram of its gray values, weighted by a kernel about its centre.
    Mean shifts move each spot's window to the position where its histogram best matches the
    reference; spots are weighted by their similarity, so dirty spots count less and missing ones
    not at all.

    Parameters
    ----------
    bandwidth_px : float
        Radius h of a candidate's kernel, px, positive: it should hold a spot and the move between
        two frames, but no light of a neighbour.
    blur_px : float
        Width of the Sun's image behind a hole, px, not negative: added to an aperture's width
        for the goal's kernel.
    threshold : float
        Upper end t_1 of the first bin, the background, as a fraction in (0, 1) of the spots'
        brightness above it.
    bins : int
        Number m of bins, 3 to 256; all but the first are equally wide up to the brightness. Ours:
        of many bins some stay empty in the goal, and pixels in them are lost.
    convergence_px : float
        Step epsilon that ends the shift, px, positive.
    similarity : float
        Similarity (Bhattacharyya coefficient relative to that of the reference spots) below which a
        spot counts as missing; in (0, 1).

    Notes
    -----
    Implements: alg:FMMS1, alg:FMMS2 (fe:fmms, You2011): ``q_u = C sum K_E delta[b(x_i) - u]``,
    ``p_u(y)`` alike with ``(y - x_i) / h``, ``rho = sum sqrt(p_u q_u)``, ``w_i = sqrt(q_u /
    p_u(y_0))`` for the pixel's bin u, ``y_1 = sum(x_i w_i g) / sum(w_i g)``, halved towards y_0
    while rho falls. The survey prints the weights with p_u(y_1); corrected because y_1 is not known
    yet. g is constant inside the window for the Epanechnikov kernel, whose profile ``1 - r^2`` is
    meant where K_E is printed with a squared norm. The printed halving does not end once a maximum
    is reached; here it ends at steps below epsilon.

    The study's goal is a spot of an earlier frame; here it is the mean of the spots found whole
    in the same frame (in `track`, in the first one), with a kernel that ends at their rim and
    without the background's bin: a goal that holds as much background as the candidates weights
    it alike, and nothing moves. Starts are the spots' places in the pattern, found as MCAM does.

    A pixel enters with its bin's weight, not with its light: a single spot is resolved to some
    twentieth of a pixel only, and noise that moves pixels from bin to bin counts several times
    what it does in a centroid. The mean over spots that fall differently on the pixels is finer.

    Failure: a NaN row where the pattern is not found, as for MCAM, and where fewer than 0.3 of the
    spots that should be whole in the frame resemble the goal.

    Cost: as MCAM, and 10 operations per pixel of a window of radius h, a spot and a step: three or
    four steps.

    Examples
    --------
    >>> from algorithms.examples import mask_frame
    >>> frames, holes = mask_frame(23.4, 18.8)
    >>> MeanShift(holes, bandwidth_px=6.0).extract(frames).round(1)
    array([[23.4, 19. ]])
    """

    about: ClassVar = AboutExtractor(
        name="fmms",
        taxonomy="FMMS",
        studies=("You2011",),
        labels=("fe:fmms", "alg:FMMS1", "alg:FMMS2"),
        origin="survey",
        version=3,
        needs=PATTERN_NEEDS,
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    _: KW_ONLY
    bandwidth_px: float
    bins: int = 8
    convergence_px: float = 0.01
    similarity: float = 0.5

    def __post_init__(self) -> None:
        super().__post_init__()
        require_positive(
            self.about.name, bandwidth_px=self.bandwidth_px, convergence_px=self.convergence_px
        )
        if not 3 <= self.bins <= 256:
            raise ValueError(f"{self.about.name}: bins must be from 3 to 256; got {self.bins!r}")
        require_within(self.about.name, "(0, 1)", similarity=self.similarity)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the method with this sensor's mask.

        UnsuitableDesignError where its light is no spots. The bandwidth is a spot's width at
        normal incidence, or what neighbours leave of it.
        """
        design = design_pattern(geometry, cls.about.name)
        apertures = np.array(design["apertures_px"])
        width = float(apertures[:, 2].max()) + design["blur_px"]
        room = nearest_distance(apertures) - width / 2.0 - 1.0
        return cls(bandwidth_px=round(max(min(width, room), 1.0), 6), **design)

    def extract(self, observations: ArrayLike) -> Floats:
        """Averaged positions (N, 2) in frames (N, H, W); ValueError on wrong input."""
        return self._read(as_frames(observations))[0][0]

    def weights(self, observations: ArrayLike) -> Floats:
        """Similarity (N, A) of each aperture's spot to the goal, over that of the goal's own.

        Zero where no spot is found. ValueError on wrong input.
        """
        return self._read(as_frames(observations))[0][2]

    def track(self, observations: ArrayLike) -> Floats:
        """Averaged positions (N, 2) in successive frames (N, H, W) of one sequence.

        Every spot starts where it was in the frame before, as published. The pattern is found in
        each frame all the same, to verify them; where a frame alone does not tell it, it is the
        one next to the frame before's. Where it moved by a quarter of the least distance of two
        apertures or more, and where the spots are lost, the shift starts anew from it with a goal
        of that frame. ValueError on wrong input.
        """

        def follow(frames: NDArray[Any], levels: Levels, first: Pattern) -> Floats:
            return self._shift(frames, levels, first, sequence=True)[0]

        return self._follow(as_frames(observations), follow)

    def _locate(
        self, frames: Frames, levels: Levels, pattern: Pattern
    ) -> tuple[Floats, Floats, Floats]:
        return self._shift(frames, levels, pattern, sequence=False)

    def _shift(
        self,
        frames: NDArray[Any],
        levels: Levels,
        pattern: Pattern,
        *,
        sequence: bool,
    ) -> tuple[Floats, Floats, Floats]:
        from algorithms.extractors.frames.multi_spot import mean_shift_kernel  # noqa: PLC0415 - Numba, at first use

        known = lattice(self.apertures_px).apertures
        found = np.full((len(frames), 2), np.nan)
        spots = np.empty((len(frames), len(known), 2))
        weights = np.empty((len(frames), len(known)))
        with np.errstate(invalid="ignore"):  # infinite levels: frames left out
            steps = (levels.peak - levels.threshold) / (self.bins - 2)
        mean_shift_kernel.shift_spots(
            frames,
            levels.threshold,
            steps,
            pattern.spots,
            pattern.displacement,
            known,
            margin_px(self.blur_px),
            ((float(known[:, 2].max()) + self.blur_px) / 2.0 + 1.0, self.bandwidth_px),
            (self.convergence_px, self.similarity, self.tolerance_px, SHARE),
            sequence,
            self.bins,
            found,
            spots,
            weights,
        )
        return found, spots, weights
