"""A picture of frames with the places that an extractor found in them drawn on top.

A row of samples a condition; a green ring about the true place where the simulator can say
it, an orange cross where the extractor says it is, and under each frame how far apart they are.
The frames are cut to the surroundings of the Sun, which is what there is to see.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from algorithms.contract import Extractor, FeatureKind, Floats, Observation
from benchmark.datasets import Preset, Samples
from benchmark.datasets.preview_sheet import LINES, MUTED, Sheet, heat
from benchmark.plot_style import plain_style
from benchmark.simulator.sensors.black_sun import BlackSunSensor
from benchmark.simulator.sensors.blooming import BloomingSensor

#: Sensors whose image of the Sun's centre is known whatever their pixels make of it.
_CAMERAS = (BlackSunSensor, BloomingSensor)
_ACROSS = 4
_TILE, _GAP, _LEFT, _TOP = 232, 14, 24, 84
_FOUND, _TRUE = LINES[1], LINES[2]
_SAID = "orange cross: found; each picture on its own scale"
_SAID_OF_CAMERAS = f"green ring: the Sun's true image; {_SAID}"
_CUT_PX = 116
"""Pixels that a tile shows each way, where the frame has more."""


class OverlayError(ValueError):
    """A dataset and an extractor of which no overlay can be drawn."""


def overlay_png(
    preset: Preset,
    extractor: type[Extractor],
    conditions: Sequence[str] | None = None,
) -> bytes:
    """Draw what an extractor finds in a dataset's frames; returns PNG.

    A row of pictures for each condition, all by default. OverlayError on a dataset without frames
    or an extractor of no spots, ValueError on an unknown condition, and where the extractor refuses
    the design.
    """
    if preset.observation is not Observation.FRAMES or extractor.about.kind is not FeatureKind.SPOT:
        raise OverlayError(
            f"overlays show spots on frames; {preset.name} has {preset.observation} and "
            f"{extractor.about.name} gives {extractor.about.kind}"
        )
    if extractor.about.observation is not preset.observation:
        raise OverlayError(
            f"{extractor.about.name} reads {extractor.about.observation}, not frames"
        )
    chosen = tuple(conditions or preset.conditions)
    for condition in chosen:
        preset.condition(condition)
    row = _TILE + 52
    with plain_style():
        sheet = Sheet(2 * _LEFT + _ACROSS * (_TILE + _GAP) - _GAP, _TOP + len(chosen) * row)
        sheet.text(_LEFT, 32, f"{preset.name}: {extractor.about.name}", 22, bold=True)
        known = any(isinstance(preset.condition(name).sensor, _CAMERAS) for name in chosen)
        sheet.text(_LEFT, 54, _SAID_OF_CAMERAS if known else _SAID, 13, colour=MUTED)
        for place, condition in enumerate(chosen):
            top = _TOP + place * row
            sheet.text(_LEFT, top - 6, condition, 14, bold=True)
            _condition(sheet, preset, extractor, condition, top)
        return sheet.png()


def true_places(preset: Preset, condition: str, samples: Samples) -> Floats:
    """(N, 2) where the Sun's centre is imaged in each frame, px; NaN where none can say."""
    sensor = preset.condition(condition).sensor
    if isinstance(sensor, _CAMERAS):
        return sensor.camera.image_px(samples.sun) - _origins(samples)
    return np.full((len(samples.sun), 2), math.nan)


def _origins(samples: Samples) -> Floats:
    if samples.origin_px is None:
        return np.zeros((len(samples.sun), 2))
    return np.asarray(samples.origin_px, dtype=np.float64)


def _condition(
    sheet: Sheet, preset: Preset, extractor: type[Extractor], condition: str, top: int
) -> None:
    samples = preset.generate(condition, "test", _ACROSS)
    geometry = preset.geometry_for(condition)
    found = extractor.for_sensor(geometry).extract(samples.observations)
    truth = true_places(preset, condition, samples)
    for n, frame in enumerate(samples.observations):
        x = _LEFT + n * (_TILE + _GAP)
        middle = truth[n] if np.isfinite(truth[n]).all() else found[n]
        _tile(sheet, (x, top), frame.astype(np.float64), middle, (found[n], truth[n]))
        sheet.text(x, top + _TILE + 17, _apart(found[n], truth[n]), 13)


def _tile(
    sheet: Sheet,
    corner: tuple[int, int],
    frame: Floats,
    middle: Floats,
    places: tuple[Floats, Floats],
) -> None:
    x, y = corner
    height, width = frame.shape
    cut = min(_CUT_PX, height, width)
    wanted = middle if np.isfinite(middle).all() else np.array([width, height]) / 2.0
    left = int(np.clip(round(float(wanted[0])) - cut // 2, 0, width - cut))
    first = int(np.clip(round(float(wanted[1])) - cut // 2, 0, height - cut))
    part = frame[first : first + cut, left : left + cut]
    low, high = float(part.min()), float(part.max())
    axes = sheet.axes(x, y, _TILE, _TILE)
    # the square root shows halo and ghosts beside what is saturated
    scaled = np.sqrt((part - low) / max(high - low, 1e-12))
    edges = (left - 0.5, left + cut - 0.5, first + cut - 0.5, first - 0.5)
    axes.imshow(scaled, cmap=heat(), extent=edges, interpolation="nearest")
    axes.set_axis_off()
    found, true = places
    if np.isfinite(true).all():
        ring: dict[str, Any] = {
            "markerfacecolor": "none",
            "markeredgecolor": _TRUE,
            "markeredgewidth": 1.5,
        }
        axes.plot(*true, marker="o", markersize=20, **ring)
    if np.isfinite(found).all():
        axes.plot(*found, marker="+", markersize=13, markeredgecolor=_FOUND, markeredgewidth=1.5)
    axes.set(xlim=edges[:2], ylim=edges[2:])


def _apart(found: Floats, true: Floats) -> str:
    if not np.isfinite(found).all():
        return "not found"
    place = f"({found[0]:.1f}, {found[1]:.1f})"
    if not np.isfinite(true).all():
        return place
    return f"{place}, {math.hypot(*(found - true).tolist()):.2f} px off"
