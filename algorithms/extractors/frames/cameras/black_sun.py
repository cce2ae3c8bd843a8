"""Centre of the Sun that a CMOS camera shows black within a saturated halo (BSCM)."""

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
from algorithms.documented import documented
from algorithms.inputs import as_frames
from algorithms.parameters import require_at_least, require_positive, require_within

#: Standard deviations of the blur beyond which its taps are left out.
_REACH = 3.0


@documented
@dataclass(frozen=True)
class BlackSunCentroid(Extractor):
    """Corner of the dark hole in binary masks of descending thresholds, averaged over them.

    Heavily overexposed pixels of a CMOS camera invert, so the Sun is a black disc with a sharp rim
    in a saturated halo. The hole is located in the mask of the middle threshold and followed
    through the other thresholds. The Sun keeps its position; a gap between bright patches moves or
    closes.

    Parameters
    ----------
    highest, lowest : float
        Fractions of the frame's range, after the blur, between which the thresholds descend.
        Ours: the study takes a range below the maximum that its camera sets.
    loops : int
        Thresholds, at least 1.
    survival : float
        Share of the thresholds, in (0, 1], that a corner must survive in a row.
    moved_px : float
        Largest move of a corner from one threshold to the next for which it survives.
    radius_px : float
        Least radius of a black Sun in the middle mask: dead pixels are smaller.
    blur_px : float
        Standard deviation of the Gaussian blur.

    Notes
    -----
    Implements: alg:BCSM (fe:bscm, Saleem2019): blur; masks ``I > T + f`` for falling f; contours;
    corners, refined to sub-pixels, inside the contour and off its edge; of those that survive, the
    one of largest radius above a minimum. The survey prints in words ``I`` lower than the
    threshold; corrected because the pseudocode's ``I > T + f`` is what leaves the black Sun a
    hole. Holes in every contour are tried, not in the largest alone, which under broken cloud is
    not the Sun's; a hole must be about round. The corner's refinement is that of structure
    tensors, ``sum(n n^T (q - p)) = 0`` over the hole's whole rim. The published one starts from
    every strong corner and looks at a window about it, which holds corners of a black Sun wider
    than some 3 px to its rim, about a radius off its centre. The published last resort, corners
    that did not survive, is left out: those are gaps.

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px)`` (N, 2), pixel centres at integers.

    Failure: a NaN row for a frame that is dark or without contrast or holds a NaN or infinity,
    where no hole survives (a white Sun, noise, a black Sun cut by the frame's edge), and where a
    second one has 0.8 of the largest radius (two Suns).

    Cost: 20 operations per pixel for the blur, 4 for the masks, and 10 per pixel of the holes and
    threshold.

    Examples
    --------
    >>> import numpy as np
    >>> y, x = np.mgrid[:40, :44]
    >>> away = np.hypot(x - 21.3, y - 19.8)
    >>> frames = 240 * (np.clip(9.5 - away, 0, 1) - np.clip(4.0 - away, 0, 1))[None]
    >>> BlackSunCentroid().extract(frames).round(2)
    array([[21.31, 19.81]])
    """

    about: ClassVar = AboutExtractor(
        name="bscm",
        taxonomy="BSCM",
        studies=("Saleem2019",),
        labels=("fe:bscm", "alg:BCSM"),
        origin="survey",
        needs=("lens_distortion",),
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    highest: float = 0.9
    lowest: float = 0.1
    loops: int = 16
    survival: float = 0.75
    moved_px: float = 0.5
    radius_px: float = 1.5
    blur_px: float = 1.0

    def __post_init__(self) -> None:
        if not 0.0 < self.lowest < self.highest < 1.0:
            raise ValueError(
                f"{self.about.name}: lowest and highest must rise within (0, 1); "
                f"got {self.lowest!r} and {self.highest!r}"
            )
        require_at_least(self.about.name, 1, loops=self.loops)
        require_within(self.about.name, "(0, 1]", survival=self.survival)
        require_positive(
            self.about.name, moved_px=self.moved_px, radius_px=self.radius_px, blur_px=self.blur_px
        )

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the method for a camera; UnsuitableDesignError for designs without a lens.

        Behind a mask a pixel never gets more than the bare Sun's light: nothing inverts. What a
        camera's detector does with too much light, the design does not say; behind a CCD nothing
        inverts either, and nothing is found.
        """
        geometry.require(*cls.about.needs, by=cls.about.name)
        return cls()

    def extract(self, observations: ArrayLike) -> Floats:
        """Centres (N, 2) in frames (N, H, W); ValueError on wrong input."""
        from algorithms.extractors.frames.cameras import dark_holes_kernel  # noqa: PLC0415 - Numba, at first use
        from algorithms.kernels import moments  # noqa: PLC0415 - Numba, at first use

        frames = as_frames(observations)
        unusable = moments.unusable_frames(frames)
        reach = np.ceil(_REACH * self.blur_px)
        taps = np.exp(-0.5 * (np.arange(-reach, reach + 1) / self.blur_px) ** 2)
        steps = np.arange(self.loops) + 0.5
        found = np.empty((len(frames), 2))
        dark_holes_kernel.black_suns(
            frames,
            ~unusable,
            taps / taps.sum(),
            self.highest + steps * (self.lowest - self.highest) / self.loops,
            int(np.ceil(self.survival * self.loops)),
            self.radius_px,
            self.moved_px,
            found,
        )
        return found
