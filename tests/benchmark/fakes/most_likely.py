"""A maximum-likelihood estimate of the direction, by the chances of whole codes; for tests alone.

It shares the sensors' mean signal with the bounds, and nothing else: noise, codes and ends are
written down anew, and the unit's elements are estimated from its flats and darks.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr

from benchmark.datasets import Condition
from benchmark.seeds import generator
from benchmark.simulator.light.sun_disc import tangent_axes
from benchmark.simulator.readout.detectors import CurrentReadout, PixelArray
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.readout.references import References
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.opto_isolator import OptoIsolatorSensor

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Readout:
    """A converter: ``code = round(signal / step)``, signal ``offset + gain light + dark``."""

    step: float
    offset: float
    shot: float  # variance a unit of signal above the offset
    noise: float  # variance
    lowest: float
    highest: float
    gain_spread: float
    dark: float
    dark_spread: float
    end: float  # of the scale that flats are a share of

    def deviation(self, signal: Floats) -> Floats:
        """Before rounding, in codes."""
        seen = np.maximum(signal - self.offset, 0.0)
        return np.asarray(np.sqrt(self.shot * seen + self.noise) / self.step)


def readout_of(sensor: Any) -> Readout:
    part = sensor.readout if hasattr(sensor, "readout") else sensor.detector
    if isinstance(part, PixelArray):
        unit = part.gain_e_per_dn
        dark = part.dark.level() * part.exposure_s / unit
        well = part.offset_dn + part.full_well_e / unit
        last = min(2.0**part.bits - 1, float(np.rint(well)))
        return Readout(
            1.0, part.offset_dn, 1 / unit, (part.read_noise_e / unit) ** 2, 0.0, last,
            part.prnu, dark, part.dsnu * dark, last - part.offset_dn,
        )  # fmt: skip
    mismatch, dark = part.gain_mismatch, part.dark.level()
    dimmed = 0.5 if isinstance(sensor, OptoIsolatorSensor) else 1.0
    assert isinstance(part, CurrentReadout)
    top, charge = 2.0 ** (part.bits - 1), 1.602176634e-13 / part.integration_s
    if hasattr(sensor, "cells"):
        mismatch = float(
            np.hypot(mismatch, np.hypot(sensor.cells.mismatch, sensor.cells.loss_spread))
        )
    return Readout(
        part.full_scale_ua / top, 0.0, charge, part.noise_ua**2, -top, top - 1, mismatch, dark,
        0.0, dimmed * part.full_scale_ua,
    )  # fmt: skip


def log_chance(code: Floats, mean: Floats, deviation: Floats, ends: tuple[float, float]) -> Floats:
    """Logarithm of the chance of a code for means and deviations in codes."""
    above = np.where(code >= ends[1], np.inf, (code + 0.5 - mean) / deviation)
    below = np.where(code <= ends[0], -np.inf, (code - 0.5 - mean) / deviation)
    # from the side where both are small: Phi(above) - Phi(below) = Phi(-below) - Phi(-above)
    flip = below > 0
    upper, lower = np.where(flip, -below, above), np.where(flip, -above, below)
    high = log_ndtr(upper)
    return np.asarray(high + np.log(-np.expm1(np.minimum(log_ndtr(lower) - high, -1e-300))))


def plain_pattern(pattern: Mapping[str, Floats]) -> dict[str, Floats]:
    """The unit without its elements' own gains and dark signals."""
    ones = {name: np.ones_like(pattern[name]) for name in ("gain", "cells") if name in pattern}
    dark = {"dark_e": np.zeros_like(pattern["dark_e"])} if "dark_e" in pattern else {}
    return {**pattern, **ones, **dark}


def element_gains(pattern: Mapping[str, Floats]) -> Floats:
    """Of each element, everything that scales its light."""
    return np.asarray(pattern["gain"] * (pattern["cells"].min(axis=1) if "cells" in pattern else 1))


def of_window(array: Floats, scene: Scene, shape: tuple[int, ...]) -> Floats:
    """The part of a detector's array that a single sample shows, flat."""
    if array.ndim == 1 or scene.origin_px is None:
        return array.ravel()
    x, y = scene.origin_px[0]
    return array[y : y + shape[0], x : x + shape[1]].ravel()


def _known(kind: Readout, references: References) -> list[tuple[str, Floats, float]]:
    """By kind of reading: its derivatives over gain and dark signal, and its weight."""
    light = references.level * (kind.end - kind.dark)
    found = []
    for name, count, bright in (("flat", references.flats, light), ("dark", references.darks, 0.0)):
        deviation = float(kind.deviation(np.array(kind.offset + bright + kind.dark)))
        weight = count / (kind.step**2 * (deviation**2 + 1 / 12))
        found.append((name, np.array([bright, 1.0]), weight))
    return found


def _prior(kind: Readout) -> Floats:
    return np.array([kind.gain_spread**-2, max(kind.dark_spread, 1e-30) ** -2])


def unit_spread(kind: Readout, references: References | None) -> Floats:
    """(2, 2) covariance of an element's gain and dark signal as `estimated_unit` leaves it."""
    if references is None:
        return np.zeros((2, 2))
    rows = _known(kind, references)
    left = sum((weight * np.outer(row, row) for _, row, weight in rows), np.diag(_prior(kind)))
    return np.asarray(np.linalg.inv(left))


def estimated_unit(
    kind: Readout, readings: Mapping[str, Floats], references: References, shape: tuple[int, ...]
) -> tuple[Floats, Floats]:
    """Gains and dark signals (`shape`) of mean dark and flat readings; the design's without any.

    Posterior means of Gaussian spreads: two linear equations an element.
    """
    right = np.multiply.outer(_prior(kind) * [1.0, kind.dark], np.ones(shape))
    for name, row, weight in _known(kind, references):
        for mean in (array for key, array in readings.items() if key.startswith(name)):
            right += np.multiply.outer(weight * row, mean - kind.offset)
    gain, dark = np.tensordot(unit_spread(kind, references), right, axes=1)
    return gain, dark


@dataclass(frozen=True)
class Trials:
    """Codes (N, M) of N trials, and what the estimate takes for the elements' gains and darks."""

    codes: Floats
    gain: Floats
    dark: Floats


def drawn(
    setup: Condition,
    one: Scene,
    names: tuple[str | int, ...],
    count: int,
    references: References | None,
) -> Trials:
    """Draw irradiance, stray light, noise and, with references, a unit and its readings."""
    sensor: Any = setup.sensor
    kind = readout_of(sensor)
    built = sensor.fixed_pattern("test", *names, 0)
    shape = sensor.expected(one, built).shape[1:]
    light, stray = setup.irradiance.draw(count, generator("test", *names, "light"))
    streams = NoiseStreams.named("test", *names, "noise")
    codes, gains, darks = [], [], []
    for n in range(count):
        own = sensor.fixed_pattern("test", *names, n if references else 0)
        # assembly, normals and masks stay those of one unit: they count as known
        pattern = {**built, **{k: own[k] for k in ("gain", "cells", "dark_e") if k in own}}
        scene = replace(one, irradiance=light[n : n + 1], stray=stray[n : n + 1])
        codes.append(np.rint(sensor.observe(scene, pattern, streams).ravel() / kind.step))
        gain = element_gains(pattern)
        if references is not None:
            readings = sensor.reference_readings(pattern, references, streams)
            gain, dark = estimated_unit(kind, readings, references, gain.shape)
        elif "dark_e" in pattern:
            dark = pattern["dark_e"] / sensor.detector.gain_e_per_dn
        else:
            dark = np.full(gain.shape, kind.dark)
        gains.append(of_window(gain, one, shape))
        darks.append(of_window(dark, one, shape))
    return Trials(np.array(codes), np.array(gains), np.array(darks))


def errors_deg(
    setup: Condition,
    one: Scene,
    names: tuple[str | int, ...],
    trials: int,
    references: References | None = None,
) -> Floats:
    """(trials, 2) errors along two tangent axes of estimates of the direction of `one`.

    Every trial draws its irradiance, stray light and noise. With `references` every trial is of
    another unit, of which the estimate knows what its flats and darks tell; without, of one unit
    that is known.
    """
    seen = drawn(setup, one, names, trials, references)
    sensor: Any = setup.sensor
    kind, light = readout_of(sensor), setup.irradiance
    built = sensor.fixed_pattern("test", *names, 0)
    plain = plain_pattern(built)
    in_dark = kind.offset if "dark_e" in built else kind.offset + kind.dark
    first, second = tangent_axes(one.sun)

    def base(p: Floats) -> Floats:
        """(N, M) signal of light alone for offsets (rad), irradiance and stray light."""
        count = len(p)
        sun = one.sun + p[:, :1] * first + p[:, 1:2] * second
        sun /= np.linalg.norm(sun, axis=1, keepdims=True)
        origin = None if one.origin_px is None else np.repeat(one.origin_px, count, axis=0)
        scene = Scene(sun, p[:, 2], p[:, 3], origin)
        return np.asarray(sensor.expected(scene, plain).reshape(count, -1) - in_dark)

    spread = unit_spread(kind, references)
    typical = np.array([0.0, 0.0, 1.0, light.stray])
    prior = np.array([0.0, 0.0, light.spread**-2, light.stray_spread**-2])
    # derivatives of the light at the truth: they hardly differ within the errors found
    steps = np.array([3e-4, 3e-4, 0.01, light.stray_spread])
    swept = base(typical + np.concatenate([np.diag(steps), -np.diag(steps)]))
    slopes = (swept[:4] - swept[4:]) / (2 * steps[:, None])
    guess = np.repeat([typical], trials, axis=0)
    for _ in range(4):
        bare = base(guess)
        mean = kind.offset + bare * seen.gain + seen.dark
        wide = bare**2 * spread[0, 0] + 2 * bare * spread[0, 1] + spread[1, 1]
        deviation = np.sqrt(kind.deviation(mean) ** 2 + wide / kind.step**2)
        ends = kind.lowest, kind.highest
        score, weight = _score(seen.codes, mean / kind.step, deviation, ends)
        own = slopes[None] * seen.gain[:, None, :] / kind.step
        left = np.einsum("nim,nm,njm->nij", own, weight, own) + np.diag(prior)
        right = np.einsum("nim,nm->ni", own, score) - prior * (guess - typical)
        guess = guess + np.linalg.solve(left, right[:, :, None])[:, :, 0]
    return np.degrees(guess[:, :2])


def _score(
    codes: Floats, mean: Floats, deviation: Floats, ends: tuple[float, float]
) -> tuple[Floats, Floats]:
    """Derivative over the mean of the logarithm of the codes' chance, and a weight for the step."""
    h = 1e-3 * deviation
    plus, none, minus = (log_chance(codes, mean + s * h, deviation, ends) for s in (1, 0, -1))
    slope = (plus - minus) / (2 * h)
    curvature = -(plus - 2 * none + minus) / h**2
    # of a log-concave likelihood; rounding of the second difference is kept out
    return slope, np.maximum(curvature, 1e-3 / (deviation**2 + 1 / 12))
