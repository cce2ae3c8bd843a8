"""Position where the light on either side of a spot's middle balances (DBCM)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from algorithms.contract import AboutExtractor, Extractor, FeatureKind, Floats, Observation
from algorithms.documented import documented
from algorithms.inputs import as_frames
from algorithms.parameters import require_at_least


@documented
@dataclass(frozen=True)
class DoubleBalance(Extractor):
    """Our variant of DBCM: balance of five areas in a window of 21 x 21 pixels around the spot.

    The window is found by winner-takes-it-all and moved until the light left and right of its
    centre column, above and below its centre row, differs by less than that column or row would
    change it: the spot's median, found with additions and one division.

    Parameters
    ----------
    moves : int
        Maximum number of window moves, at least 0; a whole spot needs two or three. 0 leaves the
        window on the brightest pixel, as in the pseudocode.

    Raises
    ------
    ValueError
        If `moves` is negative.

    Notes
    -----
    Implements: alg:DBCM (fe:dbcm, Xie2014, deBoer2013): with S_A ... S_E the sums of the window's
    columns 1 | 9 | 1 | 9 | 1, ``x_c = x_ROI + (S_D - S_B) / (2 (S_C - S_A))``; y with the rows.
    Printed on the assumption S_A = S_E; their mean is taken here, which is that on a dark
    background and halves its noise. The survey counts the columns from 2; corrected because the
    five areas fill 21. The printed threshold moves no maximum and is left out. If several pixels
    are brightest, the window starts on the first. Survey's pseudocode leaves the spot off-centre,
    its words track it over successive measurements: here the window is moved by the rounded offset
    until it stays. Pixels of the window outside the frame count as the mean of the rim inside.

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px)`` (N, 2), pixel centres at integers.

    Failure: a NaN row for a frame that is dark (maximum not positive), without contrast (all dark
    or all saturated) or holds a NaN or infinity, where the window does not converge, and where its
    outermost columns or rows differ by half of the centre's light (spot cut by the edge or far
    larger than the window). A spot slightly larger than the window, or a second spot in the
    window, biases the answer undetected. A second spot outside is ignored.

    Cost: 1 operation per pixel for the maxima, 3 per pixel of the window and move.

    Examples
    --------
    >>> from algorithms.examples import spot_frame
    >>> frames = spot_frame(16.3, 14.8, 31, 33)
    >>> DoubleBalance().extract(frames).round(2)
    array([[16.29, 14.8 ]])
    """

    about: ClassVar = AboutExtractor(
        name="dbcm",
        taxonomy="DBCM",
        studies=("Xie2014", "deBoer2013"),
        labels=("fe:dbcm", "alg:DBCM"),
        origin="survey",
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    moves: int = 10

    def __post_init__(self) -> None:
        require_at_least(self.about.name, 0, moves=self.moves)

    def extract(self, observations: ArrayLike) -> Floats:
        """Positions (N, 2) in frames (N, H, W); ValueError on wrong input."""
        from algorithms.extractors.frames import balance_kernel  # noqa: PLC0415 - Numba, at first use
        from algorithms.kernels import moments  # noqa: PLC0415 - Numba, at first use

        frames = as_frames(observations)
        maxima = np.empty(frames.shape[:2], dtype=frames.dtype)
        moments.row_maxima(frames, maxima)
        unusable = moments.unusable_frames(frames)
        found = np.empty((len(frames), 2))
        start = moments.first_brightest(frames, maxima)
        balance_kernel.five_areas(frames, start, self.moves, found)
        found[unusable | ~(maxima.max(axis=1) > 0)] = np.nan
        return found
