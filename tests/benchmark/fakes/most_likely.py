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
from benchmark.simulator.sensors.light_to_frequency import FrequencyCounter

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Readout:
    """A converter in whole codes: ``code = signal / step``, signal ``offset + gain light + dark``."""

    step: float
    offset: float
    shot: float  # variance a unit of signal above the offset
    noise: float  # variance
    lowest: float
    highest: float
    gain_spread: float
    dark: float
    dark_spread: float
    end: float  # of the scale of light

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
    if isinstance(part, FrequencyCounter):
        gate = part.gate_s
        last, end = np.floor(part.full_scale_hz * gate), part.full_scale_hz
        return Readout(1 / gate, 0.0, 1 / gate, 0.0, 0.0, last, mismatch, dark, 0.0, end)
    assert isinstance(part, CurrentReadout)
    top, charge = 2.0 ** (part.bits - 1), 1.602176634e-13 / part.integration_s
    if hasattr(sensor, "cells"):
        mismatch = float(np.hypot(mismatch, np.hypot(sensor.cells.mismatch, sensor.cells.loss_spread)))
    return Readout(
        part.full_scale_ua / top, 0.0, charge, part.noise_ua**2, -top, top - 1, mismatch, dark,
        0.0, part.full_scale_ua,
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


def estimated_unit(
    kind: Readout, readings: Mapping[str, Floats], references: References
) -> tuple[Floats, Floats]:
    """Gains and dark signals (elements) of mean dark and flat readings; the design's without any.

    Posterior means of Gaussian spreads: two linear equations an element.
    """
    light = references.level * (kind.end - kind.dark)
    left = np.diag([kind.gain_spread**-2, max(kind.dark_spread, 1e-30) ** -2])
    right = np.array([kind.gain_spread**-2, max(kind.dark_spread, 1e-30) ** -2 * kind.dark])
    total = [np.multiply.outer(right, np.ones(np.shape(next(iter(readings.values()), 0.0))))]
    for name, mean in readings.items():
        row = np.array([light if name.startswith("flat") else 0.0, 1.0])
        count = references.flats if name.startswith("flat") else references.darks
        level = np.array(kind.offset + row[0] + kind.dark)
        weight = count / (kind.step**2 * (float(kind.deviation(level)) ** 2 + 1 / 12))
        left = left + weight * np.outer(row, row)
        total.append(np.multiply.outer(weight * row, mean - kind.offset))
    gain, dark = np.tensordot(np.linalg.inv(left), sum(total), axes=1)
    return gain, dark


def unit_spread(kind: Readout, references: References | None) -> Floats:
    """(2, 2) covariance of an element's gain and dark signal as `estimated_unit` leaves it."""
    if references is None:
        return np.zeros((2, 2))
    left = np.diag([kind.gain_spread**-2, max(kind.dark_spread, 1e-30) ** -2])
    light = references.level * (kind.end - kind.dark)
    for count, bright in ((references.flats, light), (references.darks, 0.0)):
        level = np.array(kind.offset + bright + kind.dark)
        weight = count / (kind.step**2 * (float(kind.deviation(level)) ** 2 + 1 / 12))
        left = left + weight * np.outer([bright, 1.0], [bright, 1.0])
    return np.asarray(np.linalg.inv(left))


def errors_deg(
    setup: Condition, one: Scene, names: tuple[str | int, ...], trials: int,
    references: References | None = None, units: int = 1,
) -> Floats:  # fmt: skip
    """(trials, 2) errors along two tangent axes of estimates of the direction of `one`.

    Every trial draws its irradiance, stray light and noise, and its unit where `units` is as many
    as the trials. With `references` the estimate knows the unit by its flats and darks alone.
    """
    sensor: Any = setup.sensor
    kind, light = readout_of(sensor), setup.irradiance
    built = sensor.fixed_pattern("test", *names, 0)
    plain = plain_pattern(built)
    drawn, stray = light.draw(trials, generator("test", *names, "light"))
    first, second = tangent_axes(one.sun)
    shape = sensor.expected(one, built).shape[1:]
    in_dark = kind.offset if "dark_e" in built else kind.offset + kind.dark

    def base(p: Floats) -> Floats:
        """(N, M) signal of light alone for offsets (rad), irradiance and stray light."""
        count = len(p)
        sun = one.sun + p[:, :1] * first + p[:, 1:2] * second
        sun /= np.linalg.norm(sun, axis=1, keepdims=True)
        origin = None if one.origin_px is None else np.repeat(one.origin_px, count, axis=0)
        scene = Scene(sun, p[:, 2], p[:, 3], origin)
        return np.asarray(sensor.expected(scene, plain).reshape(count, -1) - in_dark)

    seen, gains, darks = [], [], []
    streams = NoiseStreams.named("test", *names, "noise")
    for n in range(trials):
        pattern = built
        if units > 1:
            own = sensor.fixed_pattern("test", *names, n)
            pattern = {**built, **{k: own[k] for k in ("gain", "cells", "dark_e") if k in own}}
        scene = replace(one, irradiance=drawn[n : n + 1], stray=stray[n : n + 1])
        seen.append(sensor.observe(scene, pattern, streams).ravel())
        if references is None:
            gain = element_gains(pattern)
            dark = (
                pattern["dark_e"] / sensor.detector.gain_e_per_dn
                if "dark_e" in pattern
                else np.full(gain.shape, kind.dark)
            )
        else:
            readings = sensor.reference_readings(pattern, references, streams)
            gain, dark = estimated_unit(kind, readings, references)
            gain, dark = (np.broadcast_to(a, element_gains(pattern).shape) for a in (gain, dark))
        gains.append(of_window(gain, one, shape))
        darks.append(of_window(dark, one, shape))
    codes, gain, dark = np.array(seen) / kind.step, np.array(gains), np.array(darks)
    codes = np.rint(codes)
    spread = unit_spread(kind, references)
    typical = np.array([0.0, 0.0, 1.0, light.stray])
    prior = np.array([0.0, 0.0, light.spread**-2, light.stray_spread**-2])
    # derivatives of the light at the truth: they hardly differ within the errors found
    steps = np.array([3e-4, 3e-4, 0.01, light.stray_spread])
    moves = np.repeat([typical], 8, axis=0)
    for k in range(4):
        moves[2 * k, k] += steps[k]
        moves[2 * k + 1, k] -= steps[k]
    swept = base(moves)
    slopes = (swept[::2] - swept[1::2]) / (2 * steps[:, None])
    guess = np.repeat([typical], trials, axis=0)
    for _ in range(4):
        bare = base(guess)
        mean = kind.offset + bare * gain + dark
        wide = bare**2 * spread[0, 0] + 2 * bare * spread[0, 1] + spread[1, 1]
        deviation = np.sqrt(kind.deviation(mean) ** 2 + wide / kind.step**2)
        score, weight = _score(codes, mean / kind.step, deviation, (kind.lowest, kind.highest))
        own = slopes[None] * gain[:, None, :] / kind.step
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
