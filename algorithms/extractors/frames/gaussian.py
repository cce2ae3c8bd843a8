"""Beyond the survey: a Gaussian fitted to the spot."""

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
)
from algorithms.extractors.frames.single_light import (
    Light,
    LightCheck,
    consistent_covariances,
    frames_to_measure,
    judge,
    light_of,
    longest_px_of,
    refused_flags,
    require_light,
)
from algorithms.extractors.profiles.single_spot import require_one_spot
from algorithms.inputs import Frames, as_frames
from algorithms.measurement import Measurement
from algorithms.parameters import require_at_least, require_positive

#: Mean square of what lit pixels depart from a shape by, over their variance, above which the spot
#: is of another shape: by how much the answer is off then, noise does not tell.
_MISFIT = 1.5


@dataclass(frozen=True)
class GaussianFit(Extractor):
    """Least-squares fit of a Gaussian plus background to the whole frame.

    This is the precise centroid of astronomical libraries. It has six parameters (amplitude,
    centre, a width along each axis, background) and gives every pixel equal weight. On other
    symmetric spots it is unbiased, but its error is above the bound.

    Parameters
    ----------
    tolerance_px : float
        The fit ends when a step moves centre and widths by less.
    iterations : int
        Maximum number of steps, at least 1; without convergence the fit fails.
    light : {"spot", "any"}
        Expected shape of the light. "spot": one whole, compact and symmetric spot; other light
        gives NaN. "any": also streaks, rings and stars, as lenses and slits cause them.
    longest_px : float or None
        Longest half axis that the outline of one spot has, px, positive; None if the design does
        not give it. See `algorithms.extractors.frames.mirror.extractor`.

    Raises
    ------
    ValueError
        If a parameter is not as said above; the message names it.

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
    refused: a second light shifts the fit without notice, one cut by the edge is fitted as such.

    Cost: 10 operations per pixel and step, some 8 steps, and that of registration.

    References
    ----------
    None of the survey: ours, to hold the others against.

    Examples
    --------
    >>> import numpy as np
    >>> y, x = np.mgrid[:21, :25]
    >>> frames = 200 * np.exp(-((x - 12.3) ** 2 + (y - 9.8) ** 2) / 6)[None]
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
        require_at_least(self.about.name, 1, iterations=self.iterations)
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
        """Centres, covariances and flags of frames (N, H, W) or of one.

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
        return Measurement(
            centres, consistent_covariances(covariance, centres, judged), judged.flags
        )

    def _answers(
        self, frames: Frames, bad: ArrayLike | None = None
    ) -> tuple[Floats, Floats, LightCheck]:
        """Centres (N, 2), NaN for none, the fits (N, 6), and what is to be said of them."""
        fitted = self._fit(frames)
        _, height, width = frames.shape
        light, x, y, s_x, s_y, _ = fitted.T
        found = (light > 0) & (s_x < width) & (s_y < height)
        found &= (x > -0.5) & (x < width - 0.5) & (y > -0.5) & (y < height - 0.5)
        centres = np.where(found[:, None], fitted[:, 1:3], np.nan)
        judged = judge(frames, centres, self.light, self.longest_px, bad)
        centres[refused_flags(judged.flags)] = np.nan
        return centres, fitted, judged

    def _fit(self, frames: Frames) -> Floats:
        """Parameters (N, 6) of the Gaussians; NaN rows where there is none."""
        from algorithms.extractors.frames import gaussian_kernel  # noqa: PLC0415 - Numba, at first use
        from algorithms.kernels import moments  # noqa: PLC0415 - Numba, at first use

        unusable = moments.unusable_frames(frames)
        fitted = np.full((len(frames), 6), np.nan)
        usable = frames[~unusable] if unusable.any() else frames
        fits = np.empty((len(usable), 6))
        if len(usable):
            usable.flags.writeable = False
            gaussian_kernel.fit_gaussians(usable, self.tolerance_px, self.iterations, fits)
        fitted[~unusable] = fits
        return fitted
