"""An old calibration corrected by a few new poses: gains, offsets, scale and turn that changed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from algorithms.angles import separation_deg
from algorithms.contract import FeatureKind, Floats, UnusableDataError
from calibrate.one_axis import AxisCurve
from calibrate.readings import Readings, joined, readings_of
from calibrate.table import read_table
from calibrate.terms.age import Changes, Kind, answered, fit

#: Poses that a correction needs, and in how many parts they are left out.
_FEWEST, _PARTS = 4, 10
#: How many times likelier poses left out must be by a correction than without.
_LIKELIER = 200.0
#: Kinds of changes that one correction has at most.
_MOST_KINDS = 2
#: RMS of new poses over that of the calibration from which no correction is not all well.
_WORSE = 2.0
#: Median of the length of two normal errors over their 1-sigma.
_MEDIAN = 1.1774


@dataclass(frozen=True)
class Errors:
    """Angles between answers and poses, degrees; NaN where there is no answer.

    `most_deg` is the RMS without the largest tenth, and at least one, which may be a wrong pose.
    """

    rms_deg: float
    median_deg: float
    largest_deg: float
    most_deg: float

    @classmethod
    def of(cls, errors: Floats) -> Errors:
        """Return those of errors (N,), of which NaN are left out."""
        known = np.sort(errors[np.isfinite(errors)])
        if not len(known):
            return cls(*4 * (float("nan"),))
        most = known[: max(len(known) - max(len(known) // 10, 1), 1)]
        rms, of_most = (float(np.sqrt(np.mean(some**2))) for some in (known, most))
        return cls(rms, float(np.median(known)), float(known[-1]), of_most)

    def sentence(self) -> str:
        """Say them."""
        return (
            f"{self.rms_deg:.3g} deg RMS (median {self.median_deg:.3g}, "
            f"largest {self.largest_deg:.3g})"
        )


@dataclass(frozen=True)
class Correction:
    """What a sensor did since it was calibrated.

    A reading, less dark over gain, is now ``gain`` times what it was, plus ``offset``; `rotation`
    takes the old directions to the new ones. `after` has each pose while it was left out.
    """

    kinds: tuple[Kind, ...]  # that changed; none where nothing explains the poses better
    gain: tuple[float, ...]
    offset: tuple[float, ...]
    rotation: tuple[tuple[float, ...], ...]
    before: Errors  # of the old calibration on the new poses
    after: Errors
    changes: tuple[str, ...]  # each with its 1-sigma, in words
    samples: int  # poses that the old calibration answers
    unanswered: int = 0  # poses that the corrected one does not answer
    stated_deg: float = float("nan")  # by its own document; NaN where it states none
    errors_deg: Floats = field(default_factory=lambda: np.zeros(0), repr=False, compare=False)

    @property
    def explained(self) -> bool:
        """Whether nine in ten poses are answered about as well as the old calibration states."""
        return not self.after.most_deg > _WORSE * self.stated_deg

    def as_data(self) -> dict[str, Any]:
        """Return all of it as JSON has it, None for what is no number."""
        held = {name: value for name, value in asdict(self).items() if name != "errors_deg"}
        stated = self.stated_deg if np.isfinite(self.stated_deg) else None
        errors = {
            name: {key: value if np.isfinite(value) else None for key, value in held[name].items()}
            for name in ("before", "after")
        }
        return {**held, **errors, "stated_deg": stated}

    def sentence(self) -> str:
        """Say what was found."""
        said = f"the old calibration errs {self.before.sentence()} on {self.samples} poses"
        if self.kinds:
            said += f"; {', '.join(self.changes)}: that leaves {self.after.sentence()}"
            said += " on poses left out"
        else:
            said += "; no gain, offset, scale or turn explains that better: it stays"
        if self.unanswered:
            said += f"; {self.unanswered} are not answered"
        if not self.explained:
            said += (
                f". It stated {self.stated_deg:.3g} deg: wrong poses, or what no correction "
                "explains; calibrate anew if there are more poses"
            )
        return said


def recalibrate(paths: Sequence[Path], old: Any) -> Correction:
    """Return what a few new poses say of an old calibration.

    Gains and offsets of readings, a scale and a turn are each fitted, weighted so that wrong poses
    hardly count, and judged by poses left out of the fit; the best, and then a second one if it
    makes that better still.

    Parameters
    ----------
    paths : sequence of Path
        Files with the columns of the old calibration's settings.
    old : SavedCalibration
        As `calibrate.documents.load` gives it.

    Raises
    ------
    UnusableDataError
        If the old calibration answers fewer than four of the poses, or is one of a single axis.
    TableError
        As `calibrate.table.read_table`.
    """
    if isinstance(getattr(old, "model", None), AxisCurve):
        raise UnusableDataError(
            "the old calibration is one of a single axis, which is not corrected: calibrate anew"
        )
    readings = poses_of(paths, old)
    known = np.isfinite(old.predict(readings.features, readings.context)).all(axis=1)
    if known.sum() < _FEWEST:
        raise UnusableDataError(
            f"the old calibration answers {int(known.sum())} of the {len(readings)} poses; a "
            f"correction needs {_FEWEST}: take some inside the field that it was calibrated on"
        )
    # what left the old field, as readings of a dimmed cell do, tells most
    beyond = getattr(old, "unbounded", old)
    none = Changes.none(readings.raw.shape[1])
    errors = separation_deg(answered(beyond, readings, none), readings.sun)
    before = Errors.of(errors[known])
    kinds: tuple[Kind, ...] = ()
    while len(kinds) < _MOST_KINDS:
        more = _better(beyond, readings, kinds, errors)
        if more is None:
            break
        kinds, errors = more
    changes = fit(beyond, readings, kinds) if kinds else none
    held = np.isfinite(answered(old, readings, changes)).all(axis=1)
    return Correction(
        kinds,
        tuple(float(v) for v in changes.gain),
        tuple(float(v) for v in changes.offset),
        tuple(tuple(float(v) for v in row) for row in changes.rotation),
        before,
        Errors.of(errors[held]),
        tuple(_said(changes, kinds, old.settings.readings.columns)),
        int(known.sum()),
        int((~held).sum()),
        float(getattr(old, "stated_deg", "nan")),
        np.where(held, errors, np.nan),
    )


def poses_of(paths: Sequence[Path], old: Any) -> Readings:
    """Return the readings of files by the settings of a saved calibration."""
    return joined(
        [readings_of(read_table(path, old.settings.file), old.settings) for path in paths]
    )


def _kinds(readings: Readings) -> tuple[Kind, ...]:
    """Return what may have changed: two readings are a place, more are light on parts."""
    if readings.kind is FeatureKind.SIGNALS or readings.raw.shape[1] > 2:
        return ("boresight", "gain", "offset")
    return ("boresight", "offset", "scale")


def _better(
    old: Any, readings: Readings, kinds: tuple[Kind, ...], errors: Floats
) -> tuple[tuple[Kind, ...], Floats] | None:
    """Return the kind of change that explains poses left out best, if it does better than now."""
    tried = {}
    for one in _kinds(readings):
        if one not in kinds and not {"scale", "offset"} <= {one, *kinds}:
            tried[*kinds, one] = _left_out(old, readings, (*kinds, one))
    if not tried:
        return None
    usual = [Errors.of(found).median_deg for found in (errors, *tried.values())]
    # no smaller than the old calibration's own: few poses may lie near their answers by chance
    stated = np.nan_to_num(float(getattr(old, "stated_deg", 0.0))) / np.sqrt(2.0)
    scale = max(float(np.nanmin(usual)) / _MEDIAN, float(stated), 1e-12)
    # a scale comes with offsets: it has to be as much likelier than they alone
    best = max(
        tried,
        key=lambda names: _likelihood(tried[names], scale) - np.log(_LIKELIER) * ("scale" in names),
    )
    gained = _likelihood(tried[best], scale) - _likelihood(errors, scale)
    return (best, tried[best]) if gained > np.log(_LIKELIER) else None


def _left_out(old: Any, readings: Readings, kinds: tuple[Kind, ...]) -> Floats:
    """Error (N,) of each pose by a correction that was fitted to the others, degrees."""
    errors = np.full(len(readings), np.nan)
    for out in np.array_split(np.arange(len(readings)), min(len(readings), _PARTS)):
        rest = np.ones(len(readings), dtype=np.bool_)
        rest[out] = False
        test = readings.only(out)
        changes = fit(old, readings.only(rest), kinds)
        errors[out] = separation_deg(answered(old, test, changes), test.sun)
    return errors


def _likelihood(errors: Floats, scale: float) -> float:
    """Logarithm of the likelihood of errors (N,): Student's t of two freedoms, in the plane.

    Its tails are those of wrong poses, so that one of them decides nothing.
    """
    sizes = np.where(np.isfinite(errors), errors, 180.0) / scale
    return float(-2.0 * np.log1p(sizes**2 / 2.0).sum())


def _said(changes: Changes, kinds: tuple[Kind, ...], columns: Sequence[str]) -> list[str]:
    said = []
    if "gain" in kinds:
        said += [
            f"gain of channel {at + 1} ({columns[at]}) is {changes.gain[at]:.4g} "
            f"+- {changes.gain_sigma[at]:.1g}"
            for at in map(int, np.flatnonzero(changes.gain_sigma))
        ]
    if "scale" in kinds:
        said.append(f"readings grew {changes.gain[0]:.5g} +- {changes.gain_sigma[0]:.1g} times")
    if {"offset", "scale"} & set(kinds):
        said += [
            f"{columns[at]} moved by {changes.offset[at]:.3g} +- {changes.offset_sigma[at]:.1g}"
            for at in map(int, np.flatnonzero(changes.offset_sigma))
        ]
    if "boresight" in kinds:
        said.append(f"a turn by {changes.turn_deg:.3g} +- {changes.turn_sigma_deg:.1g} deg")
    return said
