"""Pictures of what a model leaves over the field: every test pose an arrow, twice."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from algorithms.contract import Floats
from benchmark.error_budget.measure import directions
from benchmark.metrics.separation import separation_deg
from benchmark.plan.parts import installed_parts
from benchmark.plot_style import svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from benchmark.datasets.preset import Preset

#: Points: a square panel, and what is around it.
_SIDE, _LEFT, _GAP, _RIGHT, _TOP, _BOTTOM = 320, 52, 50, 14, 74, 54
_ARROW, _POSE, _INK, _FAINT, _GRID = "#0072b2", "#d55e00", "#1a1d21", "#5c6570", "#e3e7eb"
#: Poses drawn, the first ones; and how long the arrow of the 90th percentile is, of the field.
_MOST, _LONG = 250, 0.09
_SAID = {
    "as_is": "as it is",
    "perfect": "calibration, unit, readings perfect",
}


@dataclass(frozen=True)
class PlottedPipeline:
    """A pipeline on the data set whose field is drawn."""

    dataset: str
    extractor: str
    model: str

    @property
    def name(self) -> str:
        """Of the pipeline and the data set."""
        return f"{self.extractor} + {self.model} on {self.dataset}"


@cache
def residuals(shown: PlottedPipeline) -> tuple[Floats, Mapping[str, Floats]]:
    """Return true directions (N, 3) of the test split and answers by variant.

    Under the data set's first condition; variants as
    `benchmark.error_budget.measure.directions` gives them.
    """
    parts = installed_parts()
    preset = cast("Preset", parts.preset(shown.dataset))
    extractor, model = parts.extractor(shown.extractor), parts.model(shown.model)
    return directions(preset, preset.conditions[0], extractor, model)


def rms_deg(shown: PlottedPipeline) -> dict[str, float]:
    """Root mean square error by variant, over the answered poses."""
    sun, answers = residuals(shown)
    errors = {name: separation_deg(given, sun) for name, given in answers.items()}
    return {name: float(np.sqrt(np.nanmean(error**2))) for name, error in errors.items()}


def picture(shown: PlottedPipeline) -> str:
    """Draw the field as SVG: an arrow a pose, from the true direction towards the answer."""
    return svg(lambda: figure(shown), f"Residuals over the field: {shown.name}")


def figure(shown: PlottedPipeline) -> Figure:
    """Draw the same as a figure of Matplotlib."""
    from matplotlib.figure import Figure  # noqa: PLC0415 - a second that only pictures need

    sun, answers = residuals(shown)
    errors = rms_deg(shown)
    width, height = _LEFT + 2 * _SIDE + _GAP + _RIGHT, _TOP + _SIDE + _BOTTOM
    drawn = Figure(figsize=(width / 72, height / 72), dpi=72, facecolor="white")
    place: dict[str, Any] = {"ha": "left", "va": "baseline"}
    title = f"What is left over the field: {shown.name}"
    drawn.text(12 / width, 1 - 22 / height, title, size=14, weight="bold", color=_INK, **place)
    said = "from each true direction (dot) towards the answer, lengthened as the bar says"
    drawn.text(12 / width, 1 - 40 / height, said, size=10.5, color=_FAINT, **place)
    edge = _edge(sun)
    for column, (name, given) in enumerate(answers.items()):
        left = _LEFT + column * (_SIDE + _GAP)
        axes = drawn.add_axes(
            (left / width, _BOTTOM / height, _SIDE / width, _SIDE / height), aspect="equal"
        )
        axes.set_title(
            f"{_SAID[name]}: {errors[name]:.2g} deg rms", size=11, color=_INK, loc="left", pad=6
        )
        _fill(axes, (sun[:_MOST], given[:_MOST]), edge, named=column == 0)
    return drawn


def on_plane(vectors: Floats) -> Floats:
    """(N, 2) off-axis angle of unit vectors (N, 3), degrees, towards where they lean from +z."""
    across = np.hypot(vectors[:, 0], vectors[:, 1])
    angle = np.degrees(np.arctan2(across, vectors[:, 2]))
    return np.asarray(vectors[:, :2] * (angle / np.where(across > 0, across, 1.0))[:, None])


def _fill(axes: Axes, pair: tuple[Floats, Floats], edge: float, *, named: bool) -> None:
    start = on_plane(pair[0])
    residual = on_plane(pair[1]) - start
    answered = np.isfinite(residual).all(axis=1)
    start, residual = start[answered], residual[answered]
    typical = float(np.quantile(np.hypot(*residual.T), 0.9)) if len(residual) else 1.0
    bar = _round(max(typical, 1e-12))
    grown = _LONG * 2 * edge / bar
    # all arrows as one broken line: a path each would be most of the file
    ends = np.full((len(start), 3, 2), np.nan)
    ends[:, 0], ends[:, 1] = start, start + grown * residual
    axes.plot(*ends.reshape(-1, 2).T, color=_ARROW, linewidth=0.9, solid_capstyle="round")
    ends[:, 1] = start  # dots are strokes without length: marks of their own take as much again
    axes.plot(*ends.reshape(-1, 2).T, color=_POSE, linewidth=2.2, solid_capstyle="round")
    axes.set_xlim(-edge, edge)
    axes.set_ylim(-edge, edge)
    ticks = _ticks(edge)
    axes.set_xticks(ticks)
    axes.set_yticks(ticks)
    axes.grid(color=_GRID, linewidth=0.8)
    axes.set_axisbelow(True)
    axes.tick_params(labelsize=9.5, labelcolor=_FAINT, length=0)
    axes.spines[:].set_visible(False)
    axes.set_xlabel("off-axis angle towards x (deg)", size=10, color=_FAINT, labelpad=3)
    if named:
        axes.set_ylabel("towards y (deg)", size=10, color=_FAINT, labelpad=0)
    below = -edge - 0.15 * 2 * edge
    right, middle = edge, below + 0.012 * 2 * edge
    axes.plot(
        [right - grown * bar, right], [middle] * 2, color=_ARROW, linewidth=2.2, clip_on=False
    )
    axes.text(
        right - grown * bar - 0.02 * edge,
        below,
        f"{bar:g} deg ",
        size=10,
        color=_INK,
        ha="right",
        va="baseline",
    )


def _edge(sun: Floats) -> float:
    """Half a side of the panels, degrees: the outermost pose and some room for its arrow."""
    return 1.2 * float(np.abs(on_plane(sun[:_MOST])).max())


def _ticks(edge: float) -> list[float]:
    step = next(step for step in (5, 10, 20, 30, 60, 90) if edge / step < 4)
    count = math.floor(edge / step)
    return [float(step * k) for k in range(-count, count + 1)]


def _round(value: float) -> float:
    """Return 1, 2 or 5 times a power of ten, the next one up, or down where it is near."""
    power = 10.0 ** math.floor(math.log10(value))
    return float(next(f * power for f in (1, 2, 5, 10) if f * power >= 0.85 * value))
