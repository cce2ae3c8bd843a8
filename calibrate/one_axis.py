"""Sensors of one axis: the angle in the plane of the sweep, its curve, and what was not tested."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from algorithms.calibration.blocks import folds_along
from algorithms.calibration.calibrated import CalibratedModel, Columns
from algorithms.calibration.hull import Hull
from algorithms.calibration.orders import choose_order, errors_of_orders
from algorithms.calibration.quality import Setting
from algorithms.contract import AboutModel, FeatureKind, Floats, SensorGeometry, UnusableDataError
from algorithms.models.non_physical.regression_axes import Target, in_degrees
from calibrate.causes.applying import File
from calibrate.causes.bad_cells import joined_levels, limits_of
from calibrate.exclusions import Excluded, excluded_of
from calibrate.readings import Readings
from calibrate.selection import Candidate, judged_on_folds
from calibrate.table import Table
from calibrate.uncertainty import NORMAL_95, Intervals, limit_of, rms
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
#: Largest degree, and samples a term takes at least.
_MOST, _PER_TERM = 15, 3
#: Cosine of the angle between boresight and plane from which the boresight counts as inside.
_INSIDE = 1e-3
#: Angle up to which tangents are fitted.
_MOST_TANGENT_DEG = 85.0


@dataclass
class AxisCurve(CalibratedModel):
    """The angle of the light in the plane of a sweep, as a polynomial of the readings along it.

    Readings (N, 2) are projected onto the direction in which they follow the angle; a sensor of one
    reading has zeros in the second place. The degree is chosen by samples left out. Answers lie in
    the plane: what lies across it was not calibrated.

    Parameters
    ----------
    target : {"angle", "tangent"}
        Output of the polynomial: the angle in degrees, or its tangent, in which the response of a
        pinhole or slit is linear.

    Attributes
    ----------
    middle_, along_ : ndarray, shape (2,)
        Of the readings: what is subtracted, and the direction of the coordinate, one of its units
        being half the calibrated range.
    ends_ : ndarray, shape (2,)
        Smallest and largest coordinate that is answered.
    start_, across_ : ndarray, shape (3,)
        Direction of angle zero, the boresight where the plane holds it, and that of 90 deg.
    coefficients_, whitening_ : ndarray
        Chebyshev coefficients, degrees, and the inverse of the design's triangular factor.

    Notes
    -----
    Failure: a NaN row for a NaN reading or beyond the calibrated range. fit raises
    UnusableDataError where samples are too few or the reading does not follow the angle.
    """

    about: ClassVar = AboutModel(
        name="polynomial-one-axis",
        taxonomy="Polynomial",
        accepts=frozenset({FeatureKind.SPOT, FeatureKind.BALANCE}),
    )
    target: Target = "angle"

    frontal: ClassVar[bool] = False
    bounded: ClassVar[bool] = False
    fewest: ClassVar[int] = 8

    middle_: Floats = field(init=False, repr=False, compare=False)
    along_: Floats = field(init=False, repr=False, compare=False)
    ends_: Floats = field(init=False, repr=False, compare=False)
    start_: Floats = field(init=False, repr=False, compare=False)
    across_: Floats = field(init=False, repr=False, compare=False)
    coefficients_: Floats = field(init=False, repr=False, compare=False)
    whitening_: Floats = field(init=False, repr=False, compare=False)
    validated_deg_: float = field(init=False, repr=False, compare=False)

    def _region(self, features: Floats, sun: Floats) -> Hull:  # noqa: ARG002 - ends do it
        return Hull(np.empty((0, 3)))

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Fit the polynomial to samples (n, 2) of Suns (n, 3) in one plane."""
        del context
        self.start_, self.across_ = plane_of(sun)
        angle = angles_in(sun, self.start_, self.across_)
        centred = features - features.mean(axis=0)
        slope = centred.T @ (angle - angle.mean())
        if not np.linalg.norm(slope) > 0:
            raise UnusableDataError(
                f"{self.about.name}: the reading does not change with the angle"
            )
        coordinate = features @ (slope / np.linalg.norm(slope))
        low, high = float(coordinate.min()), float(coordinate.max())
        half = (high - low) / 2.0
        self.along_ = slope / np.linalg.norm(slope) / half
        self.middle_ = self.along_ * half * (low + high) / 2.0
        u = (features - self.middle_) @ self.along_
        # as far as halfway to where the next pose would be
        step = float(np.median(np.diff(np.unique(u.round(9)))))
        self.ends_ = np.array([-1.0, 1.0]) * (1.0 + step / 2.0)
        most = min(_MOST, len(u) // _PER_TERM - 1)
        design = _terms(u, most)
        places = np.unique(u.round(9))
        between = _terms((places[1:] + places[:-1]) / 2.0, most)
        wanted = angle if self.target == "angle" else np.tan(np.radians(angle))
        if self.target == "tangent" and not np.abs(angle).max() < _MOST_TANGENT_DEG:
            raise UnusableDataError(
                f"{self.about.name}: expected angles below {_MOST_TANGENT_DEG:g} deg; got "
                f"{np.abs(angle).max():.3g}"
            )
        errors = errors_of_orders(
            design, list(range(2, most + 2)), wanted[:, None], folds_along(u), between
        )
        choice = choose_order(errors, self.about.name)
        design = design[:, : choice.order + 2]
        self.coefficients_ = np.asarray(np.linalg.lstsq(design, wanted, rcond=None)[0])
        self.whitening_ = np.asarray(np.linalg.inv(np.linalg.qr(design, mode="r")))
        self.validated_deg_ = in_degrees(choice.rms, self.target)

    def settings(self) -> Mapping[str, Setting]:
        """Give the degree chosen."""
        return {"degree": len(self.coefficients_) - 1, "target": self.target}

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of features (N, 2)."""
        del context
        u = (features - self.middle_) @ self.along_
        value = chebyshev.chebval(u, self.coefficients_)
        angle = np.radians(value) if self.target == "angle" else np.arctan(value)
        angle[~((u >= self.ends_[0]) & (u <= self.ends_[1]))] = np.nan
        return np.asarray(
            np.cos(angle)[:, None] * self.start_ + np.sin(angle)[:, None] * self.across_
        )

    def deviation_deg(self, features: Floats, context: Columns | None = None) -> Floats:  # type: ignore[override]
        """1-sigma (N,) of the angle in the plane, degrees: of residuals and of coefficients."""
        u = (np.asarray(features, dtype=np.float64) - self.middle_) @ self.along_
        terms = _terms(u, len(self.coefficients_) - 1)
        share = ((terms @ self.whitening_) ** 2).sum(axis=1)
        found = self.validated_deg_**2 + share * self.quality_.residual_rms_deg**2
        known = np.isfinite(self.predict(features, context)[:, 0])
        return np.asarray(np.sqrt(np.where(known, found, np.nan)))


def _terms(u: Floats, degree: int) -> Floats:
    """``T_k(u)`` for k = 0..degree, (N, degree + 1)."""
    return np.asarray(chebyshev.chebvander(u, degree), dtype=np.float64)


def plane_of(sun: Floats) -> tuple[Floats, Floats]:
    """Return the directions of angle zero and of 90 deg in the plane of directions (N, 3).

    Zero is the boresight where the plane holds it, else the middle of the directions; angles grow
    towards +x, or towards +y in a plane without it.
    """
    normal = np.linalg.svd(sun, full_matrices=False)[2][2]
    start = np.array([0.0, 0.0, 1.0])
    if abs(normal[2]) > _INSIDE:
        start = sun.mean(axis=0)
    start = start - (start @ normal) * normal
    start /= np.linalg.norm(start)
    across = np.cross(normal, start)
    leading = across[np.argmax(np.abs(across) > 0.1)]
    return start, across if leading > 0 else -across


def angles_in(sun: Floats, start: Floats, across: Floats) -> Floats:
    """Return the angle (N,) of directions (N, 3) in a plane, degrees."""
    return np.asarray(np.degrees(np.arctan2(sun @ across, sun @ start)))


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
    """Return a calibration of the one angle that the poses of tables changed, by attribute.

    `readings` lie in one plane, `notes` say how the tables were read, `excluded` are samples left
    out before. Raises as `calibrated_axis`.
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
    """Calibrate the one angle that a sweep changed; return attributes of `Calibration` by name.

    UnusableDataError if readings are signals of several channels, too few, or do not follow the
    angle.
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
    residual = rms(left)
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
    curve: Any = SimpleNamespace(for_sensor=lambda *_: AxisCurve(TARGETS[name]))
    fold = _folds(angle)
    return judged_on_folds(name, curve, readings, SensorGeometry(), fold, fold >= 0)


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
