"""Conventions of a file found by their likelihood: axes, angles, order of rows, signs of runs.

Each hypothesis changes one thing that a bench may do otherwise, and is judged by how well a
low-order map with the sensor's own geometry explains the file then. Nothing is changed here.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import cast, get_args

import numpy as np

from algorithms.angles import tangents_from_sun
from algorithms.contract import FeatureKind, Floats
from calibrate.causes.kinks import of_kinks
from calibrate.causes.lag import of_rows
from calibrate.causes.laws import of_scale, scale_of_angles
from calibrate.conventions.channels import of_cells, of_faces, of_light, of_quadrants
from calibrate.conventions.finding import BETTER, MUCH_BETTER, Finding
from calibrate.readings import GRAZING, MATRICES, Readings, sun_of_angles
from calibrate.robust import SmoothMap, answer_noise_deg, normalised, robust_map, terms
from calibrate.settings import AngleForm, Settings

#: Directions up to this far off the boresight tell about axes.
_WITHIN_DEG = 60.0
#: Azimuths of a field span more.
_WIDE_AZIMUTH_DEG = 200.0
#: Samples that hypotheses are judged by; more are thinned evenly.
_MOST_JUDGED = 20_000
#: Samples by which noise is told.
_MOST_FOR_NOISE = 2000
#: What is applied first: under rows or angles of others nothing else can be judged.
_ORDER = (
    *("rows", "unit", "angles", "runs", "channels", "light", "quadrants", "faces", "axes"),
    *("boresight", "scale", "kink"),
)
_AMBIGUOUS = {
    "rotate-180": "two inverted outputs, a turn by 180 deg and angles of the other sign look alike",
    "mirror-x": "an inverted x output and an angle of the other sign look the same in the file",
    "mirror-y": "an inverted y output and an angle of the other sign look the same in the file",
    "swap-xy": "exchanged outputs and exchanged angles look the same in the file",
    "rotate-90": "a sensor turned by 90 deg and exchanged outputs, one inverted, look the same",
    "rotate-270": "a sensor turned by 270 deg and exchanged outputs, one inverted, look the same",
    "swap-negated-xy": "exchanged inverted outputs and exchanged negated angles look the same",
}


def findings(
    readings: Readings, settings: Settings, every: Readings | None = None
) -> list[Finding]:
    """Return what the file's conventions seem to be where they are not those stated.

    The most certain first; empty where nothing speaks against the settings. `every` has those
    samples too whose light is behind the sensor as the angles are stated.
    """
    sample = readings.thinned(_MOST_FOR_NOISE)
    noise = answer_noise_deg(sample.features, sample.sun)
    found = list(of_rows(readings, settings, noise))
    if any(one.certain and one.change for one in found):
        return found  # readings of other poses tell nothing else
    readings = readings.thinned(_MOST_JUDGED)
    if readings.kind is FeatureKind.SIGNALS:
        found += _of_runs(readings)
        light = list(of_light(readings, settings, noise))
        found += light if _certain(light) else [*light, *of_faces(readings, settings)]
    else:
        angles = list(_of_angles((every or readings).thinned(_MOST_JUDGED), settings))
        found += angles
        # axes and light follow from directions, which are others under other angles
        if not any(one.certain and _moves_axes(one, settings) for one in angles):
            found += _of_runs(readings)
            found += _of_sensor(readings, settings, noise)
    if not any(one.certain for one in found):
        found += of_scale(readings, scale_of_angles(readings, settings))
        found += of_kinks(readings, settings, noise)
    return sorted(found, key=lambda one: (not one.certain, _ORDER.index(one.about)))


def _certain(found: Sequence[Finding]) -> bool:
    return any(one.certain for one in found)


def _of_sensor(readings: Readings, settings: Settings, noise: float) -> Iterator[Finding]:
    """Yield what the sensor's readings are, each only where those before it are settled."""
    found = list(of_cells(readings, settings))
    found = found or list(of_light(readings, settings, noise))
    if not _certain(found):
        found += of_quadrants(readings, settings)
    yield from found
    if not _certain(found):
        yield from _of_axes(readings)


def _moves_axes(found: Finding, settings: Settings) -> bool:
    """Say whether a form of angles puts directions elsewhere, not only off by their product."""
    return found.about == "angles" and (
        settings.direction.form.startswith("azimuth") or "azimuth" in found.found
    )


def linear_map(readings: Readings) -> tuple[Floats, Floats] | None:
    """Return slope (2, 2) and offset (2,) of features over tangents (s_x/s_z, s_y/s_z), robustly.

    None where the poses near the boresight do not spread both ways.
    """
    tangents = tangents_from_sun(readings.sun)[:, ::-1]
    near = np.linalg.norm(tangents, axis=1) < np.tan(np.radians(_WITHIN_DEG))
    if near.sum() < 8:
        return None
    reach = np.percentile(np.linalg.norm(tangents[near], axis=1), 60)
    near &= np.linalg.norm(tangents, axis=1) <= max(float(reach), 1e-9)
    where = np.column_stack([np.ones(int(near.sum())), tangents[near]])
    singular = np.linalg.svd(where[:, 1:] - where[:, 1:].mean(axis=0), compute_uv=False)
    if len(where) < 8 or singular[1] < 0.05 * singular[0]:
        return None
    weight = np.ones(len(where))
    fit = np.zeros((3, 2))
    for _ in range(20):
        root = np.sqrt(weight)[:, None]
        fit = np.linalg.lstsq(where * root, readings.features[near] * root, rcond=None)[0]
        size = np.linalg.norm(readings.features[near] - where @ fit, axis=1)
        weight = 1.0 / np.maximum(size, max(float(np.median(size)), 1e-15))
    return fit[1:].T, fit[0]


def _of_axes(readings: Readings) -> Iterator[Finding]:
    fit = linear_map(readings)
    if fit is None:
        return
    slope, _ = fit
    scale = np.sqrt(abs(np.linalg.det(slope))) or 1.0
    distance = {
        name: float(np.linalg.norm(np.asarray(matrix) @ slope / scale - np.eye(2)))
        for name, matrix in MATRICES.items()
    }
    as_stated = float(np.linalg.norm(slope / scale - np.eye(2)))
    name = min(distance, key=lambda word: distance[word])
    spread = _spread_deg(readings)
    if distance[name] < BETTER * as_stated and as_stated > 0.75:
        yield Finding(
            "axes",
            f"the readings' axes are those of the sensor frame after {name}",
            as_stated / 2**0.5 * spread,
            distance[name] / 2**0.5 * spread,
            {"apply": (name,)},
            distance[name] < MUCH_BETTER * as_stated,
            _AMBIGUOUS[name],
        )
        slope = np.asarray(MATRICES[name]) @ slope
    turn = float(np.degrees(np.arctan2(slope[1, 0] - slope[0, 1], slope[0, 0] + slope[1, 1])))
    if abs(turn) > 2.0:
        yield Finding(
            "boresight",
            f"the sensor is turned about its boresight by {turn:.1f} deg"
            + (" beside that" if as_stated > 0.75 else ""),
            spread * abs(float(np.radians(turn))),
            0.0,
            {},
            False,
            "models with a free rotation take it up; nothing needs to be changed",
        )


def _of_angles(readings: Readings, settings: Settings) -> Iterator[Finding]:
    if readings.angles is None or settings.direction.form not in get_args(AngleForm):
        return
    stated = cast("AngleForm", settings.direction.form)
    left = {stated: left_deg(readings, readings.sun)}
    angles = readings.angles
    largest = float(np.nanmax(np.abs(angles)))
    if settings.direction.unit == "deg" and largest <= np.pi:
        turned = sun_of_angles(np.degrees(angles), stated)
        if (turned[:, 2] > 0.05).mean() > 0.95:
            after = left_deg(readings, turned)
            before = left[stated] * 180.0 / np.pi  # the same share of a field 57 times as large
            if after < BETTER * before:
                yield Finding(
                    "unit",
                    f"the angles seem to be radians: as degrees none exceeds {largest:.3g} deg",
                    before, after, {"direction": {"unit": "rad"}}, after < MUCH_BETTER * before,
                    "a sensor of a very narrow field measured in degrees would look alike",
                )  # fmt: skip
                return
    for form in get_args(AngleForm):
        if form == stated:
            continue
        if form.startswith("azimuth") and np.ptp(angles[:, 0]) < _WIDE_AZIMUTH_DEG:
            continue
        sun = sun_of_angles(angles, form)
        if not (np.isfinite(sun).all() and (sun[:, 2] > GRAZING).all()):
            continue
        left[form] = left_deg(readings, sun)
    best = min(left, key=lambda word: left[word])
    if best != stated and left[best] < BETTER * left[stated]:
        yield Finding(
            "angles",
            f"the angles seem to be of the form {best}, not {stated}",
            left[stated], left[best], {"direction": {"form": best}},
            left[best] < MUCH_BETTER * left[stated],
            "only sensors that image tangents (pinholes, slits, quadrants) can tell forms apart",
        )  # fmt: skip


def _of_runs(readings: Readings) -> Iterator[Finding]:
    names = readings.run_names
    if len(np.unique(readings.run)) < 2:
        return
    for number in np.unique(readings.run):
        mine = readings.run == number
        if mine.sum() < 20 or (~mine).sum() < 20:
            continue
        others, _ = robust_map(readings.features[~mine], readings.sun[~mine])
        own = readings.only(mine)
        before = _median_deg(others, own.features, own.sun)
        for what, flipped in _flips(own):
            after = _median_deg(others, flipped, own.sun)
            if after < 0.3 * before and after < 0.2 * _spread_deg(own):
                yield Finding(
                    "runs", f"run {names[number]}: {what} of the other sign than in the other runs",
                    before, after, {}, after < 0.15 * before,
                )  # fmt: skip
                break


def _flips(readings: Readings) -> Iterator[tuple[str, Floats]]:
    if readings.features.shape[1] != 2:
        return
    centre = (
        np.median(readings.features, axis=0) if readings.kind is FeatureKind.SPOT else np.zeros(2)
    )
    for what, sign in (("x is", (-1, 1)), ("y is", (1, -1)), ("both are", (-1, -1))):
        yield what, centre + (readings.features - centre) * np.asarray(sign)


def left_deg(readings: Readings, sun: Floats) -> float:
    """Return the RMS residual, degrees, of a projective map with cubic distortion.

    Without the worst tenth.
    """
    finite = np.isfinite(sun).all(axis=1) & (sun[:, 2] > GRAZING)
    used, features = sun[finite], readings.features[finite]
    middle, width = np.median(features, axis=0), np.maximum(np.std(features), 1e-12)
    tangents = tangents_from_sun(used)[:, ::-1]
    scaled = (features - middle) / width
    columns = np.column_stack([np.ones(len(scaled)), scaled])
    radial = (scaled**2).sum(axis=1)[:, None] * scaled
    guess = tangents
    weight = np.ones(len(scaled))
    for _ in range(15):
        root = np.sqrt(weight)
        rows, aims = [], []
        for axis in (0, 1):
            block = np.zeros((len(scaled), 10))
            block[:, 3 * axis : 3 * axis + 3] = columns
            block[:, 6:8] = -guess[:, [axis]] * scaled
            block[:, 8 + axis] = radial[:, axis]
            rows.append(block * root[:, None])
            aims.append(tangents[:, axis] * root)
        fit = np.linalg.lstsq(np.vstack(rows), np.concatenate(aims), rcond=1e-10)[0]
        below = 1.0 + scaled @ fit[6:8]
        guess = np.column_stack(
            [(columns @ fit[3 * a : 3 * a + 3] + radial[:, a] * fit[8 + a]) / below for a in (0, 1)]
        )
        size = np.linalg.norm(guess - tangents, axis=1) / (1.0 + (tangents**2).sum(axis=1))
        weight = 1.0 / np.maximum(size, max(float(np.median(size)), 1e-15))
    kept = np.sort(size)[: max(int(0.9 * len(size)), 1)]
    return float(np.degrees(np.sqrt(np.mean(kept**2))))


def _median_deg(fitted: SmoothMap, features: Floats, sun: Floats) -> float:
    scaled = (normalised(features) - fitted.middle) / fitted.width
    scaled = np.clip(scaled, -3.0, 3.0)
    left = sun - terms(scaled, fitted.degree) @ fitted.coefficients
    return float(np.degrees(np.median(np.linalg.norm(left, axis=1))))


def _spread_deg(readings: Readings) -> float:
    middle = readings.sun.mean(axis=0)
    return float(np.degrees(np.sqrt(np.mean(((readings.sun - middle) ** 2).sum(axis=1)))))
