"""Scores of measured pipelines as columns."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from registry.measured_pipelines import Score

Numbers = NDArray[np.float64]


class Scores:
    """Scores as columns; ``rows`` are the pipelines that they are of."""

    def __init__(self, pairs: Sequence[tuple[int, Score]], half_fov_deg: Numbers) -> None:
        self.rows = np.array([at for at, _ in pairs], int)
        scores = [score for _, score in pairs]
        self.has_score = np.zeros(len(half_fov_deg), bool)
        self.has_score[self.rows] = True
        self.half_fov_deg = half_fov_deg[self.rows]
        rms = numbers(score.rms_deg for score in scores)
        available = np.array([score.is_available for score in scores], bool)
        self.rms = rms
        self.error = np.where(available & ~np.isnan(rms), rms, np.inf)
        self.share = np.where(np.isnan(rms), 0.0, numbers(score.availability for score in scores))
        most = max((len(score.cones) for score in scores), default=0)
        self.cones = [
            (
                numbers(s.cones[at][0] if at < len(s.cones) else None for s in scores),
                numbers(s.cones[at][1] if at < len(s.cones) else None for s in scores),
            )
            for at in range(most)
        ]

    def over(self, half: float | None) -> Numbers:
        """Return the error of each over a field, as `MeasuredPipeline.over` finds it."""
        if half is None:
            return self.error
        found = np.where(self.half_fov_deg >= half, self.error, np.inf)
        for edge, error in reversed(self.cones):
            found = np.where((edge >= half) & ~np.isnan(error), error, found)
        return found


def numbers(values: Iterable[float | None]) -> Numbers:
    """Return numbers as an array, NaN for None."""
    return np.array([math.nan if value is None else value for value in values], float)
