"""`calibrate`: from files of readings and directions to a model, its verdict and its limits."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from algorithms.angles import separation_deg
from algorithms.chain import Scored
from algorithms.contract import Floats, Model, SensorGeometry, UnusableDataError
from api.calibrate.ambiguity import folded
from api.calibrate.conventions import Finding, change_of, findings
from api.calibrate.readings import Readings, joined, readings_of
from api.calibrate.robust import normalised, wrong_poses
from api.calibrate.roles import guess
from api.calibrate.runs import RunOffset, off_runs
from api.calibrate.selection import (
    Candidate,
    applicable,
    choose,
    compare,
    deviation_of,
    fitted,
    fold_of,
    geometry_of,
    unbounded,
)
from api.calibrate.settings import Settings
from api.calibrate.table import Table, TableError, read_table
from api.calibrate.uncertainty import (
    Intervals,
    intervals,
    noise_deg,
    refits,
    spread_deg,
)
from api.calibrate.verdict import Verdict, judge, next_poses, patterns_in, with_doubt
from files.reading import read_bytes

#: Residuals of samples left out, over their robust scale, that list a sample as wrong after all.
_WRONG_OF_MODEL = 8.0
#: And below which a sample that no smooth map explains is taken back.
_RIGHT_OF_MODEL = 4.0
#: Share of samples that may be wrong, and samples from which they are looked for.
_MOST_WRONG, _FEWEST_FOR_WRONG = 0.25, 40
#: Directions that lie this near to one plane through the sensor are those of one axis.
_ONE_AXIS = 0.02
#: RMS over the directions' own spread from which a model explains no more than chance does.
_CHANCE = 0.5
#: Samples a final fit is made of at most; more are thinned evenly.
MOST_FITTED = 40_000


@dataclass(frozen=True)
class Excluded:
    """A sample that was left out of the fit.

    Attributes
    ----------
    source : str
        Its run.
    row : int
        In its file.
    reason : str
    """

    source: str
    row: int
    reason: str


@dataclass(frozen=True)
class Calibration:
    """All that a calibration found.

    Attributes
    ----------
    settings : Settings
        As used, applied changes among them.
    findings : tuple of Finding
        Conventions that the file seems to follow, those applied included.
    applied : tuple of Finding
        Of them those that were.
    readings : Readings
        Samples that were fitted.
    excluded : tuple of Excluded
        Samples left out, with the reason.
    off_runs : tuple of RunOffset
        Runs off by a constant, left out.
    fold_deg : float or None
        Smallest off-axis angle of samples whose reading another direction gives too; left out.
    geometry : SensorGeometry
        The drawing as the models were told.
    candidates : tuple of Candidate
        Every model tried, the smallest error first.
    chosen : Candidate
    why : str
        It was chosen.
    model : Model
        Fitted to all samples.
    residual_deg, noise_deg : float
        RMS of samples fitted, and of single samples' noise.
    intervals : Intervals or None
        None where samples are too few.
    spread_deg : ndarray, shape (N,)
        Of the fit itself at each sample, by refits with other noise.
    verdict : Verdict
    digest : str
        SHA-256 of the files, 32 digits.
    sources : tuple of str
        Names of the files.
    """

    settings: Settings
    findings: tuple[Finding, ...]
    applied: tuple[Finding, ...]
    readings: Readings
    excluded: tuple[Excluded, ...]
    off_runs: tuple[RunOffset, ...]
    fold_deg: float | None
    geometry: SensorGeometry
    candidates: tuple[Candidate, ...]
    chosen: Candidate
    why: str
    model: Model
    residual_deg: float
    noise_deg: float
    intervals: Intervals | None
    spread_deg: Floats
    verdict: Verdict
    digest: str
    sources: tuple[str, ...]

    def deviation_deg(self, features: Floats, context: dict[str, Floats] | None = None) -> Floats:
        """Return the 1-sigma (N,) of a tangent axis at features (N, F), degrees."""
        stated = deviation_of(self.model, features, context or {})
        return stated * (1.0 if self.intervals is None else self.intervals.factor)


def calibrate(  # noqa: PLR0915 - the steps in their order
    paths: Sequence[Path],
    settings: Settings | None = None,
    *,
    apply: bool = False,
    thorough: bool = False,
    models: Sequence[str] | None = None,
    progress: Callable[[str, int, int], None] = lambda *_: None,
) -> Calibration:
    """Calibrate a sensor by a file of a turntable, or by several files of one sensor, each a run.

    Parameters
    ----------
    paths : sequence of Path
        Of files as `api.calibrate.table.read_table` takes them.
    settings : Settings, optional
        What their columns are; guessed from their names otherwise.
    apply : bool
        Whether conventions that were found beyond doubt are applied.
    thorough : bool
        Whether networks are tried too, which takes minutes.
    models : sequence of str, optional
        Only these, such as ``"polynomial-2d"``.
    progress : callable
        Told the step, how many are done and how many there are.

    Returns
    -------
    Calibration

    Raises
    ------
    TableError
        If a file is none, or lacks a column.
    UnusableDataError
        If the samples settle no model; the message says what would.
    """
    tables = [read_table(path) for path in paths]
    stated = settings or guess(tables[0])
    readings = joined([readings_of(table, stated) for table in tables])
    progress("conventions", 0, 1)
    _require_two_axes(readings)
    found = findings(readings, stated)
    applied: list[Finding] = []
    while apply and len(applied) < 4:
        certain = next((one for one in found if one.certain and one.change), None)
        if certain is None:
            break
        stated = change_of(stated, certain)
        applied.append(certain)
        readings = joined([readings_of(table, stated) for table in tables])
        found = findings(readings, stated)
    sound, excluded, runs, fold = _sound(readings)
    _require_two_axes(sound)
    readings = sound
    if len(sound) >= _FEWEST_FOR_WRONG:
        wrong = wrong_poses(sound.features, sound.sun, 3.0 * stated.bench.floor_deg)
        readings = sound.only(~wrong)
    geometry = geometry_of(readings, stated)
    known = applicable(readings, geometry, thorough=thorough)
    wanted = {n: s for n, s in known.items() if models is None or n in models}
    if models is not None and (unknown := sorted(set(models) - set(known))):
        raise UnusableDataError(
            f"no model {', '.join(unknown)} reads {readings.kind} of this file (there are "
            f"{', '.join(known)})"
        )
    count = 0

    def tick(name: str) -> None:
        nonlocal count
        progress(name, count, len(wanted) + 3)
        count += 1

    candidates = [_explained(one, readings) for one in compare(readings, geometry, wanted, tick)]
    candidates.sort(key=lambda one: (bool(one.refused), one.missing > 0.05, one.rms_deg))
    chosen, why = choose(candidates)
    kept = _kept_by_model(wanted[chosen.name], chosen, sound, readings, geometry)
    changed = not np.array_equal(sound.rows[kept], readings.rows)
    readings = sound.only(kept)
    excluded += _excluded(~kept, "wrong pose", sound)
    if changed:
        again = _explained(
            compare(readings, geometry, {chosen.name: wanted[chosen.name]})[0], readings
        )
        if not again.refused:
            candidates = [again if one.name == again.name else one for one in candidates]
            chosen = again
    tick("fit")
    thinned = readings.only(np.arange(0, len(readings), max(-(-len(readings) // MOST_FITTED), 1)))
    model = fitted(wanted[chosen.name], thinned, geometry)
    offsets = model.predict(readings.features, readings.context) - readings.sun
    residual = _rms(separation_deg(offsets + readings.sun, readings.sun))
    noise = noise_deg(offsets, readings.sun)
    tick("uncertainty")
    sample = readings.only(np.arange(0, len(readings), max(len(readings) // 2000, 1)))
    ratio, spread = _split(wanted[chosen.name], sample, geometry, noise, readings)
    compared = readings.only(np.arange(0, len(readings), _step(readings, chosen)))
    patterns = patterns_in(np.asarray(chosen.offsets), compared)
    verdict = judge(
        chosen.rms_deg, residual, noise, stated.bench.floor_deg, ratio, patterns,
        *next_poses(readings.sun),
    )  # fmt: skip
    if doubt := next((one for one in found if one.certain and one.change), None):
        verdict = with_doubt(verdict, doubt.found)
    progress("done", len(wanted) + 3, len(wanted) + 3)
    return Calibration(
        stated, (*applied, *found), tuple(applied), readings, tuple(excluded), tuple(runs), fold,
        geometry, tuple(candidates), chosen, why, model, residual, noise,
        intervals(chosen, readings), spread, verdict, _digest(paths), tuple(p.name for p in paths),
    )  # fmt: skip


def _sound(readings: Readings) -> tuple[Readings, list[Excluded], list[RunOffset], float | None]:
    """Leave out runs that are off, and what lies beyond a fold."""
    excluded: list[Excluded] = []
    runs = off_runs(readings)
    for one in runs:
        bad = readings.run == one.run
        excluded += _excluded(bad, f"run off by {one.offset_deg:.2f} deg", readings)
        readings = readings.only(~bad)
    bad = folded(readings.features, readings.sun)
    fold = None
    if bad.any():
        fold = float(np.degrees(np.arccos(np.clip(readings.sun[bad, 2], -1.0, 1.0)).min()))
        excluded += _excluded(bad, "reading that another direction gives too", readings)
        readings = readings.only(~bad)
    return readings, excluded, runs, fold


def _excluded(bad: NDArray[np.bool_], reason: str, among: Readings) -> list[Excluded]:
    return [
        Excluded(among.run_names[among.run[at]], int(among.rows[at]), reason)
        for at in np.flatnonzero(bad)
    ]


def _require_two_axes(readings: Readings) -> None:
    size = np.linalg.svd(readings.sun, compute_uv=False)
    if len(readings) < 3 or size[2] < _ONE_AXIS * size[1]:
        raise UnusableDataError(
            f"the {len(readings)} poses lie along one axis: a second axis would settle the "
            "calibration (turn the sensor by 90 deg about its boresight, or sweep the other "
            "gimbal, and add the rows)"
        )


def _explained(candidate: Candidate, readings: Readings) -> Candidate:
    """Refuse a candidate that explains no more of where the light was than chance does."""
    middle = readings.sun.mean(axis=0)
    spread = float(np.degrees(np.sqrt(np.mean(((readings.sun - middle) ** 2).sum(axis=1)))))
    if candidate.refused or candidate.rms_deg <= _CHANCE * spread:
        return candidate
    return Candidate(
        candidate.name,
        refused=f"errs {candidate.rms_deg:.3g} deg where directions spread over {spread:.3g} deg: "
        "readings and directions do not belong together",
    )


def _kept_by_model(
    scored: Scored, chosen: Candidate, sound: Readings, readings: Readings, geometry: SensorGeometry
) -> NDArray[np.bool_]:
    """Return which sound samples (N,) the chosen model explains; those it cannot answer stay.

    What no smooth map explained may be what only this model explains, and the other way round.
    """
    model = unbounded(fitted(scored, readings, geometry))
    errors = separation_deg(model.predict(sound.features, sound.context), sound.sun)
    inside = np.isin(_places(sound), _places(readings))
    left_out = chosen.errors
    if left_out is not None and len(left_out) == len(readings):
        known = np.isfinite(left_out)
        at = np.flatnonzero(inside)[known]
        errors[at] = left_out[known]
    usual = 1.4826 * np.maximum(
        float(np.nanmedian(errors[inside])), _around(sound.features, inside, errors)
    )
    kept = errors <= np.where(inside, _WRONG_OF_MODEL, _RIGHT_OF_MODEL) * usual
    kept |= ~np.isfinite(errors) & inside
    return inside if kept.mean() < 1.0 - _MOST_WRONG else kept


def _around(features: Floats, inside: NDArray[np.bool_], errors: Floats) -> Floats:
    """Return the median error (N,) of the samples inside that are nearest in features."""
    from scipy.spatial import cKDTree  # noqa: PLC0415 - SciPy, at the first use

    used = normalised(features)
    used = used / np.maximum(used.std(axis=0), 1e-12)
    known = np.flatnonzero(inside & np.isfinite(errors))
    near = np.asarray(cKDTree(used[known]).query(used, k=min(12, len(known)))[1])
    return np.asarray(np.median(errors[known][near.reshape(len(used), -1)], axis=1))


def _places(readings: Readings) -> NDArray[np.int64]:
    return readings.run * np.int64(10_000_000) + readings.rows


def _split(
    scored: Scored, sample: Readings, geometry: SensorGeometry, noise: float, readings: Readings
) -> tuple[float, Floats]:
    """Return the split-half ratio, and the fit's own spread at each sample."""
    nothing = np.full(len(readings), np.nan)
    if not noise > 0:
        return float("nan"), nothing
    fold, _ = fold_of(sample)
    first = np.where(fold < 0, np.arange(len(fold)) % 2 == 0, fold % 2 == 0)
    try:
        one = fitted(scored, sample.only(first), geometry).predict(sample.features, sample.context)
        two = fitted(scored, sample.only(~first), geometry).predict(sample.features, sample.context)
        spreads = [
            spread_deg(refits(scored, sample.only(half), geometry, noise, sample))
            for half in (first, ~first)
        ]
        whole = spread_deg(refits(scored, sample, geometry, noise, readings))
    except UnusableDataError:
        return float("nan"), nothing
    apart = separation_deg(one, two)
    expected = np.hypot(*spreads)
    known = np.isfinite(apart) & np.isfinite(expected)
    if not (known & (expected > 1e-9)).any():  # a model of no parameters
        return float("nan"), whole
    ratio = np.sqrt(np.mean(apart[known] ** 2) / max(float(np.mean(expected[known] ** 2)), 1e-300))
    return float(ratio), whole


def _step(readings: Readings, chosen: Candidate) -> int:
    count = len(np.asarray(chosen.offsets))
    return max(-(-len(readings) // count), 1)


def _rms(errors: Floats) -> float:
    known = errors[np.isfinite(errors)]
    return float(np.sqrt(np.mean(known**2))) if len(known) else float("nan")


def _digest(paths: Sequence[Path]) -> str:
    state = hashlib.sha256()
    for path in paths:
        state.update(read_bytes(path, 512 * 1024 * 1024))
    return state.hexdigest()[:32]


__all__ = ["Calibration", "Excluded", "Table", "TableError", "calibrate", "folded"]
