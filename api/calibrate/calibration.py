"""`calibrate`: from files of readings and directions to a model, its verdict and its limits."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from algorithms.angles import separation_deg
from algorithms.chain import Scored
from algorithms.contract import Floats, Model, SensorGeometry, UnusableDataError
from api.calibrate.conventions.finding import Finding, change_of
from api.calibrate.conventions.findings import findings
from api.calibrate.exclusions import Excluded, excluded_of, kept_by_model, sound_of
from api.calibrate.frames import of_spots, table_in, with_spots
from api.calibrate.halves import halves
from api.calibrate.readings import BEHIND, Readings, joined, readings_of
from api.calibrate.robust import wrong_poses
from api.calibrate.roles import understood
from api.calibrate.runs import RunOffset
from api.calibrate.selection import (
    Candidate,
    applicable,
    choose,
    compare,
    deviation_of,
    fitted,
    geometry_of,
)
from api.calibrate.settings import Settings
from api.calibrate.table import Table, read_table
from api.calibrate.uncertainty import (
    Intervals,
    intervals,
    noise_around,
    noise_deg,
    refits,
    spread_deg,
)
from api.calibrate.verdict import (
    Verdict,
    judge,
    next_poses,
    patterns_in,
    with_uncertain_conventions,
)
from files.reading import read_bytes

#: Samples from which wrong poses are looked for.
_FEWEST_FOR_WRONG = 40
#: Directions that lie this near to one plane through the sensor are those of one axis.
_ONE_AXIS = 0.02
#: RMS over the directions' own spread from which a model explains no more than chance does.
_CHANCE = 0.5
#: Share of rows with the light behind the sensor from which the angles' own form is uncertain.
_MANY_BEHIND = 0.05
#: Median error over the smallest up to which models are compared again without wrong poses.
_CONTENDERS = 1.5
#: Samples a final fit is made of at most; more are thinned evenly.
MOST_FITTED = 40_000


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
        The drawing as given to the models.
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
    notes : tuple of str
        On how the files and pictures were read.
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
    notes: tuple[str, ...] = ()

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
        Of files as `api.calibrate.table.read_table` takes them, or of directories of pictures with
        one such table each.
    settings : Settings, optional
        What their columns are; guessed from their names otherwise.
    apply : bool
        Whether conventions that were found with certainty are applied.
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
    paths = [table_in(path) if path.is_dir() else path for path in paths]
    tables = [read_table(path, settings.file if settings else None) for path in paths]
    stated, notes = _stated(tables, settings)
    tables, stated, said = _with_frames(tables, stated, paths, progress)
    notes += said
    progress("conventions", 0, 1)
    swept = joined([readings_of(table, stated) for table in tables])
    if one_plane(swept):
        return _of_one_axis(swept, stated, paths, notes)
    readings, found = _read(tables, stated)
    applied: list[Finding] = []
    while apply and len(applied) < 4:
        certain = next((one for one in found if one.certain and one.change), None)
        if certain is None:
            break
        stated = change_of(stated, certain)
        applied.append(certain)
        readings, found = _read(tables, stated)
    sound, excluded, runs, fold = sound_of(readings)
    if one_plane(sound):
        return _of_one_axis(sound, stated, paths, notes)
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
    candidates.sort(key=_by_error)
    chosen, why = choose(candidates)
    kept = kept_by_model(wanted[chosen.name], chosen, sound, readings, geometry)
    changed = not np.array_equal(sound.rows[kept], readings.rows)
    readings = sound.only(kept)
    excluded += excluded_of(~kept, "wrong pose", sound)
    if changed:  # a wrong pose that was not seen may have misled the choice
        near = [one.name for one in candidates if _near(one, candidates)]
        again = {
            one.name: _explained(one, readings)
            for one in compare(readings, geometry, {name: wanted[name] for name in near})
        }
        candidates = [again.get(one.name, one) for one in candidates]
        candidates.sort(key=_by_error)
        chosen, why = choose([one for one in candidates if one.name in again])
    tick("fit")
    thinned = readings.only(np.arange(0, len(readings), max(-(-len(readings) // MOST_FITTED), 1)))
    model = fitted(wanted[chosen.name], thinned, geometry)
    offsets = model.predict(readings.features, readings.context) - readings.sun
    residual = _rms(separation_deg(offsets + readings.sun, readings.sun))
    noise = noise_deg(offsets, readings.sun)
    tick("uncertainty")
    sample = readings.only(np.arange(0, len(readings), max(len(readings) // 2000, 1)))
    around = noise_around(model.predict(sample.features, sample.context) - sample.sun, sample.sun)
    spread = _fit_spread(wanted[chosen.name], sample, geometry, around, readings)
    split = halves(wanted[chosen.name], sample, geometry, around)
    compared = readings.only(np.arange(0, len(readings), _step(readings, chosen)))
    patterns = patterns_in(np.asarray(chosen.offsets), compared)
    verdict = judge(
        chosen.rms_deg, residual, noise, stated.bench.floor_deg, split, patterns,
        *next_poses(readings.sun),
    )  # fmt: skip
    if uncertain := next((one for one in found if one.certain and one.change), None):
        verdict = with_uncertain_conventions(verdict, uncertain.found)
    progress("done", len(wanted) + 3, len(wanted) + 3)
    return Calibration(
        stated, (*applied, *found), tuple(applied), readings, tuple(excluded), tuple(runs), fold,
        geometry, tuple(candidates), chosen, why, model, residual, noise,
        intervals(chosen, readings), spread, verdict, _digest(paths), tuple(p.name for p in paths),
        tuple(notes),
    )  # fmt: skip


def _stated(tables: Sequence[Table], settings: Settings | None) -> tuple[Settings, list[str]]:
    """Return settings, guessed where none are stated, and how files and columns were read."""
    notes = list(dict.fromkeys(note for table in tables for note in table.notes))
    if settings is not None:
        return settings, notes
    guessed = understood(tables[0])
    return guessed.settings, [*notes, *guessed.notes]


def _with_frames(
    tables: Sequence[Table],
    settings: Settings,
    paths: Sequence[Path],
    progress: Callable[[str, int, int], None],
) -> tuple[list[Table], Settings, list[str]]:
    """Return tables with the spots of their pictures, if they name any, and what was done."""
    if settings.readings.kind != "frames":
        return list(tables), settings, []
    made, notes = [], []
    for table, path in zip(tables, paths, strict=True):
        measured, said = with_spots(
            table, path.parent, settings, lambda done, all_: progress("frames", done, all_)
        )
        made.append(measured)
        notes += said
    return made, of_spots(settings), notes


def _read(tables: Sequence[Table], settings: Settings) -> tuple[Readings, list[Finding]]:
    """Return the samples of all tables, and what their conventions seem to be."""
    readings = joined([readings_of(table, settings) for table in tables])
    every = None
    if readings.dropped.get(BEHIND, 0) > _MANY_BEHIND * len(readings):
        every = joined([readings_of(table, settings, behind=True) for table in tables])
    return readings, findings(readings, settings, every)


def one_plane(readings: Readings) -> bool:
    """Say whether the poses lie in one plane through the sensor; UnusableDataError below three."""
    if len(readings) < 3:
        raise UnusableDataError(f"expected three poses or more; got {len(readings)}")
    size = np.linalg.svd(readings.sun, compute_uv=False)
    return bool(size[2] < _ONE_AXIS * size[1])


def _of_one_axis(
    readings: Readings, settings: Settings, paths: Sequence[Path], notes: Sequence[str]
) -> Calibration:
    """Return the calibration of the one angle that the poses changed."""
    from api.calibrate.one_axis.calibrated import (  # noqa: PLC0415 - of few files
        calibrated_axis,
        plane_note,
    )

    return Calibration(
        settings=settings,
        findings=(),
        applied=(),
        digest=_digest(paths),
        sources=tuple(path.name for path in paths),
        notes=(*notes, plane_note(readings)),
        **calibrated_axis(readings, settings.bench.floor_deg),
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


def _by_error(one: Candidate) -> tuple[bool, bool, float]:
    return bool(one.refused), one.missing > 0.05, one.rms_deg


def _near(one: Candidate, candidates: Sequence[Candidate]) -> bool:
    """Say whether a model's usual error is near the best: wrong poses do not move a median."""
    usual = [_usual(other) for other in candidates if not other.refused]
    return not one.refused and _usual(one) <= _CONTENDERS * min(usual)


def _usual(one: Candidate) -> float:
    errors = np.asarray(one.errors)
    return float(np.median(errors[np.isfinite(errors)]))


def _fit_spread(
    scored: Scored, sample: Readings, geometry: SensorGeometry, noise: Floats, readings: Readings
) -> Floats:
    """Return the fit's own spread (N,) at each reading; NaN where it is not known."""
    unknown = np.full(len(readings), np.nan)
    if not (noise > 0).all():
        return unknown
    try:
        return spread_deg(refits(scored, sample, geometry, noise, readings))
    except UnusableDataError:
        return unknown


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
