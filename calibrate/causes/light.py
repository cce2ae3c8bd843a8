"""Level without light, and readings that fall: what the sum of the signals and their products tell.

A sensor whose light falls as the cosine of incidence reads, in all, ``4 d + L cos(theta)``, where
channels of other gains add what goes with the place of the light across them. Four
quadrants under a rectangular opening, or behind a spot that is a product of two profiles, read
``l_i = x_i y_i``: opposite ones have one product, so ``(q1 - d)(q3 - d) = (q2 - d)(q4 - d)``,
whatever the opening's transmission. Each law is believed as far as blocks of poses agree on `d`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from calibrate.readings import Readings
from calibrate.robust import degree_for, nearest, terms

_BLOCKS = 8
#: What a law leaves, over the noise, to be followed.
_FOLLOWED = 1.3
#: Cosine of incidence from behind from which a channel takes no light.
_UNLIT = 0.15
#: Spread of a signal without light over that of all, up to which it is one level.
_FLAT = 0.3
#: Poses without light on a channel that tell its level then.
_FEWEST_UNLIT = 12
#: Standard deviations from which a level is another than stated.
CERTAIN = 5.0
#: Change of light that answers should stand.
LESS_LIGHT = 0.1
#: Change of an answer over its noise that makes its error 1.5 times the noise.
_TOO_MUCH = 1.118
#: Share of a signal's variance that a plane leaves of a cell that is lit everywhere.
_PLANE = 1e-3
#: Cosine of the largest incidence whose tangents are used.
_STEEPEST = 0.1
#: Least change of the light, over the noise, at which stray light and dark are separated.
_CHANGES = 5.0
#: Standard deviations from which a part of the level goes with the light.
_SURELY = 3.0
#: Refractive index of a window that light may have come through.
_GLASS = 1.5


@dataclass(frozen=True)
class Dark:
    """A level without light, in units of readings less the stated dark over gain."""

    level: Floats  # of each column, (K,)
    error: float  # 1-sigma, by what blocks of poses differ; infinite where not known
    by: str  # what told it
    told_apart: bool = False  # whether stray light, which goes with the Sun's, is separated


def reading_noise(values: Floats, sun: Floats) -> Floats:
    """Return the RMS noise (K,) of columns (N, K): what nearest poses leave of a smooth surface.

    The surface errs alike on neighbours. The median of their differences is that of normal errors.
    """
    near = nearest(sun, sun, 2)[1][:, 1]
    degree = degree_for(len(sun), 2)
    places = [(sun, min(degree, 4))]
    if (sun[:, 2] > _STEEPEST).all():  # what images tangents is smooth over tangents
        places = [(sun[:, :2], degree), (sun[:, :2] / sun[:, 2:], degree)]
    found = []
    for place, order in places:
        design = terms(place, order)
        left = values - design @ np.linalg.lstsq(design, values, rcond=1e-10)[0]
        free = 1.0 - min(design.shape[1] / len(sun), 0.5)
        square = np.median((left - left[near]) ** 2, axis=0) / 2.0 / free
        found.append(np.sqrt(square) / 0.6745)
    return np.asarray(np.min(found, axis=0))


def falling(readings: Readings) -> bool:
    """Say whether the sum of readings falls as the cosine of incidence rises."""
    total, cosine = readings.raw.sum(axis=1), readings.sun[:, 2]
    design = np.column_stack([np.ones(len(total)), cosine])
    slope = np.linalg.lstsq(design, total, rcond=None)[0][1]
    with np.errstate(invalid="ignore"):
        goes_with = np.corrcoef(total, cosine)[0, 1]
    return bool(slope < 0 and goes_with < -0.5)


def level_of_sum(readings: Readings) -> Dark:
    """Return the level that the sum of the signals has without light, a share for each column.

    By the cosine, and by the cosine behind a plate of glass: where they do not agree on it, the
    sensor's transmission is not known well enough. Channels take shares of the light that go with
    its tangents and their product: with gains of their own the sum does so, too.
    """
    total, cosine = readings.raw.sum(axis=1), readings.sun[:, 2]
    tangents = readings.sun[:, :2] / np.maximum(cosine, _STEEPEST)[:, None]
    shares = np.column_stack([np.ones(len(total)), tangents, tangents.prod(axis=1)])
    count = readings.raw.shape[1]
    laws = {"the cosine": cosine, "the cosine behind glass": cosine * _transmission(cosine)}
    noise = float(reading_noise(total[:, None], readings.sun)[0])
    found = []
    for light in laws.values():
        design = np.column_stack([np.ones(len(total)), light[:, None] * shares])
        level, error = _by_blocks(design, total, readings.sun)
        fit = np.linalg.lstsq(design, total, rcond=None)[0]
        left = float(np.sqrt(np.mean((total - design @ fit) ** 2)))
        found.append((left, level, error))
    best, other = sorted(found)
    # a law that leaves hardly more than noise is the sensor's, if the other does not
    settled = best[0] < 1.1 * noise < other[0] / 1.1
    error = best[2] if settled else float(np.hypot(best[2], best[1] - other[1]))
    if best[0] > _FOLLOWED * noise:  # another transmission, which a level without light would mimic
        error = np.inf
    return Dark(np.full(count, best[1] / count), error / count, "the sum against the cosine")


def level_of_products(readings: Readings) -> Dark:
    """Return the level at which products of opposite quadrants (N, 4) are equal."""
    slope, product = _of_products(readings.raw)
    level, error = _by_blocks(slope[:, None], product, readings.sun)
    noise = reading_noise(readings.raw, readings.sun)[[2, 3, 0, 1]]
    expected = np.sqrt((((readings.raw - level) * noise) ** 2).sum(axis=1))
    left = np.abs(product - level * slope) / np.maximum(expected, 1e-300)
    if np.median(left) / 0.6745 > _FOLLOWED:  # an opening that is no rectangle
        error = np.inf
    return Dark(np.full(4, level), error, "the products of opposite quadrants")


def without_stray(dark: Dark, readings: Readings) -> Dark:
    """Return a level of quadrants (N, 4) without what surely goes with the light.

    Its error is that of the level at no light. It is what `level_of_products` found where light
    hardly differs from row to row, and tells nothing.
    """
    slope, product = _of_products(readings.raw)
    level = float(dark.level[0])
    light = (readings.raw - level).sum(axis=1) / np.maximum(readings.sun[:, 2], _STEEPEST)
    change = light / light.mean() - 1.0
    noise = float(np.linalg.norm(reading_noise(readings.raw, readings.sun)))
    if not (np.isfinite(dark.error) and np.std(change) > _CHANGES * noise / abs(light.mean())):
        return dark
    # a level, and what there is at the mean light and in proportion to it
    at_none, error = _by_blocks(
        np.column_stack([slope * -change, slope * (1.0 + change)]), product, readings.sun
    )
    if abs(at_none - level) > _SURELY * error:
        level = at_none
    return Dark(np.full(4, level), error, dark.by, told_apart=True)


def _of_products(q: Floats) -> tuple[Floats, Floats]:
    """Return by what a level changes the difference of products of opposite ones, and that (N,)."""
    slope = q[:, 0] + q[:, 2] - q[:, 1] - q[:, 3]
    return slope, q[:, 0] * q[:, 2] - q[:, 1] * q[:, 3]


def level_of_channels(readings: Readings, falls: bool) -> Dark:
    """Return the level of each channel (K,), by poses without light on it, or by the cosine law.

    `falls` says whether readings fall when light rises.
    """
    away = 1.0 if falls else -1.0
    levels, errors = [], []
    for signal in readings.features.T:
        design, slope, linear = plane_of(signal, readings.sun)
        if linear:
            level, error = _by_blocks(design, signal, readings.sun)
        else:
            towards = away * (readings.sun @ (slope / (np.linalg.norm(slope) or 1.0)))
            level, error = _plateau(signal, towards > _UNLIT)
        levels.append(level)
        errors.append(error)
    each, unsure = np.asarray(levels), np.asarray(errors)
    if np.isfinite(unsure).all():  # one converter reads all: levels that agree are one
        weight = 1.0 / np.maximum(unsure, 1e-12) ** 2
        shared = float((weight * each).sum() / weight.sum())
        if (np.abs(each - shared) < 3.0 * unsure).all():
            each = np.full(len(each), shared)
            unsure = np.full(len(each), float(weight.sum()) ** -0.5)
    return Dark(each, float(np.max(unsure)), "the light against the cosine")


def _plateau(signal: Floats, unlit: NDArray[np.bool_]) -> tuple[float, float]:
    """Return the level of a signal where its face has no light, and its error; infinite if none."""
    if unlit.sum() < _FEWEST_UNLIT:
        return 0.0, np.inf
    scatter = float(np.std(signal[unlit]))
    if scatter > _FLAT * float(np.std(signal)):
        return 0.0, np.inf
    return float(np.median(signal[unlit])), float(1.25 * scatter / np.sqrt(unlit.sum()))


def plane_of(signal: Floats, sun: Floats) -> tuple[Floats, Floats, bool]:
    """Return design (N, 4), slope (3,), and whether a signal is a plane of the direction.

    It is one of a cell without anything ahead of it, where light falls on it from all directions.
    """
    design = np.column_stack([np.ones(len(signal)), sun])
    fit = np.linalg.lstsq(design, signal, rcond=1e-12)[0]
    left = float(np.var(signal - design @ fit))
    return design, np.asarray(fit[1:]), left < _PLANE * float(np.var(signal))


def changes_answers(dark: Dark, readings: Readings, noise_deg: float) -> bool:
    """Say whether such a level moves answers, at a tenth less light, by more than their noise.

    The noise is that of single answers, degrees.
    """
    return _moved(dark.level, readings.raw - dark.level, readings.sun) > _TOO_MUCH * noise_deg


def largest_stray(readings: Readings, noise_deg: float) -> float:
    """Return how much of every column, if all see it alike, moves answers by half their noise.

    Of readings without their level in the dark, in their units: of the light as it is, when a tenth
    of it goes. The noise is that of single answers, degrees.
    """
    each = _moved(np.ones(readings.raw.shape[1]), readings.raw, readings.sun)
    return 0.5 * noise_deg / each


def _moved(level: Floats, light: Floats, sun: Floats) -> float:
    """Return by how much answers move if a tenth of such a level is missing, RMS, degrees."""
    share = LESS_LIGHT * np.abs(level).sum() / np.maximum(np.abs(light.sum(axis=1)), 1e-300)
    off = np.sqrt(1.0 - np.clip(sun[:, 2], -1.0, 1.0) ** 2)
    return float(np.degrees(np.sqrt(np.mean((share * off) ** 2))))


def _by_blocks(design: Floats, wanted: Floats, sun: Floats) -> tuple[float, float]:
    """Return the first coefficient of a least-squares fit, and its error by a jackknife of blocks.

    Blocks are sectors of azimuth and rings of the field, so that what a law does not follow shows.
    """
    middle = sun.mean(axis=0)
    apart = sun - middle
    sector = ((np.arctan2(apart[:, 1], apart[:, 0]) / (2 * np.pi) % 1.0) * _BLOCKS).astype(int)
    ring = np.digitize(sun[:, 2], np.quantile(sun[:, 2], [0.25, 0.5, 0.75]))
    whole = float(np.linalg.lstsq(design, wanted, rcond=1e-12)[0][0])
    variance = 0.0
    for block, count in ((sector, _BLOCKS), (ring, 4)):
        without = [
            float(np.linalg.lstsq(design[block != n], wanted[block != n], rcond=1e-12)[0][0])
            for n in range(count)
            if (block != n).sum() > 2 * design.shape[1]
        ]
        if len(without) < count:
            return whole, float("inf")
        scatter = float(np.sum((np.array(without) - np.mean(without)) ** 2))
        variance = max(variance, (count - 1) / count * scatter)
    return whole, float(np.sqrt(variance))


def _transmission(cosine: Floats) -> Floats:
    """Return Fresnel's transmission of an unpolarised ray through a plate of glass."""
    inner = np.sqrt(1.0 - (1.0 - cosine**2) / _GLASS**2)
    square = ((cosine - _GLASS * inner) / (cosine + _GLASS * inner)) ** 2
    along = ((_GLASS * cosine - inner) / (_GLASS * cosine + inner)) ** 2
    return np.asarray(((1 - square) / (1 + square) + (1 - along) / (1 + along)) / 2.0)
