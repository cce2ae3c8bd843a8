"""Beyond the survey: the centre of any point-symmetric spot, registered on its mirror image."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

from numpy.typing import ArrayLike

from algorithms.contract import (
    AboutExtractor,
    Extractor,
    FeatureKind,
    Floats,
    Observation,
    SensorGeometry,
)
from algorithms.extractors.frames.one_light import longest_px_of
from algorithms.extractors.profiles.single_spot import require_one_spot
from algorithms.inputs import as_frames, require_positive
from algorithms.measurement import Measurement


@dataclass(frozen=True)
class MirrorRegistration(Extractor):
    """Centre at which a spot coincides with its own image turned by 180 degrees.

    Discs, ellipses, squares, Gaussians, Airy patterns and whatever shears them have such a centre;
    no shape is assumed beyond that. Hot and dead pixels and a background that slopes or bends are
    found and left out; two lights, a spot cut by the edge or one without symmetry are no answer.

    Parameters
    ----------
    longest_px : float or None
        Longest half axis that the outline of one spot has, px, positive: outlines up to it are of
        one spot, whatever their shape; half of the detector behind a slit. None where no design
        tells.

    Raises
    ------
    ValueError
        If `longest_px` is not positive.

    Notes
    -----
    Implements: nothing printed in the survey. About a point m / 2, m whole, pixels x and m - x
    pair without interpolation. With f the spot about its centre c, d = 2 c - m and u = x - m / 2,
    a pair's difference is ``D = f(u - d/2) - f(u + d/2)`` and its mean ``S = (f(u - d/2) + f(u +
    d/2)) / 2``, so that ``D = -2 tanh(d . grad / 2) S``, a filter on S that depends on d alone.
    Noise of D and S is independent where both pixels have the same, and so is that of different
    pairs: d solves the weighted least squares of D on the slopes of S, by steps. Half of the Fisher
    information about c is in f(u - d/2), half in its mirror image, and an unknown but symmetric f
    is orthogonal to both: nothing of the Cramer-Rao bound is lost.

    The weights are one over the variance, of the border's pixels and of what neighbouring
    departures differ by where there is light, by the mean light around: weights as sharp as a rim
    would turn what slopes miss of it into a share of d. The slopes that weigh are smoothed as long
    as this lowers the variance, and the products with those that predict are freed of the noise
    both have in common. The background's odd part, linear and where it shows cubic, is fitted
    around the spot. Pairs that depart by 4.5 deviations are left out, and the worse pixel of the
    two becomes the other one.

    `measure` gives the covariance of that fit, with what the background's slopes are uncertain by,
    times the mean square of the departures over what was expected: of two pixels' noise and of that
    of the slopes, which have it from the same pixels. Few departures tell a variance badly: it is
    that of Student's distribution. Outlines of one spot are alike
    at all heights; those of two that overlap are not, or have a waist. A weaker light beside a spot
    makes it skew: cubic odd shapes are fitted to what the slopes leave. A hole's fringes make such
    outlines, and oblique light such skewness: they count where the spot is longer than the design's
    shadow and its diffraction, or where no design tells.

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px)`` (N, 2), pixel centres at integers.

    Failure: a NaN row for a frame without contrast or with a NaN or infinity, where no 2 x 2 pixels
    are five standard deviations above the border (`measure`: NO_SPOT); where a second light has
    over 15 % of the first one's, both lie apart as one loose region, or outlines are not those of
    one spot (SEVERAL_SPOTS); where the spot reaches the frame's edge (CUT); and where departures
    are alike, in clusters, too large or skew (NOT_SYMMETRIC). GHOST and SATURATED stand beside
    answers too. Two equal lights are point-symmetric about their middle: two Gaussians closer than
    two of their widths have one maximum and the outlines of a longer spot, two squares side by side
    those of a rectangle, and only a design could tell. So could it alone where a ghost is closer to
    a Gaussian than about its width: of skewness, which goes with the cube of the distance, noise
    leaves nothing. Ellipses a few pixels wide and over 2.2
    times as long may be taken for two lights. Rims sharper than a pixel resolves are found to some
    thousandths of a pixel, those along rows or columns to hundredths.

    Cost: 10 operations a pixel, some 300 in single precision a pixel of the spot's surroundings.

    References
    ----------
    None of the survey: ours.

    Examples
    --------
    >>> import numpy as np
    >>> y, x = np.mgrid[:40, :44]
    >>> u, v = (x - 21.3) / 2 + (y - 18.8) / 4, (y - 18.8) - (x - 21.3) / 5
    >>> ellipse = 900 / (1 + np.exp(2 * (np.hypot(u, v) - 4.5)))
    >>> frames = np.random.default_rng(1).normal(50 + ellipse, 5.0)[None]
    >>> MirrorRegistration().extract(frames).round(1)
    array([[21.3, 18.8]])
    """

    about: ClassVar = AboutExtractor(
        name="mirror",
        taxonomy="None",
        origin="ours",
        version=4,
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    longest_px: float | None = None

    def __post_init__(self) -> None:
        if self.longest_px is not None:
            require_positive(self.about.name, longest_px=self.longest_px)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the estimator; UnsuitableDesignError for designs without a single spot."""
        require_one_spot(geometry, cls.about.name)
        longest, centre = longest_px_of(geometry), geometry.centre_px
        slit = geometry.aperture_width_mm is not None and geometry.aperture_shape is None
        if longest is None and slit and centre is not None:
            longest = max(centre)  # half of the detector: of a slit no design says how long it is
        return cls(longest)

    def extract(self, observations: ArrayLike) -> Floats:
        """Centres (N, 2) in frames (N, H, W); ValueError on wrong input."""
        from algorithms.extractors.frames.mirror.registration import register  # noqa: PLC0415 - Numba

        return register(as_frames(observations), None, self.longest_px).features

    def measure(self, observations: ArrayLike, bad: ArrayLike | None = None) -> Measurement:
        """Centres, covariances and doubts of frames (N, H, W) or of one; bad pixels are left out.

        See `algorithms.extractors.frames.mirror.registration.register`.
        """
        from algorithms.extractors.frames.mirror.registration import register  # noqa: PLC0415 - Numba

        return register(observations, bad, self.longest_px)
