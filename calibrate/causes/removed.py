"""Rows that were left out: how many, and whether their cause is known."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from calibrate.causes.bad_cells import DUPLICATE
from calibrate.exclusions import FOLD, WRONG, Excluded
from calibrate.readings import BEHIND, FAINT_ROWS, NO_SUM, Readings

#: Share of rows that may be left out without a cause, and with one.
_UNNAMED, _ALL = 0.02, 0.5
#: Wrong poses among the nearest poses of one, over their share of all, from which they gather.
_NEIGHBOURS, _GATHERED = 8, 3.0
_MOST_SCATTERED = 0.15


def unexplained(
    readings: Readings, excluded: Sequence[Excluded], wrong: Readings, half_fov_deg: float | None,
    fold_deg: float | None,
) -> str:  # fmt: skip
    """Return, in a sentence, which rows were left out without a known cause; empty where few were.

    Wrong poses are known as such where they lie among others that are right, at most 15 % of all:
    where they gather, the sensor is what does not do as the others say. What another direction
    reads too is known beyond the stated field of view alone. A row that is there twice loses
    nothing of the field and does not count.

    Parameters
    ----------
    readings : Readings
        That were fitted, with what was dropped while reading.
    excluded : sequence of Excluded
    wrong : Readings
        The wrong poses.
    half_fov_deg, fold_deg : float or None
        Half the field of view as stated, and the smallest off-axis angle that folds.
    """
    reasons = Counter(one.reason for one in excluded if one.reason != DUPLICATE)
    dropped = {name: n for name, n in readings.dropped.items() if name != BEHIND}
    out = sum(reasons.values()) + sum(dropped.values())
    whole = len(readings) + out
    unnamed = {NO_SUM: dropped.get(NO_SUM, 0)}
    beyond = half_fov_deg is not None and fold_deg is not None and fold_deg >= half_fov_deg
    if not beyond:
        unnamed[FOLD] = reasons[FOLD]
    share = len(wrong) / whole
    if share > _MOST_SCATTERED or _gathered(readings, wrong):
        unnamed[WRONG] = len(wrong)
    count = sum(unnamed.values())
    if count > _UNNAMED * whole:
        said = ", ".join(f"{n} {name}" for name, n in unnamed.items() if n)
        return f"{count} of {whole} rows were left out without a known cause ({said})"
    if out > _ALL * whole:
        most = Counter({**reasons, **dropped}).most_common(3)
        said = ", ".join(f"{n} {name}" for name, n in most)
        return (
            f"{out} of {whole} rows were left out ({said}): what is left is not the sensor's field"
        )
    if dropped.get(FAINT_ROWS, 0) > _ALL * whole:
        return f"{dropped[FAINT_ROWS]} of {whole} rows have hardly any light"
    return ""


def _gathered(readings: Readings, wrong: Readings) -> bool:
    """Say whether wrong poses lie next to each other more than chance has them do."""
    from scipy.spatial import cKDTree  # noqa: PLC0415 - SciPy, at the first use

    if len(wrong) < _NEIGHBOURS:
        return False
    every = np.vstack([wrong.sun, readings.sun])
    near = np.asarray(cKDTree(every).query(wrong.sun, k=min(_NEIGHBOURS + 1, len(every)))[1])[:, 1:]
    share = len(wrong) / len(every)
    return bool((near < len(wrong)).mean() > min(_GATHERED * share, 0.5 + share / 2.0))
