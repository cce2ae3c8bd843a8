"""What methods are held to on frames drawn afresh. None of these was changed after measuring."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from tools.bench.verdicts import Verdict

#: The estimator for every point-symmetric spot, as made without a design; that for many spots.
ESTIMATOR, MANY = "mirror", "weighted-spots"

#: Largest error over the bound by kind of set, share of wrong answers on sets of faults, and time
#: over that of OpenCV's loop.
OVER_BOUND = {"symmetric": 1.15, "stray": 2.5}
WRONG = 0.001
OVER_OPENCV = 1.0
#: Spots, and frames, up to which that time is judged.
LONGEST_PX, SIZE_PX = 8.0, 64
#: Largest error over the bound of a large grid over that of the smallest: N^-1/2 within so much.
AVERAGING = 1.15


@dataclass(frozen=True)
class RobustnessResult:
    """One method on one set.

    Attributes
    ----------
    group, set_name, kind, method
        What was measured; ``grid`` is the kind of grids as designed, ``fault`` that of others.
    over_bound
        Root mean square error of an axis, over all answers where there is a spot, over the bound;
        NaN where there is none.
    wrong, missing
        Shares of all frames: answers more than a pixel from the spot, or where there is none; and
        frames without an answer.
    us, over_opencv
        Best time a frame, and over that of the OpenCV loop on the same frames.
    frames
        How many, fewer for a method that takes too long.
    timed
        Whether a limit of time is for this set.
    """

    group: str
    set_name: str
    kind: str
    method: str
    over_bound: float
    wrong: float
    missing: float
    us: float
    over_opencv: float
    frames: int
    timed: bool = False


def verdicts(rows: Sequence[RobustnessResult], ours: Collection[str]) -> list[Verdict]:
    """Return a verdict for each limit whose set and method were measured.

    `ours` names the methods that are not the survey's. Each says of how many frames it is: an error
    of N frames scatters by ``1 / sqrt(4 N)`` of itself.
    """
    found = []
    for row in rows:
        what = f"{row.method} on {row.set_name}"
        if row.group.startswith("grids"):
            what = f"{what}, {row.group}"
        if row.method == ESTIMATOR and row.kind in OVER_BOUND:
            most = OVER_BOUND[row.kind]
            said = f"{what}: error over the bound, {row.frames} frames"
            found.append(Verdict(said, row.over_bound, most))
        if row.method == ESTIMATOR and row.timed:
            found.append(Verdict(f"{what}: time over OpenCV's", row.over_opencv, OVER_OPENCV))
        if row.kind == "fault" and row.method.partition(" ")[0] in ours:
            said = f"{what}: share confidently wrong of {row.frames} frames"
            found.append(Verdict(said, row.wrong, WRONG))
    return found + _averaging(rows)


def _averaging(rows: Sequence[RobustnessResult]) -> list[Verdict]:
    """Return verdicts on whether errors of grids as designed fall as their bounds do."""
    found = []
    first: dict[str, RobustnessResult] = {}
    for row in rows:
        if row.kind != "grid" or row.method != MANY:
            continue
        few = first.setdefault(row.group, row)
        if few is not row:
            what = f"{MANY}, {row.group}: error over the bound, {row.set_name} to {few.set_name}"
            found.append(Verdict(what, row.over_bound / few.over_bound, AVERAGING))
    return found
