"""`calibrate`: from files of readings and directions to a model, its verdict and its limits."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from algorithms.angles import separation_deg
from algorithms.chain import Scored
from algorithms.contract import FeatureKind, Floats, Model, SensorGeometry, UnusableDataError
from algorithms.threads import one_thread
from calibrate.causes.applying import applied_to, one_plane, read_as
from calibrate.causes.bad_cells import ReadingLimits, joined_levels, limits_of
from calibrate.causes.untested import doubt_of_light, untested_in
from calibrate.conventions.channels import face_normals
from calibrate.conventions.finding import Finding
from calibrate.exclusions import (
    WRONG,
    Excluded,
    RunOffset,
    excluded_of,
    kept_by_model,
    sound_of,
    unexplained,
)
from calibrate.halves import halves
from calibrate.one_axis import calibration_of_axis
from calibrate.readings import Readings
from calibrate.robust import wrong_poses
from calibrate.selection import (
    Candidate,
    applicable,
    choose,
    compare,
    deviation_of,
    explained,
    fitted,
    geometry_of,
    settled,
)
from calibrate.settings import Settings
from calibrate.sources import read_sources
from calibrate.table import Table
from calibrate.uncertainty import (
    Intervals,
    covariance_of,
    errors_left_out,
    intervals,
    noise_around,
    noise_deg,
    refits,
    rms,
    spread_deg,
    tangent_offsets,
)
from calibrate.verdict import (
    Part,
    Verdict,
    judge,
    next_poses,
    parts_of,
    patterns_in,
    with_uncertain_conventions,
    withheld,
)

#: Samples from which wrong poses are looked for.
_FEWEST_FOR_WRONG = 40
#: Samples a final fit is made of at most; more are thinned evenly.
MOST_FITTED = 40_000


@dataclass(frozen=True)
class Calibration:
    """All that a calibration found.

    `left_out` (M, 3) is predicted minus true direction of the samples compared on, each when a fit
    did not see it; `spread_deg` (N,) that of the fit itself at each sample, by refits with other
    noise. Digests are SHA-256, of all files 32 digits.
    """

    settings: Settings  # as used, applied changes among them
    findings: tuple[
        Finding, ...
    ]  # conventions that the file seems to follow, applied ones included
    applied: tuple[Finding, ...]  # of them those that were
    readings: Readings  # samples that were fitted
    excluded: tuple[Excluded, ...]  # samples left out, with the reason
    off_runs: tuple[RunOffset, ...]  # runs off by a constant, left out
    fold_deg: float | None  # smallest off-axis angle of samples that fold; left out
    geometry: SensorGeometry  # the drawing as given to the models
    candidates: tuple[Candidate, ...]  # every model tried, the smallest error first
    chosen: Candidate
    why: str  # it was chosen
    model: Model  # fitted to all samples
    residual_deg: float  # RMS of samples fitted
    noise_deg: float  # RMS of single samples
    intervals: Intervals | None  # None where samples are too few
    spread_deg: Floats
    verdict: Verdict
    digest: str
    sources: tuple[str, ...]  # names of the files
    notes: tuple[str, ...] = ()  # on how files were read, and changes that did not settle
    digests: tuple[str, ...] = ()  # of each file
    left_out: Floats | None = None
    limits: ReadingLimits = field(default_factory=lambda: ReadingLimits((), (), 0.0, np.inf))
    columns: tuple[str, ...] = ()  # of the first table in its order

    def deviation_deg(
        self, features: Floats, context: Mapping[str, Floats] | None = None
    ) -> Floats:
        """Return the 1-sigma (N,) of a tangent axis at features (N, F), degrees.

        RMS of the two axes of `deviations_deg`.
        """
        return np.asarray(np.sqrt(np.mean(self.deviations_deg(features, context) ** 2, axis=1)))

    def deviations_deg(
        self, features: Floats, context: Mapping[str, Floats] | None = None
    ) -> Floats:
        """Return the 1-sigma (N, 2) of both axes of `calibrate.places.tangent_axes`.

        In degrees, at features (N, F): by the place of the direction, or as the model states it
        where there were too few samples for intervals. NaN where nothing is answered.
        """
        if self.intervals is None:
            return np.repeat(deviation_of(self.model, features, context or {})[:, None], 2, axis=1)
        return self.intervals.at(self.model.predict(features, context or {}))

    def covariance(self, features: Floats, context: Mapping[str, Floats] | None = None) -> Floats:
        """Return the covariance (N, 3, 3) of the unit vectors at features (N, F), radians squared.

        Errors along the two tangent axes are taken for uncorrelated; along the direction, zero.
        """
        sun = self.model.predict(features, context or {})
        return covariance_of(self.deviations_deg(features, context), sun)


def calibrate(
    paths: Sequence[Path],
    settings: Settings | None = None,
    *,
    apply: bool = False,
    thorough: bool = False,
    models: Sequence[str] | None = None,
    progress: Callable[[str, int, int], None] = lambda *_: None,
    most_rows: int | None = None,
) -> Calibration:
    """Calibrate a sensor by a file of a turntable, or by several files of one sensor, each a run.

    Parameters
    ----------
    paths : sequence of Path
        Of files as `calibrate.table.read_table` takes them, or of directories of pictures with
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
    most_rows : int, optional
        Rows of all files beyond which they are refused.

    Returns
    -------
    Calibration

    Raises
    ------
    TableError
        If a file is none, or lacks a column, or if there are more rows than `most_rows`.
    UnusableDataError
        If the samples settle no model; the message says what would.
    """
    read = read_sources(paths, settings, progress, most_rows)
    found = calibrate_tables(
        read.tables,
        read.settings,
        apply=apply,
        thorough=thorough,
        models=models,
        progress=progress,
    )
    notes = (*read.notes, *found.notes)
    return replace(found, digest=read.digest, digests=read.digests, notes=notes)


def calibrate_tables(
    tables: Sequence[Table],
    stated: Settings,
    *,
    apply: bool = False,
    thorough: bool = False,
    models: Sequence[str] | None = None,
    progress: Callable[[str, int, int], None] = lambda *_: None,
) -> Calibration:
    """Calibrate a sensor by tables in memory, each a run.

    Parameters and errors are those of `calibrate`, but for settings, which are stated and of any
    kind but ``frames``; notes and digests, which are those of files, stay empty.
    """
    with one_thread():  # small fits: waiting for each other takes threads most of their time
        return _calibrated(tables, stated, apply, thorough, models, progress)


def _calibrated(  # noqa: PLR0915, PLR0917 - the steps in their order
    tables: Sequence[Table],
    stated: Settings,
    apply: bool,
    thorough: bool,
    models: Sequence[str] | None,
    progress: Callable[[str, int, int], None],
) -> Calibration:
    notes: list[str] = []
    progress("conventions", 0, 1)
    file = read_as(tables, stated)
    applied: list[Finding] = []
    if apply:
        file, applied = applied_to(tables, file, notes)
    stated, readings, found = file.settings, file.readings, file.findings
    notes += [note for part in file.bad for note in part.notes]
    if one_plane(readings):
        return Calibration(**calibration_of_axis(readings, file, tables, notes))
    sound, excluded, runs, fold = sound_of(readings)
    excluded = [*(one for part in file.bad for one in part.excluded), *excluded]
    if one_plane(sound):
        return Calibration(**calibration_of_axis(sound, file, tables, notes, excluded))
    readings = sound
    wrong = np.zeros(len(sound), dtype=np.bool_)
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
        progress(name, count, 2 * len(wanted) + 4)
        count += 1

    candidates = [explained(one, readings) for one in compare(readings, geometry, wanted, tick)]
    candidates.sort(key=_by_error)
    chosen, why = choose(candidates)
    kept = kept_by_model(wanted[chosen.name], chosen, sound, readings, geometry)
    changed = not np.array_equal(sound.rows[kept], readings.rows)
    readings = sound.only(kept)
    wrong_ones = sound.only(~kept)
    excluded += excluded_of(~kept, WRONG, sound)
    if changed:  # a wrong pose that was not seen may have misled the choice
        candidates = [explained(one, readings) for one in compare(readings, geometry, wanted, tick)]
        candidates.sort(key=_by_error)
        chosen, why = choose(candidates)
    count = 2 * len(wanted)
    tick("fit")
    thinned = readings.thinned(MOST_FITTED)
    model = fitted(wanted[chosen.name], thinned, geometry)
    offsets = model.predict(readings.features, readings.context) - readings.sun
    residual = rms(separation_deg(offsets + readings.sun, readings.sun))
    noise = noise_deg(offsets, readings.sun)
    tick("uncertainty")
    sample = readings.only(np.arange(0, len(readings), max(len(readings) // 2000, 1)))
    around = noise_around(model.predict(sample.features, sample.context) - sample.sun, sample.sun)
    same = settled(wanted[chosen.name], model)
    spread = _fit_spread(same, sample, geometry, around, readings)
    tick("halves")
    split = halves(same, sample, geometry, around)
    tick("verdict")
    compared = readings.thinned(len(np.asarray(chosen.offsets)))
    patterns = patterns_in(np.asarray(chosen.offsets), compared)
    removed = sound.only(~kept & ~wrong)
    left_out = errors_left_out(same, chosen, compared, geometry, model, removed)
    faces = face_normals(readings)[0] if readings.kind is FeatureKind.SIGNALS else None
    stated_sigma = intervals(*left_out, faces)
    verdict = judge(
        chosen.rms_deg, residual, noise, stated.bench.floor_deg, split, patterns,
        *next_poses(readings.sun),
    )  # fmt: skip
    dark_found = any(_states_dark(one) for one in applied)
    verdict = withheld(
        replace(verdict, untested=untested_in(readings, stated, dark_found=dark_found)),
        unexplained(readings, excluded, wrong_ones, stated.sensor.half_fov_deg, fold)
        or doubt_of_light(model, readings, stated, chosen.rms_deg),
        () if stated_sigma is None else _parts(chosen, stated_sigma, compared),
    )
    if uncertain := next((one for one in found if one.certain), None):
        verdict = with_uncertain_conventions(verdict, uncertain.found)
    progress("done", 2 * len(wanted) + 4, 2 * len(wanted) + 4)
    return Calibration(
        stated, (*applied, *found), tuple(applied), readings, tuple(excluded), tuple(runs), fold,
        geometry, tuple(candidates), chosen, why, model, residual, noise,
        stated_sigma, spread, verdict, "", tuple(table.source for table in tables), tuple(notes),
        left_out=left_out[0][: len(compared)],
        limits=limits_of(readings, stated, joined_levels(file.bad)),
        columns=tuple(tables[0].columns),
    )  # fmt: skip


def _states_dark(finding: Finding) -> bool:
    readings = finding.change.get("readings")
    return isinstance(readings, dict) and "dark" in readings


def _by_error(one: Candidate) -> tuple[bool, bool, float]:
    return bool(one.refused), one.missing > 0.05, one.rms_deg


def _parts(chosen: Candidate, sigma: Intervals, compared: Readings) -> tuple[Part, ...]:
    """Return parts of the samples left out, with how far the stated intervals hold there."""
    offsets = np.asarray(chosen.offsets)
    along = tangent_offsets(offsets, compared.sun)
    along[~np.isfinite(np.asarray(chosen.errors))] = np.nan
    return parts_of(compared, along, sigma.at(compared.sun))


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
