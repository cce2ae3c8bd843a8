"""An old calibration corrected by a few new poses: a turned boresight, or moved readings."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from algorithms.angles import separation_deg
from algorithms.contract import FeatureKind, Floats, UnusableDataError
from api.calibrate.readings import Readings, joined, readings_of
from api.calibrate.table import read_table

Kind = Literal["none", "boresight", "offset"]
#: Poses that a correction needs.
_FEWEST = 4
#: Error on poses left out, over the old one's, up to which a correction is taken.
_BETTER = 0.9
#: Size of a correction over its 1-sigma from which it is one.
_CLEAR = 8.0
_ROUNDS = 20
#: Steps to an offset, of which the first is at most a tenth of the readings' range.
_MOST_STEPS = 40
#: Residuals over their median up to which poses count in full.
_USUAL = 2.0
#: RMS over median of the length of two normal errors.
_RMS_OF_MEDIAN = 1.2011


@dataclass(frozen=True)
class Correction:
    """What a sensor did since it was calibrated.

    Attributes
    ----------
    kind : {"none", "boresight", "offset"}
        Nothing that shows; the sensor turned; its readings moved.
    offset : tuple of float
        Subtracted from readings; zeros unless of kind ``offset``.
    rotation : tuple of three tuples of three float
        That takes the old directions to the new ones.
    before_deg, after_deg : float
        RMS error of the old calibration on the new poses, and of the corrected one on each pose
        while it was left out, both from the median, which wrong poses do not move.
    size, uncertainty : float
        Of the turn, degrees, or of the move, in the readings' unit, and its 1-sigma.
    samples : int
        Poses that were answered.
    """

    kind: Kind
    offset: tuple[float, ...]
    rotation: tuple[tuple[float, ...], ...]
    before_deg: float
    after_deg: float
    size: float
    uncertainty: float
    samples: int

    def sentence(self) -> str:
        """Say what was found."""
        sentence = f"the old calibration errs {self.before_deg:.3g} deg on {self.samples} poses"
        if self.kind == "none":
            return f"{sentence}; neither a turn nor an offset explains that better: it stays"
        what = "a turn by {} deg" if self.kind == "boresight" else "readings moved by {}"
        size = what.format(f"{self.size:.3g} +- {self.uncertainty:.1g}")
        return f"{sentence}; {size} leaves {self.after_deg:.3g} deg on poses left out"


def recalibrate(paths: Sequence[Path], old: Any) -> Correction:
    """Return what a few new poses say of an old calibration.

    A turn of the sensor (three angles) and an offset of its two readings are each fitted, weighted
    so that wrong poses do not count, and judged by the poses left out of it.

    Parameters
    ----------
    paths : sequence of Path
        Files with the columns of the old calibration's settings.
    old : SavedCalibration
        As `api.calibrate.documents.load` gives it.

    Raises
    ------
    UnusableDataError
        If the old calibration answers fewer than four of the poses.
    TableError
        As `api.calibrate.table.read_table`.
    """
    readings = joined(
        [readings_of(read_table(path, old.settings.file), old.settings) for path in paths]
    )
    known = np.isfinite(old.predict(readings.features, readings.context)).all(axis=1)
    if known.sum() < _FEWEST:
        raise UnusableDataError(
            f"the old calibration answers {int(known.sum())} of the {len(readings)} poses; a "
            f"correction needs {_FEWEST}: take some inside the field that it was calibrated on"
        )
    readings = readings.only(known)
    before = separation_deg(old.predict(readings.features, readings.context), readings.sun)
    found = Correction(
        "none", (0.0,) * readings.features.shape[1], _plain(np.eye(3)), _rms(before), _rms(before),
        0.0, 0.0, len(readings),
    )  # fmt: skip
    makers: dict[Kind, Callable[[Readings, Any], tuple[Floats, Floats]]] = {"boresight": _turn}
    if readings.kind is not FeatureKind.SIGNALS:
        makers["offset"] = _move
    for kind, fit in makers.items():
        one = _judged(kind, fit, readings, old)
        clear = one.size > _CLEAR * one.uncertainty
        if clear and one.after_deg < _BETTER * found.after_deg:
            found = one
    return found


def _judged(
    kind: Kind,
    fit: Callable[[Readings, Any], tuple[Floats, Floats]],
    readings: Readings,
    old: Any,
) -> Correction:
    offset, rotation = fit(readings, old)
    places = np.arange(len(readings))
    step = max(len(readings) // 20, 1)
    errors, sizes = np.full(len(readings), np.nan), []
    for start in range(0, len(readings), step):
        out = (places >= start) & (places < start + step)
        moved, turned = fit(readings.only(~out), old)
        test = readings.only(out)
        errors[out] = separation_deg(
            old.predict(test.features - moved, test.context) @ turned.T, test.sun
        )
        sizes.append(_size(kind, moved, turned))
    # the jackknife: how much the answer hangs on each block of poses
    blocks = np.array(sizes)
    spread = float(np.sqrt((len(blocks) - 1) * np.mean((blocks - blocks.mean()) ** 2)))
    before = separation_deg(old.predict(readings.features, readings.context), readings.sun)
    return Correction(
        kind, tuple(float(v) for v in offset), _plain(rotation), _rms(before), _rms(errors),
        _size(kind, offset, rotation), spread, len(readings),
    )  # fmt: skip


def _turn(readings: Readings, old: Any) -> tuple[Floats, Floats]:
    """Zero offset, and the rotation from old directions to those of the poses."""
    predicted = old.predict(readings.features, readings.context)
    weight = np.ones(len(predicted))
    rotation = np.eye(3)
    for _ in range(_ROUNDS):
        u, _, vt = np.linalg.svd((readings.sun * weight[:, None]).T @ predicted)
        rotation = u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt
        left = np.linalg.norm(readings.sun - predicted @ rotation.T, axis=1)
        weight = 1.0 / np.maximum(left, max(_USUAL * float(np.median(left)), 1e-12))
    return np.zeros(readings.features.shape[1]), rotation


def _move(readings: Readings, old: Any) -> tuple[Floats, Floats]:
    """Offset of two readings by Gauss and Newton, and no rotation."""
    offset = np.zeros(2)
    width = np.maximum(np.ptp(readings.features, axis=0), 1e-12)
    weight = np.ones(len(readings))
    rounds, largest = 0, 0.1 * width
    for _ in range(_MOST_STEPS):
        at = old.predict(readings.features - offset, readings.context)
        slopes = [
            old.predict(readings.features - offset - axis, readings.context) - at
            for axis in np.diag(width * 1e-4)
        ]
        left = readings.sun - at
        usable = np.isfinite(left).all(axis=1) & np.isfinite(np.hstack(slopes)).all(axis=1)
        if usable.sum() < 3:
            break
        root = np.sqrt(weight[usable])
        design = np.column_stack(
            [
                (slope[usable] * root[:, None]).reshape(-1) / (1e-4 * size)
                for slope, size in zip(slopes, width, strict=True)
            ]
        )
        aim = (left[usable] * root[:, None]).reshape(-1)
        step = np.linalg.lstsq(design, aim, rcond=1e-8)[0]
        cut = np.clip(step, -largest, largest)
        offset = offset + cut
        if (cut == step).all():
            rounds += 1
        else:  # a long way, which few poses close together do not tell
            largest = 2.0 * largest
        size = np.linalg.norm(left, axis=1)
        middle = max(_USUAL * float(np.nanmedian(size)), 1e-12)
        weight = 1.0 / np.maximum(np.nan_to_num(size, nan=np.inf), middle)
        if rounds >= _ROUNDS or (np.abs(step) < 1e-9 * width).all():
            break
    return offset, np.eye(3)


def _size(kind: Kind, offset: Floats, rotation: Floats) -> float:
    if kind == "offset":
        return float(np.linalg.norm(offset))
    return float(np.degrees(np.arccos(np.clip((np.trace(rotation) - 1.0) / 2.0, -1.0, 1.0))))


def _plain(matrix: Floats) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(float(v) for v in row) for row in matrix)


def _rms(errors: Floats) -> float:
    known = errors[np.isfinite(errors)]
    return _RMS_OF_MEDIAN * float(np.median(known)) if len(known) else float("inf")
