"""What stopping early would save, and cost: ``python -m tools.early_stopping [STORE]``.

The rule that is tried: each pair of extractor and model is scored on a sample of poses of the first
condition, and no further where it is worse than the sample's best pair by a factor. "Worse" is the
median of the ratios of errors, pose by pose, with a one-sided confidence of 99.9 % (an order
statistic). Errors are the record's, of every unit. A miss is a pipeline of a board's first group
that is stopped. Given a store whose stages are kept, it says what the stopped pairs took, and fits
each again, as a fit is needed before any pose is scored.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binom

from algorithms.contract import Floats, UnusableDataError
from algorithms.pipeline import Pipeline
from benchmark.contract import Cell
from benchmark.leaderboard.board import board_of
from benchmark.plan.parts import Parts, installed_parts
from benchmark.progress import terminal_progress
from benchmark.results.samples import CONDITION, datasets, read_directions, read_samples
from benchmark.results.store import Store
from benchmark.running.condition_data import truth
from benchmark.running.kept_stages import FEATURES, PREDICTIONS, TRUTH, KeptStages

#: Poses of a sample and factors that are tried; the pair of which times are told.
POSES, FACTORS, TOLD = (12, 20, 40), (2.0, 5.0, 10.0), (20, 5.0)
_LEVEL, _AVAILABLE, _DRAWS = 1e-3, 0.95, 40

Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Errors:
    """Errors (P, N) of the pairs of a data set on a unit at observable poses; NaN: no answer."""

    cells: list[Cell]
    errors: Floats
    leading: Flags


def boards() -> Iterator[Errors]:
    """Yield the errors of every data set and unit of the record."""
    found = board_of(Store())["datasets"]
    lead = {
        board["name"]: {
            (row["extractor"], row["model"])
            for row in board["rows"]
            if row["condition"] == CONDITION and row["group"] == 1
        }
        for board in found
    }
    for name in datasets():
        seen = read_directions(name)["observable"].to_numpy()
        for unit, rows in read_samples(name).groupby("unit"):
            table = rows.pivot(index=["extractor", "model"], columns="sample", values="error_deg")
            leading = np.array([pair in lead[name] for pair in table.index])
            cells = [Cell(name, CONDITION, *pair, int(unit)) for pair in table.index]
            yield Errors(cells, table.to_numpy(dtype=float)[:, seen], leading)


def stopped(errors: Floats, factor: float) -> Flags:
    """Say which pairs (P,) a sample of errors (P, n) stops."""
    answered = np.isfinite(errors)
    squares = np.where(answered, errors, 0.0) ** 2
    mean = squares.sum(axis=1) / np.maximum(answered.sum(axis=1), 1)
    mean[answered.mean(axis=1) < _AVAILABLE] = np.inf
    if not np.isfinite(mean).any():
        return np.zeros(len(errors), dtype=np.bool_)
    best = errors[np.argmin(mean)]
    ratio = np.divide(errors, best, out=np.full_like(errors, np.inf), where=answered)
    ratio[:, np.isnan(best)] = 0.0
    limit = max(int(binom.ppf(_LEVEL, errors.shape[1], 0.5)) - 1, 0)
    return np.asarray(np.sort(ratio, axis=1)[:, limit] > factor)


def spread(count: int, of: int) -> NDArray[np.intp]:
    """Return the poses of a sample, evenly spaced: those of a flight are in the order of time."""
    return np.arange(count) * of // count


def tried(found: list[Errors], poses: int, factor: float) -> str:
    """Say what a rule stops on the standard units, and what it misses on all."""
    rng = np.random.default_rng(0)
    pairs = ends = leaders = missed = drawn = missed_drawn = 0
    for one in found:
        count = one.errors.shape[1]
        if count <= poses:
            continue
        by_rule = stopped(one.errors[:, spread(poses, count)], factor)
        if one.cells[0].unit == 0:
            pairs, ends = pairs + len(by_rule), ends + int(by_rule.sum())
        leaders, missed = leaders + int(one.leading.sum()), missed + int(by_rule[one.leading].sum())
        for _ in range(_DRAWS):
            sample = one.errors[:, rng.choice(count, poses, replace=False)]
            drawn += int(one.leading.sum())
            missed_drawn += int(stopped(sample, factor)[one.leading].sum())
    return (
        f"{poses} poses, factor {factor:g}: stops {ends} of {pairs} pairs ({ends / pairs:.0%}); of "
        f"the first groups {missed} of {leaders} ({missed / leaders:.2%}), with poses drawn at "
        f"random {missed_drawn} of {drawn} ({missed_drawn / drawn:.3%})"
    )


def seconds(found: list[Errors], directory: Path) -> Iterator[str]:
    """Yield what all kept stages took, and the pairs that the rule stops."""
    store, parts = Store(directory), installed_parts()
    kept = KeptStages.beside(store.work_directory, store.components())
    if kept is None:
        return
    took = kept.files.costs()
    stages = (TRUTH, FEATURES, PREDICTIONS)
    keys = {kept.key(stage, cell) for cell in store.scores() for stage in stages}
    poses, factor = TOLD
    ends = [
        cell
        for one in found
        if one.cells[0].unit == 0 and one.errors.shape[1] > poses
        for cell, stops in zip(
            one.cells,
            stopped(one.errors[:, spread(poses, one.errors.shape[1])], factor),
            strict=True,
        )
        if stops
    ]
    fits = sum(took.get(kept.key(PREDICTIONS, cell), 0.0) for cell in ends)
    yield f"all stages of {directory}: {sum(took.get(key, 0.0) for key in keys):.0f} s"
    yield f"fits and predictions of the {len(ends)} pairs that {poses} poses stop: {fits:.1f} s"
    fit, predict = 0.0, 0.0
    with terminal_progress() as report:
        for done, cell in enumerate(ends, start=1):
            one, other = fit_again(cell, parts, kept)
            fit, predict = fit + one, predict + other
            report(done, len(ends), str(cell.dataset))
    yield f"again: {fit:.1f} s to fit, which remain, {predict:.1f} s to predict all poses"


def fit_again(cell: Cell, parts: Parts, kept: KeptStages) -> tuple[float, float]:
    """Return the seconds that a pair takes to fit and to predict; 0 where features are not kept."""
    features: dict[str, Floats] | None = kept.get(FEATURES, cell)
    if features is None:
        return 0.0, 0.0
    preset, extractor = parts.preset(cell.dataset), parts.extractor(cell.extractor)
    data = truth(preset, cell.condition, kept=kept)
    geometry = preset.geometry_for(cell.condition)
    model: Any = parts.model(cell.model).for_sensor(geometry, extractor.about.kind)
    pipeline = Pipeline(extractor.for_sensor(geometry), model)
    told, *others = (data.splits[name] for name in ("calibration", "test", "repeat"))
    started = time.process_time()
    try:
        pipeline.fit_features(features["calibration"], told.truth, told.context)
    except UnusableDataError:
        return time.process_time() - started, 0.0
    fitted = time.process_time()
    for name, samples in zip(("test", "repeat"), others, strict=True):
        pipeline.predict_features(features[name], samples.context)
    return fitted - started, time.process_time() - fitted


if __name__ == "__main__":
    of_record = list(boards())
    for number in POSES:
        for times in FACTORS:
            sys.stdout.write(tried(of_record, number, times) + "\n")
    for place in sys.argv[1:]:
        for line in seconds(of_record, Path(place)):
            sys.stdout.write(line + "\n")
