"""Beyond the survey: estimators matched to the spot's image, by likelihood or by a Gaussian."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

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
from algorithms.extractors.frames.one_light import (
    Judged,
    Light,
    frames_to_measure,
    judge,
    light_of,
    longest_px_of,
    refused,
    require_light,
    stated,
)
from algorithms.inputs import Frames, as_frames, require_positive
from algorithms.measurement import Doubt, Measurement

#: Mean squared distance of the lit pixels, over that of a disc, above which they are not one spot.
_SPREAD = 3.0
#: Square of what light within rings scatters by, over the brightest ring's, up to which there is
#: one round light: another one that moves the centre by a pixel leaves more.
_EVEN = 0.01
#: Mean square of what lit pixels depart from a shape by, over their variance, above which the spot
#: is of another shape: by how much the answer is off then, noise does not tell.
_MISFIT = 1.5
#: Noise that nothing tells.
_UNTOLD = np.empty((0, 2))


@documented
@dataclass(frozen=True)
class MatchedProfile(Extractor):
    """Maximum-likelihood centre of a round spot whose profile is taken from the frame itself.

    A thresholded centroid starts it. The light is averaged in rings around that start, and
    Gauss-Newton steps move the centre to where the frame fits this profile best, each pixel
    weighted by its variance, which the frame shows too. Ours: the ceiling other extractors are
    held against.

    Parameters
    ----------
    threshold : float
        Fraction of the peak above the background, in (0, 1), for the start.
    steps : int
        Gauss-Newton steps, at least 1, each with the profile about the last centre.

    Notes
    -----
    Implements: nothing printed in the survey. With p(r) the profile, c = (cos, sin) of a pixel's
    direction and v its variance, the step d solves ``sum(c c^T p'^2 / v) d = -sum(c p' (I - p)
    / v)``. The slope of p is that of a line through the seven rings about a pixel's, its bend
    that of the slopes beside; a ring is as wide as the contrast to the power -1/3. The background
    and its variance are those of the frame's border; a lit pixel has more variance in proportion
    to its light, by the factor that explains the scatter within the rings. Of the slope squared,
    what noise explains is taken off.

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px)`` (N, 2), pixel centres at integers.

    Failure: a NaN row for a frame that is dark (maximum not above the border), without contrast
    (all dark or all saturated) or holds a NaN or infinity, and where the lit pixels are not one
    compact spot (two spots, a line, noise) or touch the edge (a spot cut by it). Where rings are
    uneven by more than a tenth, or the spot is of a few pixels, also where registration
    (`algorithms.extractors.frames.mirror`) does not find one whole symmetric light within half a
    pixel of the answer. A spot that is not round is found without bias where it is symmetric, above
    the bound.

    Cost: 2 operations a pixel, 45 a pixel of the spot's surroundings and step; that of registration
    for spots that are not round.

    References
    ----------
    None of the survey: ours, to hold the others against.

    Examples
    --------
    >>> import numpy as np
    >>> y, x = np.mgrid[:31, :33]
    >>> spot = 200 * np.clip(5.5 - np.hypot(x - 16.3, y - 14.8), 0, 1)
    >>> frames = np.random.default_rng(1).normal(spot, 5.0, (1, 31, 33))
    >>> MatchedProfile().extract(frames).round(1)
    array([[16.3, 14.8]])
    """

    about: ClassVar = AboutExtractor(
        name="matched-profile",
        taxonomy="None",
        origin="ours",
        version=5,
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    threshold: float = 0.3
    steps: int = 1
    light: Light = "spot"
    longest_px: float | None = None

    def __post_init__(self) -> None:
        if not 0.0 < self.threshold < 1.0:
            raise ValueError(
                f"{self.about.name}: threshold must be in (0, 1); got {self.threshold!r}"
            )
        if self.steps < 1:
            raise ValueError(f"{self.about.name}: steps must be at least 1; got {self.steps!r}")
        require_light(self.about.name, self.light, self.longest_px)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the estimator; UnsuitableDesignError for designs without a single spot."""
        require_one_spot(geometry, cls.about.name)
        return cls(light=light_of(geometry), longest_px=longest_px_of(geometry))

    def extract(self, observations: ArrayLike) -> Floats:
        """Centres (N, 2) in frames (N, H, W); ValueError on wrong input."""
        frames = as_frames(observations)
        found = self._found(frames)
        uneven = np.flatnonzero(found[:, 5] > _EVEN)
        if len(uneven):
            judged = judge(frames[uneven], found[uneven, :2], self.light, self.longest_px)
            found[uneven[refused(judged.doubts)]] = np.nan
        return found[:, :2].copy()

    def measure(self, observations: ArrayLike, bad: ArrayLike | None = None) -> Measurement:
        """Centres, covariances and doubts of frames (N, H, W) or of one.

        The covariance is that of the step, with the noise that registration shows, times the mean
        square of what pixels depart from the profile by over it. It is NaN where that is more than
        noise explains or registration finds the centre elsewhere, so that the spot is not round or
        the background not even, where under 32 pixels are lit and where `light` is "any". Bad
        pixels are replaced by their neighbours.
        """
        frames = frames_to_measure(observations, bad, self.about.name)
        judged = judge(frames, self._found(frames)[:, :2], self.light, self.longest_px, bad)
        found = self._found(frames, judged.noise)
        doubts = np.where(np.isnan(found[:, 0]), int(Doubt.NO_SPOT), 0).astype(np.int64)
        uneven = found[:, 5] > _EVEN
        doubts[uneven] = judged.doubts[uneven]
        found[refused(doubts)] = np.nan
        centres, covariance = found[:, :2].copy(), found[:, [2, 4, 4, 3]].reshape(-1, 2, 2)
        return Measurement(centres, stated(covariance, centres, judged), doubts)

    def _found(self, frames: Frames, noise: Floats = _UNTOLD) -> Floats:
        """Return what `radial_kernel.matched_centres` writes, with covariances where noise is."""
        from algorithms.extractors.frames import radial_kernel  # noqa: PLC0415 - Numba, at first use
        from algorithms.kernels import moments  # noqa: PLC0415 - Numba, at first use

        maxima = np.empty(frames.shape[:2], dtype=frames.dtype)
        moments.row_maxima(frames, maxima)
        unusable = np.empty(len(frames), dtype=np.bool_)
        moments.unusable(frames, frames.dtype.kind == "f", unusable)
        maxima[unusable] = 0
        found = np.empty((len(frames), radial_kernel.MATCHED))
        radial_kernel.matched_centres(
            frames, maxima, self.threshold, _SPREAD, self.steps, noise, _MISFIT, found
        )
        found[unusable] = np.nan
        return found


@documented
@dataclass(frozen=True)
class GaussianFit(Extractor):
    """Least-squares fit of a Gaussian on a background to the whole frame.

    What astronomers' libraries offer as their precise centroid: six parameters, amplitude,
    centre, a width along each axis and background, every pixel of equal weight. On spots that
    are no Gaussian it is still centred, but above the bound.

    Parameters
    ----------
    tolerance_px : float
        The fit ends when a step moves centre and widths by less.

    Notes
    -----
    Implements: nothing printed in the survey: ``min sum (I - b - A exp(-(x - x_c)^2 / 2 s_x^2 -
    (y - y_c)^2 / 2 s_y^2))^2`` by Levenberg-Marquardt, from the pixels brighter than half. The
    axes of the ellipse are those of the frame.

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px)`` (N, 2), pixel centres at integers.

    Failure: a NaN row for a frame that is dark (maximum not above the border), without contrast
    (all dark or all saturated) or holds a NaN or infinity, where the fit does not converge, to a
    light above the background, to a centre inside the frame and to widths below its sides; and
    where registration (`algorithms.extractors.frames.mirror`) does not find one whole symmetric
    light within half a pixel of the centre. Where `light` is "any", only hot pixels and noise are
    refused: a second light draws the fit unseen, one cut by the edge is fitted as such.

    Cost: 10 operations a pixel and step, some 8 steps, and that of registration.

    References
    ----------
    None of the survey: ours, to hold the others against.

    Examples
    --------
    >>> from algorithms.examples import spot_frame
    >>> frames = spot_frame(12.3, 9.8)
    >>> GaussianFit().extract(frames + 50).round(3)
    array([[12.3,  9.8]])
    """

    about: ClassVar = AboutExtractor(
        name="gaussian-fit",
        taxonomy="None",
        origin="ours",
        version=3,
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    tolerance_px: float = 1e-6
    iterations: int = 50
    light: Light = "spot"
    longest_px: float | None = None

    def __post_init__(self) -> None:
        require_positive(self.about.name, tolerance_px=self.tolerance_px)
        if self.iterations < 1:
            raise ValueError(
                f"{self.about.name}: iterations must be at least 1; got {self.iterations!r}"
            )
        require_light(self.about.name, self.light, self.longest_px)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the fit; UnsuitableDesignError for designs without a single spot."""
        require_one_spot(geometry, cls.about.name)
        return cls(light=light_of(geometry), longest_px=longest_px_of(geometry))

    def extract(self, observations: ArrayLike) -> Floats:
        """Centres (N, 2) in frames (N, H, W); ValueError on wrong input."""
        return self._answers(as_frames(observations))[0]

    def measure(self, observations: ArrayLike, bad: ArrayLike | None = None) -> Measurement:
        """Centres, covariances and doubts of frames (N, H, W) or of one.

        The covariance is that of the linearised fit, with the variance that pixels depart from it
        by. It is NaN where that is more than the noise that registration shows, or registration
        finds the centre elsewhere, so that the spot is no Gaussian or the background not even, and
        where `light` is "any". Bad pixels are replaced by their neighbours.
        """
        from algorithms.extractors.frames import gaussian_kernel  # noqa: PLC0415 - Numba, at first use

        frames = frames_to_measure(observations, bad, self.about.name)
        centres, fitted, judged = self._answers(frames, bad)
        covariance = np.empty((len(frames), 2, 2))
        nothing = np.isnan(centres[:, :1])
        noise = np.where(nothing, np.nan, judged.noise)
        gaussian_kernel.covariances(frames, fitted, noise, _MISFIT, covariance)
        return Measurement(centres, stated(covariance, centres, judged), judged.doubts)

    def _answers(
        self, frames: Frames, bad: ArrayLike | None = None
    ) -> tuple[Floats, Floats, Judged]:
        """Centres (N, 2), NaN for none, the fits (N, 6), and what is to be said of them."""
        fitted = self._fitted(frames)
        _, height, width = frames.shape
        light, x, y, s_x, s_y, _ = fitted.T
        found = (light > 0) & (s_x < width) & (s_y < height)
        found &= (x > -0.5) & (x < width - 0.5) & (y > -0.5) & (y < height - 0.5)
        centres = np.where(found[:, None], fitted[:, 1:3], np.nan)
        judged = judge(frames, centres, self.light, self.longest_px, bad)
        centres[refused(judged.doubts)] = np.nan
        return centres, fitted, judged

    def _fitted(self, frames: Frames) -> Floats:
        """Parameters (N, 6) of the Gaussians; NaN rows where there is none."""
        from algorithms.extractors.frames import gaussian_kernel  # noqa: PLC0415 - Numba, at first use
        from algorithms.kernels import moments  # noqa: PLC0415 - Numba, at first use

        unusable = np.empty(len(frames), dtype=np.bool_)
        moments.unusable(frames, frames.dtype.kind == "f", unusable)
        fitted = np.full((len(frames), 6), np.nan)
        usable = frames[~unusable] if unusable.any() else frames
        fits = np.empty((len(usable), 6))
        if len(usable):
            usable.flags.writeable = False
            gaussian_kernel.fit_gaussians(usable, self.tolerance_px, self.iterations, fits)
        fitted[~unusable] = fits
        return fitted


def require_one_spot(geometry: SensorGeometry, by: str) -> None:
    """Raise UnsuitableDesignError for a design whose frames hold several spots, or lines."""
    for field in ("apertures", "slits", "code_bits"):
        if getattr(geometry, field) is not None:
            raise UnsuitableDesignError(
                f"{by} reads a single spot; the sensor's design has {field}"
            )
