"""The verdict on a calibration, and what to do next."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from algorithms.angles import separation_deg
from algorithms.contract import Floats, UnusableDataError
from calibrate.halves import Halves
from calibrate.places import hull_of_poses
from calibrate.readings import Readings
from calibrate.robust import nearest
from calibrate.uncertainty import NORMAL_95, tangent_offsets

Word = Literal["good", "model misfit", "poses missing", "conventions uncertain"]
#: Ratio of the difference of two halves' fits to their stated uncertainties that is a misfit, if
#: noise alone has a smaller chance than this to make it.
_RATIO, _RATIO_CHANCE = 2.0, 1e-3
#: Share of the residuals' variance that a pattern explains to be named, and its significance.
_SHARE, _CHANCE = 0.05, 1e-4
#: Error of samples fitted over that of samples left out, or their noise, that no sound fit has.
_BEYOND = 2.0
#: Named beside the others, and no misfit: a bench and a sensor may be worse at the edge.
GROWING = "the angle off the boresight: the size of errors grows with it"
#: Patterns that neighbouring poses share; others, as a drift, are in what neighbours differ by, and
#: the noise told by them holds the pattern.
_OF_PLACE = ("the direction", "the fraction", GROWING)
_NEXT = 20
#: Steps between poses from which a hole in the field is said.
_GAP = 5.0


@dataclass(frozen=True)
class Pattern:
    """A pattern left in the residuals."""

    name: str  # what the residuals go with
    share: float  # of their variance; of the variance of sizes' ranks for `GROWING`
    chance: float  # that residuals without it would go with it as much


@dataclass(frozen=True)
class Verdict:
    """What a calibration is worth."""

    word: Word
    reason: str  # in one or two sentences
    split_ratio: float  # of fits to two halves, over their uncertainties added
    patterns: tuple[Pattern, ...]  # left in errors of samples left out, the largest first
    next_poses: Floats  # (20, 3), directions that would add most
    untested: tuple[str, ...] = ()  # causes that the file cannot show, each with what would
    parts: tuple[Part, ...] = ()  # of the samples left out, the least covered first


def judge(  # noqa: PLR0917 - the numbers it is made of
    rms_deg: float,
    residual_deg: float,
    noise: float,
    floor_deg: float,
    split: Halves,
    patterns: tuple[Pattern, ...],
    next_poses: Floats,
    gap: float,
) -> Verdict:
    """Return the verdict.

    Errors are RMS, degrees: of samples left out, of those fitted, of single samples' noise, and of
    the bench's directions. `gap` is the largest distance of a direction of the field to a pose, in
    usual steps, `next_poses` what to take where poses are missing.
    """
    floor = np.hypot(noise if np.isfinite(noise) else 0.0, floor_deg)
    apart = split.ratio > _RATIO and split.chance < _RATIO_CHANCE
    smooth = [one for one in patterns if one.share > 0.25 and one.name != GROWING]
    drifts = [one for one in smooth if not one.name.startswith(_OF_PLACE)]
    if not residual_deg <= _BEYOND * max(rms_deg, floor):
        word: Word = "model misfit"
        reason = (
            f"samples fitted err {residual_deg:.3g} deg, more than those left out, which err "
            f"{rms_deg:.3g} deg: the fit does not answer its own samples"
        )
    elif rms_deg > 1.6 * residual_deg and rms_deg > 1.3 * floor:
        word = "poses missing"
        reason = (
            f"samples left out err {rms_deg:.3g} deg, those fitted {residual_deg:.3g} deg: "
            "there are too few poses for this model, or too far apart"
        )
    elif gap > _GAP:
        word = "poses missing"
        reason = (
            f"parts of the field are {gap:.0f} steps from any pose: there the model is not tested "
            f"(where it is, samples left out err {rms_deg:.3g} deg)"
        )
    elif apart or (smooth and residual_deg > 1.5 * floor):
        word = "model misfit"
        reason = (
            f"fits to two halves differ {split.ratio:.2g} times as much as noise explains"
            if apart
            else f"residuals of {residual_deg:.3g} deg are more than the noise of {floor:.3g} deg"
        ) + (f", and go with {smooth[0].name}" if smooth else "")
    elif drifts:
        word = "model misfit"
        reason = (
            f"{100 * drifts[0].share:.0f} % of the residuals' variance, which is "
            f"{residual_deg:.3g} deg RMS, goes with {drifts[0].name}"
        )
    else:
        word = "good"
        reason = (
            f"samples left out err {rms_deg:.3g} deg, those fitted {residual_deg:.3g} deg, "
            f"noise is {floor:.3g} deg"
        )
    return Verdict(word, reason, split.ratio, patterns, next_poses)


def with_uncertain_conventions(verdict: Verdict, found: str) -> Verdict:
    """Return a verdict that is good only if the file's conventions are as stated after all.

    `found` is the convention that the file seems to follow instead, in a sentence.
    """
    reason = f"{found}: apply that or state it; as stated, {verdict.reason}"
    return replace(verdict, word="conventions uncertain", reason=reason)


def withheld(verdict: Verdict, doubt: str, parts: tuple[Part, ...]) -> Verdict:
    """Return a verdict that is not good where rows are missing for no cause, or intervals fail.

    `doubt` is what speaks against it, as rows left out without a known cause, in a sentence; or
    empty.
    """
    bad = uncovered(parts)
    said = doubt or (
        f"95 % intervals hold {100 * bad.coverage:.0f} % of the errors at {bad.name} "
        f"({bad.samples} samples)"
        if bad
        else ""
    )
    known = replace(verdict, parts=parts)
    if not said or verdict.word == "conventions uncertain":
        return known
    if verdict.word == "good":
        return replace(known, word="model misfit", reason=f"{said}; {verdict.reason}")
    return replace(known, reason=f"{verdict.reason}; {said}")


def patterns_in(offsets: Floats, readings: Readings) -> tuple[Pattern, ...]:
    """Return what errors (N, 3) of samples go with, the largest share first."""
    known = np.asarray(np.isfinite(offsets).all(axis=1))
    used = readings.only(known)
    if len(used) < 40:
        return ()
    errors = tangent_offsets(offsets[known], used.sun)
    designs: dict[str, Floats] = {}
    if len(np.unique(used.run)) > 1:
        designs["the run: an offset of its own in some"] = np.eye(len(readings.run_names))[used.run]
    for name, word in (("time_s", "time"), ("temperature_K", "temperature")):
        if name in used.context and np.ptp(used.context[name]) > 0:
            designs[f"{word}: a drift"] = _powers(used.context[name], 1)
    if (warmer := designs.get("temperature: a drift")) is not None:
        designs["temperature and direction: a scale or turn"] = warmer * (
            used.sun - used.sun.mean(axis=0)
        )
    designs["the order of rows: a drift"] = _powers(np.arange(len(used), dtype=np.float64), 1)
    designs["the direction: a smooth pattern over the field"] = _surface(used.sun)
    if used.features.shape[1] == 2:
        phase = 2.0 * np.pi * used.features
        if np.ptp(used.features) > 20.0:
            designs["the fraction of a pixel"] = np.column_stack([np.sin(phase), np.cos(phase)])
    found = [_pattern(name, design, errors) for name, design in designs.items()]
    found.append(_growth(errors, used.sun))
    named = [one for one in found if one and one.share > _SHARE and one.chance < _CHANCE]
    return tuple(sorted(named, key=lambda one: -one.share))


def next_poses(sun: Floats, count: int = _NEXT) -> tuple[Floats, float]:
    """Return directions (count, 3) inside the field measured that lie farthest from any pose.

    And the distance of the first, in usual steps between poses.
    """
    try:
        hull = hull_of_poses(sun)
    except UnusableDataError:
        return np.empty((0, 3)), 0.0
    turns = np.arange(4000)
    z = 1.0 - 2.0 * (turns + 0.5) / len(turns)
    angle = np.pi * (1.0 + 5.0**0.5) * turns
    grid = np.column_stack(
        [np.sqrt(1 - z**2) * np.cos(angle), np.sqrt(1 - z**2) * np.sin(angle), z]
    )
    middle = sun.mean(axis=0)
    reach = float(np.max(separation_deg(sun, np.broadcast_to(middle, sun.shape))))
    if np.linalg.norm(middle) > 0.05 and reach < 80.0:  # a denser grid of a narrow field
        middle = middle / np.linalg.norm(middle)
        radius = np.radians(reach) * np.sqrt((turns + 0.5) / len(turns))
        flat = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
        first = np.cross(middle, [0.0, 1.0, 0.0] if abs(middle[1]) < 0.9 else [1.0, 0.0, 0.0])
        first /= np.linalg.norm(first)
        grid = middle + flat[:, [0]] * first + flat[:, [1]] * np.cross(middle, first)
        grid /= np.linalg.norm(grid, axis=1)[:, None]
    inside = grid[hull.holds(grid)] if len(hull.facets) else grid
    if not len(inside):
        return np.empty((0, 3)), 0.0
    # poses nearer to each other than a hundredth of the field are one, as repeats are
    cell = max(2.0 * np.sin(np.radians(min(reach, 180.0)) / 2.0), 1e-6) / 50.0
    poses = np.unique(np.round(sun / cell), axis=0) * cell
    step = float(np.median(nearest(poses, poses, 2)[0][:, 1]))
    away = nearest(poses, inside, 1)[0]
    gap = float(away.max()) / max(step, 1e-9)
    chosen = []
    for _ in range(min(count, len(inside))):
        at = int(np.argmax(away))
        chosen.append(inside[at])
        away = np.minimum(away, np.linalg.norm(inside - inside[at], axis=1))
    return np.array(chosen), gap


def _pattern(name: str, design: Floats, errors: Floats) -> Pattern | None:
    from scipy.special import fdtrc  # noqa: PLC0415 - SciPy, at the first use

    count = len(errors)
    centred = errors - errors.mean(axis=0)
    columns = np.column_stack([np.ones(count), design])
    rank = int(np.linalg.matrix_rank(columns)) - 1
    if rank < 1 or count <= rank + 2:
        return None
    left = centred - columns @ np.linalg.lstsq(columns, centred, rcond=1e-10)[0]
    total, rest = float((centred**2).sum()), float((left**2).sum())
    if not total > 0:
        return None
    share = 1.0 - rest / total
    expected = rank / (count - 1)  # of errors that go with nothing
    ratio = (total - rest) / rank / max(rest / (count - rank - 1), 1e-300)
    axes = errors.shape[1]
    chance = float(fdtrc(axes * rank, axes * (count - rank - 1), ratio))
    return Pattern(name, max(share - expected, 0.0), chance)


def _growth(errors: Floats, sun: Floats) -> Pattern | None:
    """Say whether errors (N, 2) are larger away from the boresight."""
    from scipy.stats import rankdata  # noqa: PLC0415 - SciPy, at the first use

    off = np.arccos(np.clip(sun[:, 2], -1.0, 1.0))
    rank = rankdata(np.linalg.norm(errors, axis=1))  # a few large errors decide nothing
    if np.cov(off, rank)[0, 1] <= 0.0:
        return None
    return _pattern(GROWING, _powers(off, 2), rank[:, None])


def _powers(column: Floats, degree: int) -> Floats:
    scaled = (column - column.mean()) / max(float(np.ptp(column)), 1e-12)
    return np.column_stack([scaled**power for power in range(1, degree + 1)])


def _surface(sun: Floats) -> Floats:
    x, y = sun[:, 0], sun[:, 1]
    return np.column_stack([x**a * y**b for a in range(5) for b in range(5 - a) if a + b > 0])


def as_text(verdict: Verdict) -> Mapping[str, object]:
    """Return the verdict as plain data."""
    return {
        "verdict": verdict.word,
        "reason": verdict.reason,
        "split_half_ratio": None
        if not np.isfinite(verdict.split_ratio)
        else round(verdict.split_ratio, 3),
        "patterns": [vars(one) for one in verdict.patterns],
        "untested": list(verdict.untested),
        "parts": [vars(one) for one in verdict.parts],
        "next_poses": [[round(float(c), 4) for c in pose] for pose in verdict.next_poses],
    }


#: Share of errors that 95 % intervals must hold in each part, and the chance, over all parts, that
#: a part of a sound calibration fails.
COVERED, _CHANCE_OF_PARTS = 0.90, 0.01
#: Samples of a part from which it is judged, parts of each kind, and most runs.
_FEWEST, _PARTS, _MOST_RUNS = 20, 5, 40
_SECTORS = 6


@dataclass(frozen=True)
class Part:
    """A part of the samples left out."""

    name: str
    samples: int
    coverage: float  # share of errors, along two axes each, within the 95 % interval
    chance: float  # that so few are within it where it holds 95 %


def parts_of(readings: Readings, along: Floats, sigma_deg: Floats) -> tuple[Part, ...]:
    """Return parts of the field, of time, of the light and of runs, the worst covered first.

    Of samples left out, by their errors (N, 2) along two axes, degrees, NaN where not answered, and
    the stated 1-sigma (N, 2) of each.
    """
    from scipy.stats import binom  # noqa: PLC0415 - SciPy, at the first use

    known = np.asarray(np.isfinite(along + sigma_deg).all(axis=1))
    used = readings.only(known)
    within = np.abs(along[known]) <= NORMAL_95 * sigma_deg[known]
    found = []
    for name, part in _splits(used):
        count = int(part.sum())
        if count < _FEWEST:
            continue
        held = int(within[part].sum())
        chance = float(binom.cdf(held, 2 * count, 0.95))
        found.append(Part(name, count, held / (2 * count), chance))
    return tuple(sorted(found, key=lambda one: one.coverage))


def uncovered(parts: tuple[Part, ...]) -> Part | None:
    """Return the part that intervals hold least, if that is significantly less than 90 %."""
    limit = _CHANCE_OF_PARTS / max(len(parts), 1)
    bad = [one for one in parts if one.coverage < COVERED and one.chance < limit]
    return min(bad, key=lambda one: one.coverage, default=None)


def _splits(readings: Readings) -> Iterator[tuple[str, NDArray[np.bool_]]]:
    order = np.argsort(np.lexsort((readings.rows, readings.run)))
    yield from _bins("rows", readings.rows, order)
    middle = readings.sun.mean(axis=0)
    axis = np.array([0.0, 0.0, 1.0]) if middle[2] > 0.3 else _unit(middle)
    off = np.degrees(np.arccos(np.clip(readings.sun @ axis, -1.0, 1.0)))
    yield from _bins("off-axis angles, deg,", off, off)
    across = readings.sun - (readings.sun @ axis)[:, None] * axis
    turn = np.degrees(np.arctan2(across[:, 1], across[:, 0])) % 360.0
    width = 360.0 / _SECTORS
    for at in range(_SECTORS):
        low, high = at * width, (at + 1) * width
        yield f"azimuths of {low:.0f} to {high:.0f} deg", (turn >= low) & (turn < high)
    if readings.raw.shape[1] > 2:
        total = readings.raw.sum(axis=1)
        yield from _bins("light levels", total, total)
    for name, column in readings.context.items():
        yield from _bins(name, column, column)
    numbers = np.unique(readings.run)
    if 1 < len(numbers) <= _MOST_RUNS:
        for number in numbers:
            yield f"run {readings.run_names[number]}", readings.run == number


def _bins(
    name: str, values: Floats | NDArray[np.int64], order: Floats | NDArray[np.int64]
) -> Iterator[tuple[str, NDArray[np.bool_]]]:
    """Yield parts of as many samples, by the order of a quantity, named by its range."""
    if np.ptp(order) == 0:
        return
    rank = np.argsort(np.argsort(order, kind="stable"), kind="stable")
    part = rank * _PARTS // len(order)
    for at in range(_PARTS):
        inside = part == at
        if inside.any():
            yield f"{name} {values[inside].min():.4g} to {values[inside].max():.4g}", inside


def _unit(vector: Floats) -> Floats:
    length = float(np.linalg.norm(vector))
    return vector / length if length > 0 else np.array([0.0, 0.0, 1.0])
