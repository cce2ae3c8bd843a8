"""What the methods on the reference frames are held to, and why one cannot be kept."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from tools.bench.verdicts import Verdict

OPENCV = "opencv threshold + moments"


@dataclass(frozen=True)
class Figures:
    """What a limit may be put on, of one method on one set; an error in pixels."""

    error_px: float
    over_bound: float
    over_opencv: float
    frames: int


@dataclass(frozen=True)
class Limit:
    """A largest value of one figure of one method.

    Attributes
    ----------
    method
        As the table names it.
    sets
        The reference sets it is for.
    figure
        Error over the bound, time over that of OpenCV's loop, or error over that of the loop.
    most
        The largest value.
    cannot
        Why the method cannot keep it, where it was measured that it cannot; else empty.
    """

    method: str
    sets: tuple[str, ...]
    figure: Literal["over_bound", "over_opencv", "error_over_opencv"]
    most: float
    cannot: str = ""


_SMALL = ("disc", "gaussian")
_ALL = ("disc", "disc-512", "gaussian")

#: Frames below which an error over the bound scatters too much to be judged.
ENOUGH = 1000

#: Those that were asked for when the sets were drawn up; none was changed after measuring.
LIMITS: tuple[Limit, ...] = (
    Limit("bctm", _SMALL, "over_opencv", 0.15),
    Limit("bctm", ("disc-512",), "over_opencv", 0.25),
    Limit("bctm", _ALL, "error_over_opencv", 1.0),
    *(Limit(name, _ALL, "over_opencv", 0.3) for name in ("bcm", "pm", "dbcm", "ifm")),
    Limit(
        "tm",
        ("disc",),
        "over_bound",
        1.3,
        "of two levels a rim pixel tells only which: without noise 0.048 px, ten times the bound",
    ),
    Limit("tm binarise=no", ("disc",), "over_bound", 1.3),
)

_WORDS = {
    "over_bound": "error over the bound",
    "over_opencv": "time over OpenCV's",
    "error_over_opencv": "error over OpenCV's",
}


def verdicts(measured: Mapping[tuple[str, str], Figures]) -> list[Verdict]:
    """Return a verdict for each limit whose set and method are among the measured.

    None on an error over the bound of fewer than `ENOUGH` frames.
    """
    found = []
    for limit in LIMITS:
        for name in limit.sets:
            row, loop = measured.get((name, limit.method)), measured.get((name, OPENCV))
            if row is None:
                continue
            if limit.figure == "over_bound":
                if row.frames < ENOUGH:
                    continue
                value = row.over_bound
            elif limit.figure == "over_opencv":
                value = row.over_opencv
            elif loop is not None:
                value = row.error_px / loop.error_px
            else:
                continue
            what = f"{limit.method} on {name}: {_WORDS[limit.figure]}"
            found.append(Verdict(what, value, limit.most, limit.cannot))
    return found


#: Read noise of the disc's low and high end, e-: twenty to one.
NOISE_RANGE_E = (1.0, 20.0)


def over_noise(method: str, errors: Sequence[float]) -> Verdict:
    """Return the verdict on a template's errors at both ends of `NOISE_RANGE_E`, on the disc."""
    low, high = errors
    ends = f"{NOISE_RANGE_E[1]:g} over {NOISE_RANGE_E[0]:g} e- of read noise"
    return Verdict(f"{method} on disc: error at {ends}", high / low, 1.5)
