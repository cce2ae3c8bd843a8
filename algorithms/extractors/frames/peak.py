"""Whole-pixel positions of largest values: of the summed profiles (PM)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from algorithms.contract import AboutExtractor, Extractor, FeatureKind, Floats, Observation
from algorithms.documented import documented
from algorithms.inputs import as_frames


@documented
@dataclass(frozen=True)
class PixelMax(Extractor):
    """Column and row whose summed light is largest.

    The frame is reduced to its two profiles, and the position is the largest entry of each. The
    method is fast and needs no threshold, but has no sub-pixel resolution.

    Notes
    -----
    Implements: alg:PM (fe:pm, Coutinho2022): ``r_i = sum_j I_ij``, ``c_j = sum_i I_ij``, ``y_c =
    argmax r``, ``x_c = argmax c``. The survey prints x_c from the row profile; corrected because x
    runs along columns here. If several maxima are equal, the first is used, as in the survey's
    text; its loop would use the last.

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px)`` (N, 2), whole numbers, pixel centres
    at integers.

    Failure: a NaN row for a frame that is dark (largest profile entry not positive), without
    contrast (all dark or all saturated) or holds a NaN or infinity.

    Cost: 2 operations per pixel, one pass.

    Examples
    --------
    >>> from algorithms.examples import spot_frame
    >>> frames = spot_frame(12.3, 9.8)
    >>> PixelMax().extract(frames)
    array([[12., 10.]])
    """

    about: ClassVar = AboutExtractor(
        name="pm",
        taxonomy="PM",
        studies=("Coutinho2022",),
        labels=("fe:pm", "alg:PM"),
        origin="survey",
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    def extract(self, observations: ArrayLike) -> Floats:
        """Positions (N, 2) in frames (N, H, W); ValueError on wrong input."""
        from algorithms.kernels import moments  # noqa: PLC0415 - Numba, at the first frame only

        frames = as_frames(observations)
        columns, rows = moments.axis_sums(frames)
        unusable = moments.unusable_frames(frames)
        found = np.column_stack([columns.argmax(axis=1), rows.argmax(axis=1)]).astype(np.float64)
        lit = (columns.max(axis=1) > 0) & (rows.max(axis=1) > 0)
        found[unusable | ~lit] = np.nan
        return found
