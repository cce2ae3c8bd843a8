"""Laws of sensors that a file may follow down to its noise, and the scale of its angles by them.

A camera images tangents by a projection, and a plain cell takes light by the cosine. Where such a
law leaves no more than noise, the angles of the table are right by it; where it does so only with
angles multiplied by a factor, the table's scale is wrong.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from algorithms.angles import angles_from_sun, sun_from_angles
from algorithms.contract import FeatureKind, Floats
from calibrate.causes.light import plane_of, reading_noise
from calibrate.conventions.channels import level_of
from calibrate.conventions.finding import Finding
from calibrate.readings import MATRICES, Readings, quadrant_balances, sun_of_angles
from calibrate.settings import AngleForm, Settings

#: What a law leaves, over the noise, to be followed.
FOLLOWED = 1.3
#: Range of factors of angles that are tried, and the smallest change that is reported.
_FACTORS, _LEAST = (0.7, 1.4), 0.003
#: Standard deviations from which a factor is reported, and the step that gives its error.
_CERTAIN, _STEP = 6.0, 0.01
_WITHIN_DEG = 75.0
#: Stands for what a law leaves of samples that do not tell.
_NONE = 1e6
_MOST = 600
_ROUNDS = 8
#: Cosine of incidence from which a cell is taken for lit.
_LIT = 0.2
UNTESTED = (
    "the scale of the angles: no law of such sensors that the readings follow down to their noise "
    "tells it as well as answers are; directions of a second turntable would test it"
)


@dataclass(frozen=True)
class Scale:
    """The scale of a table's angles, by the law of the sensor.

    What the law leaves is over the noise. `bent` is that where the sensor may depart from the law
    by a term of its own: cells by the square of the cosine, cameras by radial distortion.
    """

    followed: float  # what the law leaves with the angles as stated
    bent: float
    best: float  # the same with the best factor
    factor: float  # of the angles as they should be over those stated
    error: float  # 1-sigma of the factor of all angles, if the law is the sensor's
    axis: str  # whose angles


def scale_of_angles(readings: Readings, settings: Settings) -> Scale:
    """Return how far a law of such sensors is followed, as stated and with a factor."""
    from scipy.optimize import minimize_scalar  # noqa: PLC0415 - SciPy, at the first use

    used = readings.thinned(_MOST)
    features = _without_dark(used, settings)
    noise = np.maximum(reading_noise(features, used.sun), 1e-12)
    law = _left_of_cells if readings.kind is FeatureKind.SIGNALS else _left_of_projection

    def left(turned: Callable[[float], Floats], factor: float) -> float:
        return law(features, turned(factor), noise)

    as_stated = law(features, used.sun, noise)
    bent = law(features, used.sun, noise, bent=True)
    best = Scale(as_stated, bent, as_stated, 1.0, np.inf, "")
    if as_stated >= _NONE:
        return best
    error = np.inf
    for axis, turned in _scaled(used, settings):
        of_factor = partial(left, turned)
        found = minimize_scalar(
            of_factor, bounds=_FACTORS, method="bounded", options={"xatol": 1e-4}
        )
        if not np.isfinite(error):  # of all angles, which come first
            error = _error_of_factor(of_factor, found, used)
        if found.fun < best.best:
            best = replace(best, best=float(found.fun), factor=float(found.x), axis=axis)
    return replace(best, error=error)


def _without_dark(readings: Readings, settings: Settings) -> Floats:
    """Return features, of quadrants without a level that their products tell, however small."""
    if settings.readings.kind != "quadrants":
        return readings.features
    dark = level_of(readings, settings)
    if not np.abs(dark.level).max() > _CERTAIN * dark.error:
        return readings.features
    features = quadrant_balances(readings.raw - dark.level)
    for transform in settings.apply:
        features = features @ np.asarray(MATRICES[transform]).T
    return features if np.isfinite(features).all() else readings.features


def _error_of_factor(left: Callable[[float], float], found: Any, readings: Readings) -> float:
    """Return the 1-sigma of a factor, by the curvature of the sum of squares around it."""
    count = readings.features.size
    around = [left(found.x + step) ** 2 for step in (-_STEP, _STEP)]
    bend = (sum(around) - 2.0 * found.fun**2) / _STEP**2
    return float(np.sqrt(2.0 * found.fun**2 / count / bend)) if bend > 0 else float("inf")


def of_scale(readings: Readings, known: Scale) -> Iterator[Finding]:
    """Yield the factor of the angles with which a law is followed that is broken without.

    A factor that explains no more than a departure of the sensor from the law is not told from it.
    """
    inside = _FACTORS[0] + 0.02 < known.factor < _FACTORS[1] - 0.02
    off = abs(known.factor - 1.0)
    if not (
        known.best < FOLLOWED and inside and off > _LEAST and _gains(known.bent, known, readings)
    ):
        return
    law = "cells" if readings.kind is FeatureKind.SIGNALS else "a projection"
    yield Finding(
        "scale",
        f"{known.axis} of the table seem to be {100.0 * abs(1.0 / known.factor - 1.0):.2g} % too "
        f"{'large' if known.factor < 1.0 else 'small'}: {law} of the directions leaves "
        f"{known.best:.2g} times the noise with a factor of {known.factor:.4g} and "
        f"{known.followed:.2g} times without",
        known.followed, known.best, {}, True,
        "optics with a distortion of the same shape would look alike",
    )  # fmt: skip


def settles_scale(known: Scale, readings: Readings, noise_deg: float) -> bool:
    """Say whether a law tells the scale of the angles as well as single answers are."""
    off = np.degrees(np.arccos(np.clip(readings.sun[:, 2], -1.0, 1.0)))
    moved = 2.0 * known.error * float(np.sqrt(np.mean(off**2)))
    # a factor explains something, but so would the sensor's own departure from the law
    unclear = _gains(known.followed, known, readings)
    return known.followed < FOLLOWED and moved < noise_deg and not unclear


def _gains(left: float, known: Scale, readings: Readings) -> bool:
    """Say whether the best factor leaves certainly less than what is left without it."""
    count = readings.thinned(_MOST).features.size
    return count * ((left / known.best) ** 2 - 1.0) > _CERTAIN**2


def _scaled(
    readings: Readings, settings: Settings
) -> Iterator[tuple[str, Callable[[float], Floats]]]:
    """Yield ways to multiply the table's angles, with a word for the angles."""
    form = cast("AngleForm", settings.direction.form)
    if readings.angles is None:
        angles = angles_from_sun(readings.sun)
        if np.isfinite(angles).all():
            yield "all angles", lambda factor: sun_from_angles(_near_circle(angles * factor))
        yield "angles off the axis", partial(_off_axis, readings.sun)
        return
    stated = readings.angles
    if form.startswith("azimuth"):
        middle = 90.0 if form == "azimuth-elevation" else 0.0
        yield (
            f"angles off the axis ({settings.direction.columns[1]})",
            lambda factor: sun_of_angles(
                np.column_stack([stated[:, 0], middle + factor * (stated[:, 1] - middle)]), form
            ),
        )
        return
    first, second = settings.direction.columns
    for word, at in (("all angles", (1, 1)), (f"the {first}", (1, 0)), (f"the {second}", (0, 1))):
        yield word, _times(stated, np.asarray(at), form)


def _times(stated: Floats, which: NDArray[np.int64], form: AngleForm) -> Callable[[float], Floats]:
    """Return directions by the factor of some of the angles."""
    return lambda factor: sun_of_angles(_near_circle(stated * (1 + which * (factor - 1))), form)


def _off_axis(sun: Floats, factor: float) -> Floats:
    """Return directions (N, 3) whose angles from the boresight are multiplied by a factor."""
    off = np.arctan2(np.hypot(sun[:, 0], sun[:, 1]), sun[:, 2])
    turn = np.arctan2(sun[:, 1], sun[:, 0])
    return np.column_stack(
        [np.sin(factor * off) * np.cos(turn), np.sin(factor * off) * np.sin(turn),
         np.cos(factor * off)]
    )  # fmt: skip


def _near_circle(angles: Floats) -> Floats:
    return np.clip(angles, -89.0, 89.0)


def _left_of_projection(
    features: Floats, sun: Floats, noise: Floats, *, bent: bool = False
) -> float:
    """Return the RMS, over the noise, of what a projection of the directions leaves of readings."""
    front = sun[:, 2] > np.cos(np.radians(_WITHIN_DEG))
    if front.sum() < 20:
        return _NONE
    tangents, seen = sun[front, :2] / sun[front, 2:], features[front]
    middle, width = np.median(seen, axis=0), max(float(np.std(seen)), 1e-300)
    aims = (seen - middle) / width
    columns = np.column_stack([np.ones(len(aims)), tangents])
    if bent:
        columns = np.column_stack([columns, tangents * (tangents**2).sum(axis=1)[:, None]])
    terms = columns.shape[1]
    below = np.ones(len(aims))
    weight = np.ones(len(aims))
    size = np.zeros(len(aims))
    for _ in range(_ROUNDS):
        root = np.sqrt(weight) / below
        block = np.zeros((2, len(aims), 2 * terms + 2))
        for axis in (0, 1):
            block[axis, :, terms * axis : terms * (axis + 1)] = columns
            block[axis, :, 2 * terms :] = -aims[:, [axis]] * tangents
        design = (block * root[:, None]).reshape(-1, 2 * terms + 2)
        fit = np.linalg.lstsq(design, (aims.T * root).reshape(-1), rcond=1e-12)[0]
        below = 1.0 + tangents @ fit[2 * terms :]
        below = np.where(np.abs(below) > 0.05, below, 0.05)
        made = (columns @ fit[: 2 * terms].reshape(2, terms).T) / below[:, None]
        size = np.sqrt(np.mean(((made - aims) * width / noise) ** 2, axis=1))
        weight = 1.0 / np.maximum(size, max(float(np.median(size)), 1e-12))
    return _trimmed(size)


def _left_of_cells(features: Floats, sun: Floats, noise: Floats, *, bent: bool = False) -> float:
    """Return the RMS, over the noise, of what cosines leave of lit cells' signals."""
    left = []
    for signal, of_one in zip(features.T, noise, strict=True):
        design, slope, linear = plane_of(signal, sun)
        normal = slope / (np.linalg.norm(slope) or 1.0)
        for _ in range(1 if linear else 10):
            lit = np.ones(len(sun), dtype=np.bool_) if linear else sun @ normal > _LIT
            if lit.sum() < 12:
                return _NONE
            fit = np.linalg.lstsq(sun[lit], signal[lit], rcond=1e-12)[0]
            normal = fit / (np.linalg.norm(fit) or 1.0)
        used = design[lit] if linear else sun[lit]
        if bent:
            used = np.column_stack([used, (sun[lit] @ normal) ** 2])
        fit = np.linalg.lstsq(used, signal[lit], rcond=1e-12)[0]
        free = len(used) / max(len(used) - used.shape[1], 1)
        left.append(free**0.5 * _trimmed(np.abs(signal[lit] - used @ fit) / of_one))
    return float(np.sqrt(np.mean(np.square(left))))


def _trimmed(size: Floats) -> float:
    """Return the RMS without the worst twentieth, of normal errors that of all."""
    kept = np.sort(size)[: max(int(0.95 * len(size)), 1)]
    return float(np.sqrt(np.mean(kept**2)) / 0.871)
