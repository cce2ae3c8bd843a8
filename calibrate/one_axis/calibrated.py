"""A calibration of one axis: the sweep's plane, its angle, what errs, and what was not tested."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import FeatureKind, Floats, SensorGeometry, UnusableDataError
from algorithms.models.non_physical.regression_axes import Target
from calibrate.causes.applying import File
from calibrate.causes.bad_cells import joined_levels
from calibrate.causes.limits import limits_of
from calibrate.exclusions import Excluded, excluded_of
from calibrate.one_axis.curve import AxisCurve, angles_in, plane_of
from calibrate.readings import Readings
from calibrate.selection import Candidate
from calibrate.table import Table
from calibrate.uncertainty import NORMAL_95, Intervals, limit_of
from calibrate.verdict import Verdict, Word

#: Blocks of neighbouring poses along the sweep, every fifth of which is left out together.
_BLOCKS, _FOLDS = 40, 5
#: Poses off by so many robust standard deviations of what their neighbours leave are wrong.
_WRONG, _MAD = 6.0, 1.4826
#: Share of poses that may be wrong for the verdict to be good, and at most.
_FEW_WRONG, _MOST_WRONG = 0.02, 0.25
#: Error over the angles' own spread from which readings and angles do not belong together.
_CHANCE = 0.5
#: Error of samples left out over that of those fitted, and residual over noise, of a good fit.
_MORE_LEFT_OUT, _MORE_THAN_NOISE = 1.6, 1.5
_FEWEST_FOR_INTERVALS = 40
_REFITS, _SEED = 6, 20_261_128
NAME = AxisCurve.about.name
#: Curves that are compared, by their name.
TARGETS: dict[str, Target] = {NAME: "angle", f"{NAME} of the tangent": "tangent"}


def calibration_of_axis(
    readings: Readings,
    file: File,
    tables: Sequence[Table],
    notes: Sequence[str],
    excluded: Sequence[Excluded] = (),
) -> dict[str, Any]:
    """Return what a calibration of the one angle that the poses of tables changed says.

    Parameters
    ----------
    readings : Readings
        Samples whose directions lie in one plane.
    file : File
        That they are of.
    tables : sequence of Table
    notes : sequence of str
        On how the tables were read.
    excluded : sequence of Excluded
        Samples left out before.

    Returns
    -------
    dict
        Attributes of `calibrate.calibration.Calibration` by their names.

    Raises
    ------
    UnusableDataError
        As `calibrated_axis`.
    """
    settings = file.settings
    found = calibrated_axis(readings, settings.bench.floor_deg)
    found["excluded"] = (*excluded, *found["excluded"])
    return {
        **found,
        "settings": settings,
        "findings": (),
        "applied": (),
        "digest": "",
        "sources": tuple(table.source for table in tables),
        "notes": (*notes, plane_note(readings)),
        "limits": limits_of(found["readings"], settings, joined_levels(file.bad)),
        "columns": tuple(tables[0].columns),
    }


def calibrated_axis(readings: Readings, floor_deg: float) -> dict[str, Any]:
    """Calibrate the one angle that a sweep changed.

    Parameters
    ----------
    readings : Readings
        Samples whose directions lie in one plane, with one or two features.
    floor_deg : float
        RMS error of the bench, degrees.

    Returns
    -------
    dict
        What `calibrate.calibration.Calibration` says of it, by its names.

    Raises
    ------
    UnusableDataError
        If readings are signals of several channels, too few, or do not follow the angle.
    """
    if readings.kind is FeatureKind.SIGNALS:
        raise UnusableDataError(
            f"the {len(readings)} poses lie along one axis, and {readings.features.shape[1]} "
            "channels do not say the direction by one angle: a second axis would settle the "
            "calibration (sweep the other gimbal, and add the rows)"
        )
    sound, excluded = _without_wrong(readings, floor_deg)
    angle, start, across = _angle(sound)
    candidates = sorted((_left_out(sound, angle, one) for one in TARGETS), key=_by_error)
    candidate = candidates[0]
    _require_related(candidate, angle)
    target = TARGETS[candidate.name]
    model = _fitted(sound, target)
    left = angles_in(model.predict(sound.features), start, across) - angle
    residual = _rms(left)
    noise = _noise(left, angle)
    share = len(excluded) / len(readings)
    word, reason = _judged(candidate, residual, float(np.hypot(noise, floor_deg)), share)
    return {
        "readings": sound,
        "excluded": tuple(excluded),
        "off_runs": (),
        "fold_deg": None,
        "geometry": SensorGeometry(),
        "candidates": tuple(candidates),
        "chosen": candidate,
        "why": f"smallest error; of degree {model.settings()['degree']} for the axis' {target}",
        "model": model,
        "residual_deg": residual,
        "noise_deg": noise,
        "intervals": _intervals(candidate, angle, start, across, sound),
        "left_out": candidate.offsets,
        "spread_deg": _spread(sound, noise, target),
        "verdict": Verdict(word, reason, float("nan"), (), np.empty((0, 3))),
    }


def plane_note(readings: Readings) -> str:
    """Return what was calibrated, in a sentence without an end."""
    start, across = plane_of(readings.sun)
    normal = np.cross(start, across)

    def said(vector: Floats) -> str:
        return "(" + ", ".join(f"{part + 0.0:.4f}" for part in np.round(vector, 4)) + ")"

    return (
        "one-axis calibration: the poses lie in one plane through the sensor, and the angle in it "
        f"is calibrated, 0 deg along {said(start)}, 90 deg along {said(across)}; turns about other "
        f"axes than {said(normal)} were not measured and are not answered for"
    )


def _angle(readings: Readings) -> tuple[Floats, Floats, Floats]:
    start, across = plane_of(readings.sun)
    return angles_in(readings.sun, start, across), start, across


def _fitted(readings: Readings, target: Target = "angle") -> AxisCurve:
    return AxisCurve(target).fit(readings.features, readings.sun)


def _without_wrong(readings: Readings, floor_deg: float) -> tuple[Readings, list[Excluded]]:
    """Leave out poses that a smooth curve through the others contradicts, at most a quarter."""
    wrong = np.zeros(len(readings), dtype=np.bool_)
    for _ in range(5):
        kept = readings.only(~wrong)
        start, across = plane_of(kept.sun)
        every = angles_in(readings.sun, start, across)
        off = np.abs(angles_in(_unbounded(kept, readings), start, across) - every)
        off = np.minimum(off, 360.0 - off)
        usual = _MAD * float(np.median(off[~wrong]))
        now = off > max(_WRONG * usual, 3.0 * floor_deg, 1e-6)
        if now.mean() > _MOST_WRONG or np.array_equal(now, wrong):
            break
        wrong = now
    return readings.only(~wrong), excluded_of(wrong, "wrong pose", readings)


def _unbounded(kept: Readings, readings: Readings) -> Floats:
    model = _fitted(kept)
    model.ends_ = np.array([-np.inf, np.inf])
    return model.predict(readings.features)


def _by_error(one: Candidate) -> tuple[bool, float]:
    return bool(one.refused), one.rms_deg


def _left_out(readings: Readings, angle: Floats, name: str) -> Candidate:
    """Return how a curve does on blocks of the sweep that it had not seen."""
    try:
        return _judged_curve(readings, angle, name)
    except UnusableDataError as error:
        return Candidate(name, refused=str(error))


def _judged_curve(readings: Readings, angle: Floats, name: str) -> Candidate:
    fold = _folds(angle)
    predicted = np.full((len(readings), 3), np.nan)
    deviation = np.full(len(readings), np.nan)
    rms = []
    for number in range(_FOLDS):
        out = fold == number
        if not out.any():
            continue
        model = _fitted(readings.only(~out), TARGETS[name])
        predicted[out] = model.predict(readings.features[out])
        deviation[out] = model.deviation_deg(readings.features[out])
        rms.append(_rms(_separation(predicted[out], readings.sun[out])))
    errors = _separation(predicted, readings.sun)
    judged = fold >= 0
    folds = np.array([value for value in rms if np.isfinite(value)])
    return Candidate(
        name,
        _rms(errors),
        float(np.std(folds, ddof=1) / np.sqrt(len(folds))) if len(folds) > 1 else 0.0,
        float(folds.max(initial=np.nan)) if len(folds) else float("nan"),
        1.0 - float(np.isfinite(errors).sum() / max(judged.sum(), 1)),
        errors=errors,
        offsets=predicted - readings.sun,
        deviation=deviation,
    )


def _folds(angle: Floats) -> NDArray[np.int64]:
    """Fold (N,) of each pose by its block along the sweep; -1 at both ends, which all fits keep."""
    places, number = np.unique(angle.round(6), return_inverse=True)
    blocks = min(_BLOCKS, len(places))
    block = (number.reshape(-1) * blocks) // len(places)
    fold = block % _FOLDS
    fold[(block == 0) | (block == blocks - 1)] = -1
    return np.asarray(fold, dtype=np.int64)


def _require_related(candidate: Candidate, angle: Floats) -> None:
    spread = float(np.std(angle))
    if candidate.refused:
        raise UnusableDataError(f"no curve can be fitted: {candidate.refused}")
    if not candidate.rms_deg <= _CHANCE * spread:
        raise UnusableDataError(
            f"{NAME}: errs {candidate.rms_deg:.3g} deg where angles spread over {spread:.3g} deg: "
            "readings and directions do not belong together"
        )


def _judged(candidate: Candidate, residual: float, noise: float, wrong: float) -> tuple[Word, str]:
    said = (
        f"one-axis calibration: samples left out err {candidate.rms_deg:.3g} deg, those fitted "
        f"{residual:.3g} deg, noise is {noise:.3g} deg; the other axis was not measured"
    )
    if wrong > _FEW_WRONG:
        return "model misfit", f"{100.0 * wrong:.0f} % of the poses were left out as wrong; {said}"
    if candidate.rms_deg > _MORE_LEFT_OUT * max(residual, noise):
        return "poses missing", f"there are too few poses, or too far apart; {said}"
    if residual > _MORE_THAN_NOISE * noise:
        return "model misfit", f"residuals are more than the noise; {said}"
    return "good", said


def _noise(left: Floats, angle: Floats) -> float:
    """Return the noise of a sample, degrees, by second differences along the sweep."""
    known = np.isfinite(left)
    ordered = left[known][np.argsort(angle[known], kind="stable")]
    if len(ordered) < 10:
        return float("nan")
    second = ordered[2:] - 2.0 * ordered[1:-1] + ordered[:-2]
    return float(np.sqrt(np.mean(second**2) / 6.0))


def _intervals(
    candidate: Candidate, angle: Floats, start: Floats, across: Floats, readings: Readings
) -> Intervals | None:
    """Return one 1-sigma for the whole sweep, by samples left out, and what it then covers.

    It is that of the angle; across the plane, where nothing was measured, it stands as well.
    """
    if candidate.offsets is None:
        return None
    off = np.abs(angles_in(candidate.offsets + readings.sun, start, across) - angle)
    off = off[np.isfinite(off)]
    if len(off) < _FEWEST_FOR_INTERVALS:
        return None
    half = np.arange(len(off)) % 2 == 0
    within = [float((off[test] <= limit_of(off[~test])).mean()) for test in (half, ~half)]
    sigma = limit_of(off) / NORMAL_95
    return Intervals(
        sigma / candidate.rms_deg,
        float(np.mean(within)),
        len(off),
        np.array([0.0, 0.0, 1.0]),
        np.array([0.0, 180.0]),
        4,
        np.full((2, 4, 2), sigma),
    )


def _spread(readings: Readings, noise: float, target: Target) -> Floats:
    """Return the curve's own spread (N,), degrees, by refits to angles with other noise."""
    angle, start, across = _angle(readings)
    if not noise > 0:
        return np.full(len(readings), np.nan)
    found = []
    for number in range(_REFITS):
        generator = np.random.default_rng(np.random.SeedSequence([_SEED, number]))
        other = np.radians(angle + generator.normal(0.0, noise, len(angle)))
        sun = np.cos(other)[:, None] * start + np.sin(other)[:, None] * across
        model = AxisCurve(target).fit(readings.features, sun)
        found.append(angles_in(model.predict(readings.features), start, across))
    return np.asarray(np.std(np.array(found), axis=0, ddof=1))


def _separation(predicted: Floats, sun: Floats) -> Floats:
    from algorithms.angles import separation_deg  # noqa: PLC0415 - one use

    return separation_deg(predicted, sun)


def _rms(errors: Floats) -> float:
    known = errors[np.isfinite(errors)]
    return float(np.sqrt(np.mean(known**2))) if len(known) else float("nan")
