"""A picture of a dataset under a condition: some of its samples, drawn as what they are.

Frames: a montage from small to large incidence. Profiles: the same as curves. Currents: curves
along one sweep of the turntable, along the time of a flight, else bars. Events: pixels coloured by
the time of their spikes. Only the first samples of a split are rendered, so that it is quick.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats, Observation
from benchmark.datasets import Preset, Samples
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preview_sheet import LINES, MUTED, SHADE, Sheet, number, points, span
from benchmark.plot_style import plain_style

if TYPE_CHECKING:
    from matplotlib.colors import Normalize

#: Samples that are rendered to choose from.
FIRST_SAMPLES = 16
_WIDTH = 1000
_LEFT, _TOP = 24, 78
_TILE, _ACROSS, _DOWN = 208, 4, 2


def preview_png(preset: Preset, condition: str = "nominal") -> bytes:
    """Draw a dataset under a condition; returns PNG.

    ValueError on an unknown condition, naming the known ones.
    """
    preset.condition(condition)
    with plain_style():
        if preset.observation is Observation.FRAMES:
            sheet = _frames(preset, condition)
        elif preset.observation is Observation.PROFILES:
            sheet = _profiles(preset, condition)
        elif preset.observation is Observation.EVENTS:
            sheet = _events(preset, condition)
        else:
            sheet = _currents(preset, condition)
        return sheet.png()


def incidence_deg(sun: Floats) -> Floats:
    """(N,) angle between the Sun and the boresight, degrees."""
    across = np.hypot(sun[:, 0], sun[:, 1])
    return np.asarray(np.degrees(np.arctan2(across, sun[:, 2])))


def _sheet(preset: Preset, condition: str, said: str, height: int) -> Sheet:
    sheet = Sheet(_WIDTH, height)
    sheet.text(_LEFT, 32, f"{preset.name}, {condition}", 22, bold=True)
    sheet.text(_LEFT, 54, said, 13, colour=MUTED)
    return sheet


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


def _frames(preset: Preset, condition: str) -> Sheet:
    samples, shown = _some(preset, condition, _ACROSS * _DOWN)
    frames = samples.observations[shown].astype(np.float64)
    high, wide = frames.shape[1:]
    said = (
        f"frames of {wide} x {high} px on one scale; under each the Sun's angle off the boresight"
    )
    norm = span(frames)
    sheet = _montage(preset, condition, said)
    for place, (row, frame) in enumerate(zip(shown, frames, strict=True)):
        _tile(
            sheet,
            place,
            _fit(frame),
            norm,
            f"{_angle(samples, row)}, peak {number(frame.max())}",
        )
    sheet.scale(_WIDTH - 96, _TOP + 16, _DOWN * (_TILE + 34) - 66, norm, "DN")
    return sheet


def _events(preset: Preset, condition: str) -> Sheet:
    from matplotlib.colors import LogNorm  # noqa: PLC0415 - a second that only pictures need

    samples, shown = _some(preset, condition, _ACROSS * _DOWN)
    events = samples.observations[shown]  # (N, M, 3): column, row, microseconds; NaN after the last
    times = events[:, :, 2]
    soonest, last = float(np.nanmin(times)), float(np.nanmax(times))
    norm = LogNorm(max(soonest, 1e-4 * last), last, clip=True)
    centre = preset.geometry_for(condition).centre_px or (31.5, 31.5)
    columns, rows = (round(2 * c + 1) for c in centre)
    said = (
        f"spikes on {columns} x {rows} px, coloured by their time; under each the Sun's angle off "
        "the boresight"
    )
    sheet = _montage(preset, condition, said)
    for place, (row, sequence) in enumerate(zip(shown, events, strict=True)):
        found = sequence[np.isfinite(sequence[:, 2])]
        array = np.full((rows, columns), math.nan)
        array[found[:, 1].astype(int), found[:, 0].astype(int)] = found[:, 2]
        _tile(sheet, place, _fit(array), norm, f"{_angle(samples, row)}, {len(found)} spikes")
    height = _DOWN * (_TILE + 34) - 66
    sheet.scale(_WIDTH - 96, _TOP + 16, height, norm, "us")
    return sheet


def _montage(preset: Preset, condition: str, said: str) -> Sheet:
    return _sheet(preset, condition, said, _TOP + _DOWN * (_TILE + 34))


def _tile(sheet: Sheet, place: int, picture: Floats, norm: Normalize, label: str) -> None:
    x = _LEFT + (place % _ACROSS) * (_TILE + 12)
    y = _TOP + (place // _ACROSS) * (_TILE + 34)
    sheet.box(x, y, _TILE, _TILE, SHADE)
    high, wide = picture.shape[:2]
    sheet.picture(x + (_TILE - wide) // 2, y + (_TILE - high) // 2, picture, norm)
    sheet.text(x, y + _TILE + 16, label, 13)


def _fit(frame: Floats) -> Floats:
    """Fit a frame into a tile: pixels repeated, or the brightest of each block of pixels."""
    largest = max(frame.shape)
    if largest <= _TILE:
        return frame.repeat(_TILE // largest, axis=0).repeat(_TILE // largest, axis=1)
    for axis in (0, 1):
        size = frame.shape[axis]
        starts = np.arange(size * _TILE // largest) * largest // _TILE
        frame = np.maximum.reduceat(frame, starts, axis=axis)
    return frame


def _profiles(preset: Preset, condition: str) -> Sheet:
    samples, shown = _some(preset, condition, 4)
    profiles = samples.observations[shown].astype(np.float64)
    width = profiles.shape[1]
    each = preset.geometry_for(condition).line_pixels or width
    arrays = "" if each >= width else f", {width // each} arrays of {each} px end to end"
    said = f"read-out of {width} px{arrays}; digital numbers over pixels"
    row_height = 128
    sheet = _sheet(preset, condition, said, _TOP + len(shown) * row_height + 24)
    up = (min(0.0, float(profiles.min())), 1.05 * float(profiles.max()))
    for place, (row, profile) in enumerate(zip(shown, profiles, strict=True)):
        top = _TOP + place * row_height + 18
        area = (_LEFT + 50, top, _WIDTH - _LEFT - 90, row_height - 42)
        plot = sheet.plot(*area, most_y=3)
        plot.set(xlim=(0, width - 1), ylim=up)
        plot.tick_params(labelbottom=place == len(shown) - 1)
        for border in range(each, width, each):
            plot.axvline(border - 0.5, color=MUTED, linewidth=0.8)
        plot.plot(profile, color=LINES[0], linewidth=0.9)
        sheet.text(area[0], top - 5, _direction(samples.sun[row]), 12)
    return sheet


def _direction(sun: Floats) -> str:
    x, y, z = (float(v) for v in sun)
    if z <= 0.05:
        return f"Sun at ({x:.2f}, {y:.2f}, {z:.2f})"
    alpha, beta = math.degrees(math.atan2(y, z)), math.degrees(math.atan2(x, z))
    return f"alpha {alpha:.1f}, beta {beta:.1f} deg"


def _currents(preset: Preset, condition: str) -> Sheet:
    if "context" in preset.card():
        return _flight(preset, condition)
    if isinstance(preset.directions, AngleField):
        samples = preset.generate(condition, "calibration")
        if samples.observations.shape[1] <= len(LINES):
            return _sweep(preset, condition, samples)
    return _bars(preset, condition)


def _flight(preset: Preset, condition: str) -> Sheet:
    samples = preset.generate(condition, "test")
    context = samples.context or {}
    minutes = (context["time_s"] - context["time_s"][0]) / 60.0
    said = f"signals over minutes of the test split; grey: eclipse; {_unit(preset)}"
    signals = samples.observations
    sheet = _sheet(preset, condition, said, 450 + 20 * math.ceil(signals.shape[1] / len(LINES)))
    area = (_LEFT + 50, _TOP + 14, _WIDTH - _LEFT - 90, 320)
    plot = sheet.plot(*area)
    plot.set(xlim=(0.0, float(minutes[-1])), ylim=_range(signals))
    dark = np.flatnonzero(np.diff(np.concatenate([[0], context["eclipse"].astype(int), [0]])))
    for start, stop in dark.reshape(-1, 2):
        plot.axvspan(minutes[start], minutes[min(stop, len(minutes) - 1)], color=SHADE, zorder=0)
    for k, signal in enumerate(signals.T):
        plot.plot(minutes, signal, color=LINES[k % len(LINES)], linewidth=0.9)
    _legend(sheet, signals.shape[1])
    return sheet


def _sweep(preset: Preset, condition: str, samples: Samples) -> Sheet:
    sun = samples.truth
    alpha = np.degrees(np.arctan2(sun[:, 1], sun[:, 2]))
    beta = np.degrees(np.arctan2(sun[:, 0], sun[:, 2]))
    # off the middle, where elements that mirror each other would give one and the same curve
    wanted = alpha[np.argmin(np.abs(alpha - alpha.max() / 3.0))]
    row = np.abs(alpha - wanted) < 1e-6
    said = (
        f"signals over beta (deg) at alpha = {wanted:.3g} deg, a sweep of the calibration split; "
        f"{_unit(preset)}"
    )
    sheet = _sheet(preset, condition, said, 470)
    area = (_LEFT + 50, _TOP + 14, _WIDTH - _LEFT - 90, 320)
    signals = samples.observations[row]
    order = np.argsort(beta[row])
    at = beta[row][order]
    plot = sheet.plot(*area)
    plot.set(xlim=(float(at[0]), float(at[-1])), ylim=_range(signals))
    for k, signal in enumerate(signals.T):
        plot.plot(at, signal[order], color=LINES[k % len(LINES)], linewidth=1.5)
    _legend(sheet, signals.shape[1])
    return sheet


def _bars(preset: Preset, condition: str) -> Sheet:
    samples, shown = _some(preset, condition, 6)
    signals = samples.observations[shown]
    said = f"signals of single samples, element by element; {_unit(preset)}"
    sheet = _sheet(preset, condition, said, _TOP + 2 * 200)
    up = _range(signals)
    for place, (row, values) in enumerate(zip(shown, signals, strict=True)):
        x = _LEFT + 50 + (place % 3) * 322
        y = _TOP + 22 + (place // 3) * 196
        elements = np.arange(1, len(values) + 1)
        plot = sheet.plot(x, y, 250, 134)
        plot.set(xlim=(0.4, len(values) + 0.6), ylim=up)
        plot.bar(elements, values, width=0.72, color=LINES[0])
        written = elements[:: 1 if len(values) <= 8 else 2]
        plot.set_xticks(written, [str(k) for k in written], size=points(12))
        sheet.text(x, y - 6, _direction(samples.sun[row]), 12)
    return sheet


def _range(values: NDArray[Any]) -> tuple[float, float]:
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    low = 0.0 if 0.0 <= low < 0.5 * high else low
    margin = 0.04 * ((high - low) or 1.0)
    return (low if low == 0.0 else low - margin, high + margin)


def _unit(preset: Preset) -> str:
    """Return the unit in words, without the arrays' type and shape."""
    return preset.units.split("(N", maxsplit=1)[0].split(", float", maxsplit=1)[0].rstrip(" ,;")


def _legend(sheet: Sheet, count: int) -> None:
    """Name signals, as many a row as there are colours, above the lower edge."""
    rows = math.ceil(count / len(LINES))
    for k in range(count):
        row, column = divmod(k, len(LINES))
        x, y = _LEFT + 50 + 110 * column, sheet.height - 16 - 20 * (rows - 1 - row)
        sheet.box(x, y - 6, 20, 4, LINES[k % len(LINES)])
        sheet.text(x + 26, y, f"signal {k + 1}", 12)
