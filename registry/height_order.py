"""How far an order of errors is the order of heights: mask or lens over detector.

A spot that is found to within a length errs by an angle of that length over the height, so sensors
of different heights differ by their heights first.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

FEWEST = 5
"""Sensors below which no correlation is computed."""
LARGEST_P = 0.01
SHARE = 0.5
"""Of the variance of ranks: more is most of an order."""
REFERENCE_MM = 1.0
"""Height that errors are scaled to where heights shall not count."""

_PERMUTATIONS = 1999  # all of them for six sensors or fewer


@dataclass(frozen=True)
class HeightOrder:
    """Rank correlation of error and 1/height over sensors.

    Attributes
    ----------
    correlation, p_value
        Spearman's, and the share of permutations that correlate as much.
    sensors, without
        Compared, and left out for want of a height or an error.
    """

    correlation: float
    p_value: float
    sensors: int
    without: int

    @property
    def holds(self) -> bool:
        """Whether 1/height explains most of the order, and chance does not."""
        explains = self.correlation > 0.0 and self.correlation**2 > SHARE
        return explains and self.p_value <= LARGEST_P

    @property
    def sentence(self) -> str:
        """What holds, in words; empty where it does not."""
        if not self.holds:
            return ""
        left = f"; {self.without} have no height or error" if self.without else ""
        return (
            "Most of the order of these errors is the height's (mask or lens to detector): over "
            f"{self.sensors} architectures the rank correlation of error and 1/height is "
            f"{self.correlation:.2f} (p = {self.p_value:.1g}){left}. Compare them at equal height."
        )


def height_order(pairs: Iterable[tuple[float | None, float | None]]) -> HeightOrder | None:
    """Return how far errors follow 1/height; None for fewer than `FEWEST` sensors with both.

    None also where all errors or all heights are alike.

    Parameters
    ----------
    pairs
        Error (degrees) and height (mm) of each sensor; None or infinite where there is none.
    """
    every = list(pairs)
    known = [
        (error, 1.0 / height)
        for error, height in every
        if error is not None and math.isfinite(error) and height
    ]
    if len(known) < FEWEST or any(len(set(column)) == 1 for column in zip(*known, strict=True)):
        return None
    import numpy as np  # noqa: PLC0415 - with SciPy's statistics, seconds that few questions need
    from scipy.stats import permutation_test, rankdata, zscore  # noqa: PLC0415

    errors, inverses = (zscore(rankdata(column)) for column in zip(*known, strict=True))
    found = permutation_test(
        (errors,),
        lambda ranks, axis: np.mean(ranks * inverses, axis=axis),
        permutation_type="pairings",
        vectorized=True,
        n_resamples=_PERMUTATIONS,
        alternative="greater",
        rng=np.random.default_rng(0),
    )
    return HeightOrder(
        float(found.statistic), float(found.pvalue), len(known), len(every) - len(known)
    )


def at_reference(error_deg: float | None, height_mm: float | None) -> float | None:
    """Return an error scaled to `REFERENCE_MM`; None without an error or a height."""
    if error_deg is None or not height_mm:
        return None
    return error_deg * height_mm / REFERENCE_MM
