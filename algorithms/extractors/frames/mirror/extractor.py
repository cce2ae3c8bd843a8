"""Beyond the survey: the centre of any point-symmetric spot, registered on its mirror image."""

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
from algorithms.extractors.frames.single_light import longest_px_of
from algorithms.extractors.profiles.single_spot import require_one_spot
from algorithms.inputs import as_frames
from algorithms.measurement import Measurement
from algorithms.parameters import require_positive


@dataclass(frozen=True)
class MirrorRegistration(Extractor):
    """Centre of a point-symmetric spot, found by registration with its own mirror image.

    Discs, ellipses, squares, Gaussians and Airy patterns are point-symmetric; the method assumes
    nothing else about the shape. Hot and dead pixels and an uneven background are detected and
    removed.

    Parameters
    ----------
    longest_px : float or None
        Longest half axis of the outline of one spot, px, positive; an outline up to this size
        counts as one spot of any shape. Behind a slit it is half of the detector. None if the
        design does not give it.

    Raises
    ------
    ValueError
        If `longest_px` is not positive.

    Notes
    -----
    Implements: nothing printed in the survey. Pixels that are mirror images about half a pixel's
    place are compared; weighted least squares of their differences on the slopes of their means
    give the displacement: see `algorithms.extractors.frames.mirror.registration`.

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px)`` (N, 2), pixel centres at integers.

    Failure: a NaN row where there is no light (NO_SPOT), where there are two (SEVERAL_SPOTS),
    where the edge cuts the spot (CUT) and where it has no such centre (NOT_SYMMETRIC). Not
    distinguished from one spot: two equal lights closer than two of their widths, and a ghost
    closer than one. Ellipses a few pixels wide and over 2.2 times as long may be taken for two
    lights. Rims sharper than a pixel are found to some thousandths of a pixel, along rows or
    columns to hundredths.

    Cost: 10 operations per pixel, some 300 in single precision a pixel of the spot's surroundings.

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

        frames = as_frames(observations)
        centres = register(frames, None, self.longest_px).features
        if frames.dtype.kind == "f":  # measure alone answers for a frame that lacks pixels
            centres[~np.isfinite(frames).all(axis=(1, 2))] = np.nan
        return centres

    def measure(self, observations: ArrayLike, bad: ArrayLike | None = None) -> Measurement:
        """Centres, covariances and flags of frames (N, H, W) or of one; bad pixels are left out.

        See `algorithms.extractors.frames.mirror.registration.register`.
        """
        from algorithms.extractors.frames.mirror.registration import register  # noqa: PLC0415 - Numba

        return register(observations, bad, self.longest_px)
