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
from api.calibrate.causes.light import plane_of, reading_noise
from api.calibrate.conventions.channels import level_of
from api.calibrate.conventions.finding import Finding
from api.calibrate.readings import MATRICES, Readings, quadrant_balances, sun_of_angles
from api.calibrate.settings import AngleForm, Settings

#: What a law leaves, over the noise, to be followed.
FOLLOWED = 1.3
#: The same with a factor where the law is not exact: the sensor's own distortion is like one.
_CLOSELY = 1.1
#: Range of factors of angles that are tried, and the smallest change that is reported.
_FACTORS, _LEAST = (0.7, 1.4), 0.003
#: Standard deviations from which a factor is reported, and the step that gives its error.
_CERTAIN, _STEP = 6.0, 0.01
#: What a law leaves without a factor, over that with it, where it is not exact.
_BETTER = 1.15
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

    Attributes
    ----------
    followed : float
        What the law leaves with the angles as stated, over the noise.
    best : float
        The same with the best factor.
    factor : float
        Of the angles as they should be over those stated.
    error : float
        1-sigma of the factor of all angles, if the law is the sensor's.
    axis : str
        Whose angles.
    """

    followed: float
    best: float
    factor: float
    error: float
    axis: str


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
    best = Scale(as_stated, as_stated, 1.0, np.inf, "")
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
            best = Scale(as_stated, float(found.fun), float(found.x), np.inf, axis)
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


def of_scale(readings: Readings, settings: Settings, known: Scale) -> Iterator[Finding]:
    """Yield the factor of the angles with which a law is followed that is broken without.

    The laws of cells and of cameras are exact. That of quadrants, or another sensor's, may be off
    by a small cause that a factor takes up too.
    """
    exact = readings.kind is FeatureKind.SIGNALS or settings.readings.kind in ("spot", "frames")
    inside = _FACTORS[0] + 0.02 < known.factor < _FACTORS[1] - 0.02
    off = abs(known.factor - 1.0)
    better = settings.readings.kind == "quadrants" or known.followed > FOLLOWED
    better &= known.followed > _BETTER * known.best
    told = known.best < (FOLLOWED if exact else _CLOSELY) and (exact or better)
    # what the law leaves with a factor is the sensor's own, and a factor may take up as much of it
    told &= known.followed**2 - known.best**2 > max(known.best**2 - 1.0, 0.0)
    gain = readings.thinned(_MOST).features.size * ((known.followed / known.best) ** 2 - 1.0)
    if not (told and inside and gain > _CERTAIN**2 and off > _LEAST):
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
    return known.followed < FOLLOWED and moved < noise_deg


def _scaled(
    readings: Readings, settings: Settings
) -> Iterator[tuple[str, Callable[[float], Floats]]]:
    """Yield ways to multiply the table's angles, with a word for the angles."""
    form = cast("AngleForm", settings.direction.form)
    if readings.angles is None:
        angles = angles_from_sun(readings.sun)
        if not np.isfinite(angles).all():
            return
        yield "all angles", lambda factor: sun_from_angles(_near_circle(angles * factor))
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


def _near_circle(angles: Floats) -> Floats:
    return np.clip(angles, -89.0, 89.0)


def _left_of_projection(features: Floats, sun: Floats, noise: Floats) -> float:
    """Return the RMS, over the noise, of what a projection of the directions leaves of readings."""
    front = sun[:, 2] > np.cos(np.radians(_WITHIN_DEG))
    if front.sum() < 20:
        return _NONE
    tangents, seen = sun[front, :2] / sun[front, 2:], features[front]
    middle, width = np.median(seen, axis=0), max(float(np.std(seen)), 1e-300)
    aims = (seen - middle) / width
    columns = np.column_stack([np.ones(len(aims)), tangents])
    below = np.ones(len(aims))
    weight = np.ones(len(aims))
    size = np.zeros(len(aims))
    for _ in range(_ROUNDS):
        root = np.sqrt(weight) / below
        block = np.zeros((2, len(aims), 8))
        for axis in (0, 1):
            block[axis, :, 3 * axis : 3 * axis + 3] = columns
            block[axis, :, 6:] = -aims[:, [axis]] * tangents
        design = (block * root[:, None]).reshape(-1, 8)
        fit = np.linalg.lstsq(design, (aims.T * root).reshape(-1), rcond=1e-12)[0]
        below = 1.0 + tangents @ fit[6:]
        below = np.where(np.abs(below) > 0.05, below, 0.05)
        made = (columns @ fit[:6].reshape(2, 3).T) / below[:, None]
        size = np.sqrt(np.mean(((made - aims) * width / noise) ** 2, axis=1))
        weight = 1.0 / np.maximum(size, max(float(np.median(size)), 1e-12))
    return _trimmed(size)


def _left_of_cells(features: Floats, sun: Floats, noise: Floats) -> float:
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
        fit = np.linalg.lstsq(used, signal[lit], rcond=1e-12)[0]
        free = len(used) / max(len(used) - used.shape[1], 1)
        left.append(free**0.5 * _trimmed(np.abs(signal[lit] - used @ fit) / of_one))
    return float(np.sqrt(np.mean(np.square(left))))


def _trimmed(size: Floats) -> float:
    """Return the RMS without the worst twentieth, of normal errors that of all."""
    kept = np.sort(size)[: max(int(0.95 * len(size)), 1)]
    return float(np.sqrt(np.mean(kept**2)) / 0.871)
