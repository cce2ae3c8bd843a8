"""Middle of a spot's profiles, averaged over many thresholds (MT-ACM)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from algorithms.contract import AboutExtractor, Extractor, FeatureKind, Floats, Observation
from algorithms.documented import documented
from algorithms.inputs import as_frames
from algorithms.parameters import require_choice
from algorithms.row_arithmetic import medians

Crossing = Literal["pixel", "linear"]
"""``pixel``: the first entry above the threshold. ``linear``: interpolated to the entry before."""


@documented
@dataclass(frozen=True)
class MultipleThresholdCentroid(Extractor):
    """Midpoint between a profile's two flanks, averaged over many thresholds.

    The frame is reduced to its column and row sums; each threshold makes them binary, and the
    first rises from both ends have their middle in the spot's centre where the spot is
    symmetric. Averaging thresholds resolves fractions of a pixel.

    Parameters
    ----------
    lowest, highest : float
        Fractions of the profile's height above its floor between which thresholds lie. Ours: the
        study leaves them open; noise must stay below the lowest, and the top is too flat to tell
        a position.
    crossing : {"pixel", "linear"}
        Whether a rise counts at its pixel, as published, or is interpolated to the entry before.

    Notes
    -----
    Implements: alg:MTACM1, alg:MTACM2 (fe:mtacm, Massari2004): ``N_TH > sigma sqrt(e) / dx``,
    ``x_ml = (h_l + k_l) / 2``, ``x_c = mean_l x_ml``, in pixels (Delta X = 1). h_l is the first
    rise from the left, k_l the first from the right; a threshold that one side does not cross is
    left out. The survey prints x over the row sums; corrected because x runs along columns here.
    The floor is the profile's median, sigma its area above that over ``sqrt(2 pi)`` of its height.

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px)`` (N, 2), pixel centres at integers.

    Failure: a NaN row for a frame that is dark (no profile entry positive), without contrast (all
    dark or all saturated) or holds a NaN or infinity, for spots wider than half of the frame, and
    where the edge cuts the spot so that no threshold has a rise from both sides. Two spots give
    the middle between their outer flanks, undetected.

    Cost: 2 operations per pixel for the profiles, the median of each, and 4 per threshold.

    Examples
    --------
    >>> from algorithms.examples import spot_frame
    >>> frames = spot_frame(12.3, 9.8)
    >>> MultipleThresholdCentroid(crossing="linear").extract(frames).round(2)
    array([[12.3,  9.8]])
    """

    about: ClassVar = AboutExtractor(
        name="mt-acm",
        taxonomy="MT-ACM",
        studies=("Massari2004",),
        labels=("fe:mtacm", "alg:MTACM1", "alg:MTACM2"),
        origin="survey",
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    accuracy_px: float = 0.01
    lowest: float = 0.25
    highest: float = 0.9
    crossing: Crossing = "pixel"

    def __post_init__(self) -> None:
        if not 1e-4 <= self.accuracy_px < np.inf:
            raise ValueError(
                f"{self.about.name}: accuracy_px must be at least 1e-4 and finite; "
                f"got {self.accuracy_px!r}"
            )
        if not 0.0 <= self.lowest < self.highest <= 1.0:
            raise ValueError(
                f"{self.about.name}: lowest and highest must rise within [0, 1]; "
                f"got {self.lowest!r} and {self.highest!r}"
            )
        require_choice(self.about.name, Crossing, crossing=self.crossing)

    def extract(self, observations: ArrayLike) -> Floats:
        """Positions (N, 2) in frames (N, H, W); ValueError on wrong input."""
        from algorithms.kernels import crossings, moments  # noqa: PLC0415 - Numba, at first use

        frames = as_frames(observations)
        columns, rows = moments.axis_sums(frames)
        unusable = moments.unusable_frames(frames)
        unusable |= ~((columns.max(axis=1) > 0) & (rows.max(axis=1) > 0))
        found = np.empty((2, len(frames)))
        for middle, profile in zip(found, (columns, rows), strict=True):
            usable = np.where(unusable[:, None], 0.0, profile)
            crossings.threshold_midpoints(
                usable,
                medians(usable),
                self.accuracy_px,
                self.lowest,
                self.highest,
                self.crossing == "linear",
                middle,
            )
        return np.where(np.isnan(found).any(axis=0), np.nan, found).T.copy()
