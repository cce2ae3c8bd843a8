"""A picture of a dataset under a condition: some of its samples, drawn as what they are.

Frames: a montage from small to large incidence. Profiles: the same as curves. Currents: curves
along one sweep of the turntable, along the time of a flight, else bars. Events: pixels coloured by
the time of their spikes. Only the first samples of a split are rendered, so that it is quick.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats, Observation
from benchmark.datasets import Preset, Samples
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preview_canvas import LINES, MUTED, SHADE, Canvas, Plot, heat, number

#: Samples that are rendered to choose from.
FIRST_SAMPLES = 16
_WIDTH = 1000
_LEFT, _TOP = 24, 78
_TILE, _ACROSS, _DOWN = 208, 4, 2


def preview_png(preset: Preset, condition: str = "nominal") -> bytes:
    """Draw a dataset under a condition; returns PNG.

    Raises
    ------
    ValueError
        On an unknown condition, naming the known ones.
    """
    preset.condition(condition)
    if preset.observation is Observation.FRAMES:
        canvas = _frames(preset, condition)
    elif preset.observation is Observation.PROFILES:
        canvas = _profiles(preset, condition)
    elif preset.observation is Observation.EVENTS:
        canvas = _events(preset, condition)
    else:
        canvas = _currents(preset, condition)
    return canvas.png()


def incidence_deg(sun: Floats) -> Floats:
    """(N,) angle between the Sun and the boresight, degrees."""
    across = np.hypot(sun[:, 0], sun[:, 1])
    return np.asarray(np.degrees(np.arctan2(across, sun[:, 2])))


def _sheet(preset: Preset, condition: str, said: str, height: int) -> Canvas:
    canvas = Canvas(_WIDTH, height)
    canvas.text(_LEFT, 32, f"{preset.name}, {condition}", 22, bold=True)
    canvas.text(_LEFT, 54, said, 13, colour=MUTED)
    return canvas


def _some(preset: Preset, condition: str, most: int) -> tuple[Samples, list[int]]:
    """Return samples of the test split, and which to show: small incidence to large."""
    timed = "context" in preset.card()
    samples = preset.generate(condition, "test", None if timed else FIRST_SAMPLES)
    rows = np.arange(len(samples.sun))
    dark = (samples.context or {}).get("eclipse")
    if dark is not None:
        rows = rows[~dark]
    left = rows[np.argsort(incidence_deg(samples.sun[rows]), kind="stable")].tolist()
    angles = incidence_deg(samples.sun)
    chosen = []
    for wanted in np.linspace(angles[left[0]], angles[left[-1]], min(most, len(left))):
        chosen.append(min(left, key=lambda row: abs(angles[row] - wanted)))
        left.remove(chosen[-1])
    return samples, sorted(chosen, key=lambda row: angles[row])


def _angle(samples: Samples, row: int) -> str:
    return f"{incidence_deg(samples.sun[row : row + 1])[0]:.1f} deg"


def _frames(preset: Preset, condition: str) -> Canvas:
    samples, shown = _some(preset, condition, _ACROSS * _DOWN)
    frames = samples.observations[shown].astype(np.float64)
    high, wide = frames.shape[1:]
    said = (
        f"frames of {wide} x {high} px on one scale; under each the Sun's angle off the boresight"
    )
    low, top = float(frames.min()), float(frames.max())
    canvas = _montage(preset, condition, said)
    for place, (row, frame) in enumerate(zip(shown, frames, strict=True)):
        picture = heat(_fitted((frame - low) / max(top - low, 1e-12)))
        _tile(canvas, place, picture, f"{_angle(samples, row)}, peak {number(frame.max())}")
    canvas.scale(_WIDTH - 96, _TOP + 16, _DOWN * (_TILE + 34) - 66, (low, top), "DN")
    return canvas


def _events(preset: Preset, condition: str) -> Canvas:
    samples, shown = _some(preset, condition, _ACROSS * _DOWN)
    events = samples.observations[shown]  # (N, M, 3): column, row, microseconds; NaN after the last
    times = events[:, :, 2]
    soonest, last = float(np.nanmin(times)), float(np.nanmax(times))
    soonest = max(soonest, 1e-4 * last)
    centre = preset.geometry_for(condition).centre_px or (31.5, 31.5)
    columns, rows = (round(2 * c + 1) for c in centre)
    said = (
        f"spikes on {columns} x {rows} px, coloured by their time; under each the Sun's angle off "
        "the boresight"
    )
    canvas = _montage(preset, condition, said)
    for place, (row, sequence) in enumerate(zip(shown, events, strict=True)):
        found = sequence[np.isfinite(sequence[:, 2])]
        array = np.full((rows, columns), math.nan)
        since = np.log(np.maximum(found[:, 2], soonest) / soonest) / math.log(last / soonest)
        array[found[:, 1].astype(int), found[:, 0].astype(int)] = since
        picture = heat(_fitted(array))
        _tile(canvas, place, picture, f"{_angle(samples, row)}, {len(found)} spikes")
    height = _DOWN * (_TILE + 34) - 66
    canvas.scale(_WIDTH - 96, _TOP + 16, height, (soonest, last), "us", logarithmic=True)
    return canvas


def _montage(preset: Preset, condition: str, said: str) -> Canvas:
    return _sheet(preset, condition, said, _TOP + _DOWN * (_TILE + 34))


def _tile(canvas: Canvas, place: int, picture: NDArray[np.uint8], label: str) -> None:
    x = _LEFT + (place % _ACROSS) * (_TILE + 12)
    y = _TOP + (place // _ACROSS) * (_TILE + 34)
    canvas.box(x, y, _TILE, _TILE, SHADE)
    high, wide = picture.shape[:2]
    canvas.picture(x + (_TILE - wide) // 2, y + (_TILE - high) // 2, picture)
    canvas.text(x, y + _TILE + 16, label, 13)


def _fitted(frame: Floats) -> Floats:
    """Fit a frame into a tile: pixels repeated, or the brightest of each block of pixels."""
    largest = max(frame.shape)
    if largest <= _TILE:
        return frame.repeat(_TILE // largest, axis=0).repeat(_TILE // largest, axis=1)
    for axis in (0, 1):
        size = frame.shape[axis]
        starts = np.arange(size * _TILE // largest) * largest // _TILE
        frame = np.maximum.reduceat(frame, starts, axis=axis)
    return frame


def _profiles(preset: Preset, condition: str) -> Canvas:
    samples, shown = _some(preset, condition, 4)
    profiles = samples.observations[shown].astype(np.float64)
    width = profiles.shape[1]
    each = preset.geometry_for(condition).line_pixels or width
    arrays = "" if each >= width else f", {width // each} arrays of {each} px end to end"
    said = f"read-out of {width} px{arrays}; digital numbers over pixels"
    row_height = 128
    canvas = _sheet(preset, condition, said, _TOP + len(shown) * row_height + 24)
    up = (min(0.0, float(profiles.min())), 1.05 * float(profiles.max()))
    for place, (row, profile) in enumerate(zip(shown, profiles, strict=True)):
        top = _TOP + place * row_height + 18
        area = (_LEFT + 50, top, _WIDTH - _LEFT - 90, row_height - 42)
        lowest = place == len(shown) - 1
        plot = Plot(canvas, area, (0, width - 1), up, x_ticks=lowest, most_y=3)
        for border in range(each, width, each):
            at = plot.x(border - 0.5)
            canvas.line([(at, top), (at, top + area[3])], MUTED)
        plot.curve(np.arange(width), profile, LINES[0])
        canvas.text(area[0], top - 5, _direction(samples.sun[row]), 12)
    return canvas


def _direction(sun: Floats) -> str:
    x, y, z = (float(v) for v in sun)
    if z <= 0.05:
        return f"Sun at ({x:.2f}, {y:.2f}, {z:.2f})"
    alpha, beta = math.degrees(math.atan2(y, z)), math.degrees(math.atan2(x, z))
    return f"alpha {alpha:.1f}, beta {beta:.1f} deg"


def _currents(preset: Preset, condition: str) -> Canvas:
    if "context" in preset.card():
        return _flight(preset, condition)
    if isinstance(preset.directions, AngleField):
        samples = preset.generate(condition, "calibration")
        if samples.observations.shape[1] <= len(LINES):
            return _sweep(preset, condition, samples)
    return _bars(preset, condition)


def _flight(preset: Preset, condition: str) -> Canvas:
    samples = preset.generate(condition, "test")
    context = samples.context or {}
    minutes = (context["time_s"] - context["time_s"][0]) / 60.0
    said = f"signals over minutes of the test split; grey: eclipse; {_unit(preset)}"
    canvas = _sheet(preset, condition, said, 470)
    area = (_LEFT + 50, _TOP + 14, _WIDTH - _LEFT - 90, 320)
    signals = samples.observations
    across = (0.0, float(minutes[-1]))
    first, last = across
    dark = np.flatnonzero(np.diff(np.concatenate([[0], context["eclipse"].astype(int), [0]])))
    for start, stop in dark.reshape(-1, 2):
        left, right = minutes[start], minutes[min(stop, len(minutes) - 1)]
        x = area[0] + area[2] * (left - first) / (last - first)
        canvas.box(x, area[1], area[2] * (right - left) / (last - first), area[3], SHADE)
    plot = Plot(canvas, area, across, _range(signals))
    for k, signal in enumerate(signals.T):
        plot.curve(minutes, signal, LINES[k % len(LINES)])
    _legend(canvas, signals.shape[1])
    return canvas


def _sweep(preset: Preset, condition: str, samples: Samples) -> Canvas:
    sun = samples.sun
    alpha = np.degrees(np.arctan2(sun[:, 1], sun[:, 2]))
    beta = np.degrees(np.arctan2(sun[:, 0], sun[:, 2]))
    # off the middle, where elements that mirror each other would give one and the same curve
    wanted = alpha[np.argmin(np.abs(alpha - alpha.max() / 3.0))]
    row = np.abs(alpha - wanted) < 1e-6
    said = (
        f"signals over beta (deg) at alpha = {wanted:.3g} deg, a sweep of the calibration split; "
        f"{_unit(preset)}"
    )
    canvas = _sheet(preset, condition, said, 470)
    area = (_LEFT + 50, _TOP + 14, _WIDTH - _LEFT - 90, 320)
    signals = samples.observations[row]
    order = np.argsort(beta[row])
    at = beta[row][order]
    plot = Plot(canvas, area, (float(at[0]), float(at[-1])), _range(signals))
    for k, signal in enumerate(signals.T):
        plot.curve(at, signal[order], LINES[k % len(LINES)], 2)
    _legend(canvas, signals.shape[1])
    return canvas


def _bars(preset: Preset, condition: str) -> Canvas:
    samples, shown = _some(preset, condition, 6)
    signals = samples.observations[shown]
    said = f"signals of single samples, element by element; {_unit(preset)}"
    canvas = _sheet(preset, condition, said, _TOP + 2 * 200)
    up = _range(signals)
    for place, (row, values) in enumerate(zip(shown, signals, strict=True)):
        x = _LEFT + 50 + (place % 3) * 322
        y = _TOP + 22 + (place // 3) * 196
        plot = Plot(canvas, (x, y, 250, 134), (0.4, len(values) + 0.6), up, x_ticks=False)
        wide = 250 / (len(values) + 0.2)
        zero = plot.y(max(0.0, up[0]))
        for k, value in enumerate(values.tolist(), start=1):
            top = plot.y(value)
            canvas.box(
                plot.x(k) - 0.36 * wide,
                min(top, zero),
                0.72 * wide,
                abs(zero - top),
                LINES[0],
            )
            if len(values) <= 8 or k % 2:
                canvas.text(plot.x(k), y + 150, str(k), 12, colour=MUTED, align="middle")
        canvas.text(x, y - 6, _direction(samples.sun[row]), 12)
    return canvas


def _range(values: NDArray[Any]) -> tuple[float, float]:
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    low = 0.0 if 0.0 <= low < 0.5 * high else low
    margin = 0.04 * ((high - low) or 1.0)
    return (low if low == 0.0 else low - margin, high + margin)


def _unit(preset: Preset) -> str:
    """Return the unit in words, without the arrays' type and shape."""
    return preset.units.split("(N", maxsplit=1)[0].split(", float", maxsplit=1)[0].rstrip(" ,;")


def _legend(canvas: Canvas, count: int) -> None:
    for k in range(count):
        x, y = _LEFT + 50 + 110 * k, canvas.image.shape[0] - 16
        canvas.box(x, y - 6, 20, 4, LINES[k % len(LINES)])
        canvas.text(x + 26, y, f"signal {k + 1}", 12)
