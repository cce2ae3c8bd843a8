"""Pictures of a calibration's report, as SVG text."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from algorithms.contract import Floats
from calibrate.calibration import Calibration
from calibrate.places import off_axis_deg
from calibrate.readings import Readings
from calibrate.report.errors import Errors, field_of, level, ray
from calibrate.report.requirement import Requirement
from calibrate.uncertainty import NORMAL_95

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Inches; a page of the report is 7 wide.
_SQUARE, _WIDE = (7.0, 6.0), (7.0, 3.8)
#: Samples that are drawn one by one; more are thinned evenly.
_MOST_DRAWN = 1500
#: Runs that are drawn side by side.
_MOST_RUNS = 60


def pictures(
    found: Calibration, errors: Errors, asked: Sequence[Requirement] = ()
) -> dict[str, str]:
    """Return SVG by title; what has no data is left out."""
    used = errors.known if errors.known.any() else np.ones(len(errors.readings), dtype=np.bool_)
    drawn = np.flatnonzero(used)[:: max(-(-int(used.sum()) // _MOST_DRAWN), 1)]
    few = Errors(
        errors.readings.only(drawn),
        errors.offsets[drawn],
        errors.errors_deg[drawn],
        errors.sigma_deg[drawn],
    )
    made = {}
    if errors.known.any():
        made["Errors over the field"] = _map(_flat(few.readings.sun), few)
        made["Error against off-axis angle"] = _against_angle(few, asked)
        made["Distribution of errors"] = _histogram(errors)
    if (
        temperature := few.readings.context.get("temperature_K")
    ) is not None and errors.known.any():
        made["Errors against temperature"] = _against_temperature(few, temperature)
    if len(np.unique(errors.readings.run)) > 1 and errors.known.any():
        made["Mean error of each run"] = _runs(errors)
    poses = found.readings.thinned(_MOST_DRAWN)
    made["Stated 1-sigma over the field"] = _uncertainty(found, poses)
    made["Poses, their hull, and the next to take"] = _poses(found, _flat(poses.sun))
    return made


def _flat(sun: Floats) -> Floats:
    """Directions (N, 3) on a plane: angle off the boresight, in degrees, along x and y."""
    off = off_axis_deg(sun)
    around = np.arctan2(sun[:, 1], sun[:, 0])
    return np.column_stack([off * np.cos(around), off * np.sin(around)])


def _axes(equal: bool = True) -> tuple[Figure, Any]:
    from matplotlib import figure as drawing  # noqa: PLC0415 - a second that only pictures need

    figure = drawing.Figure(figsize=_SQUARE if equal else _WIDE, layout="constrained")
    axes = figure.add_subplot()
    axes.grid(color="#e4e4e4", linewidth=0.6)
    axes.set_axisbelow(True)
    if equal:
        axes.set_aspect("equal", adjustable="datalim")  # poses may lie on a line
        axes.set_xlabel("off axis along x, deg")
        axes.set_ylabel("off axis along y, deg")
    return figure, axes


def _svg(figure: Figure) -> str:
    import matplotlib as mpl  # noqa: PLC0415 - as above

    with mpl.rc_context({"svg.hashsalt": "sunatlas", "svg.fonttype": "path"}):
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    return re.sub(r"^.*?(<svg)", r"\1", text.getvalue(), flags=re.DOTALL)


def _map(places: Floats, few: Errors) -> str:
    figure, axes = _axes()
    size = float(np.sqrt(np.mean(few.errors_deg**2))) or 1.0
    reach = float(np.ptp(places)) / 25.0
    turned = _flat(_unit(few.readings.sun + few.offsets * 1e-3 / np.radians(size))) - places
    length = np.linalg.norm(turned, axis=1)
    # arrows as long as their error, whatever the plane does to angles
    arrows = turned / np.maximum(length, 1e-12)[:, None] * few.errors_deg[:, None] / size * reach
    points = axes.scatter(*places.T, c=few.errors_deg, s=14, cmap="viridis")
    axes.quiver(
        *places.T, *arrows.T, angles="xy", scale_units="xy", scale=1.0, width=0.002,
    )  # fmt: skip
    figure.colorbar(points, label="error of poses left out, deg", shrink=0.85)
    axes.set_title(f"an arrow of {reach:.2g} deg is an error of {size:.2g} deg", fontsize=10)
    return _svg(figure)


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1)[:, None])


def _against_angle(few: Errors, asked: Sequence[Requirement]) -> str:
    figure, axes = _axes(equal=False)
    off = few.off_axis_deg
    axes.scatter(off, few.errors_deg, s=8, color="#4477aa", label="pose left out")
    stated = NORMAL_95 * np.sqrt(np.mean(few.sigma_deg**2, axis=1))
    order = np.argsort(off)
    axes.plot(
        off[order], _smooth(stated[order]), color="#cc6677", label="stated 95 % interval of an axis"
    )
    for one in asked:
        half = one.half_angle_deg or float(off.max())
        axes.plot([0.0, half], [one.limit_deg] * 2, color="#222222", linestyle="--")
        axes.annotate(
            one.text, (half, one.limit_deg), xytext=(-2, 3), textcoords="offset points", fontsize=9,
            ha="right",
        )  # fmt: skip
    axes.set_xlabel("off-axis angle, deg")
    axes.set_ylabel("error, deg")
    axes.set_ylim(0.0, 1.25 * axes.get_ylim()[1])  # room for the legend
    axes.legend()
    return _svg(figure)


def _smooth(values: Floats, width: int = 15) -> Floats:
    """Return a running median (N,) that sectors of different uncertainty do not make jagged."""
    padded = np.pad(values, width // 2, mode="edge")
    return np.asarray(np.median(np.lib.stride_tricks.sliding_window_view(padded, width), axis=1))


def _histogram(errors: Errors) -> str:
    figure, axes = _axes(equal=False)
    left = errors.errors_deg[errors.known]
    axes.hist(left, bins=min(60, max(len(left) // 8, 10)), color="#4477aa", label="poses left out")
    lines = {"RMS": float(np.sqrt(np.mean(left**2))), "95 %": level(left, 0.95)}
    for (name, value), style in zip(lines.items(), ("-", "--"), strict=True):
        if np.isfinite(value):
            axes.axvline(value, color="#cc3311", linestyle=style, label=f"{name}: {value:.3g} deg")
    axes.set_xlabel("error, deg")
    axes.set_ylabel("poses")
    axes.legend()
    return _svg(figure)


def _against_temperature(few: Errors, temperature: Floats) -> str:
    figure, axes = _axes(equal=False)
    names = ("first tangent axis", "second tangent axis")
    for at, (name, colour) in enumerate(zip(names, ("#4477aa", "#cc6677"), strict=True)):
        axes.scatter(temperature, few.along_deg[:, at], s=8, color=colour, label=name)
    axes.set_xlabel("temperature, K")
    axes.set_ylabel("error, deg")
    axes.legend()
    return _svg(figure)


def _uncertainty(found: Calibration, poses: Readings) -> str:
    figure, axes = _axes()
    sigma = found.deviation_deg(poses.features, dict(poses.context))
    points = axes.scatter(*_flat(poses.sun).T, c=sigma, s=16, cmap="magma")
    figure.colorbar(points, label="1-sigma of an axis, deg", shrink=0.85)
    return _svg(figure)


def _poses(found: Calibration, places: Floats) -> str:
    figure, axes = _axes()
    axes.scatter(*places.T, s=6, color="#999999", label="measured")
    field = field_of(found.readings.sun, 72)
    if field is not None and field.most_deg < 175.0:
        edge = _flat(ray(*np.array([*field.reach, field.reach[0]]).T))
        axes.plot(*edge.T, color="#4477aa", linewidth=1.2, label="hull")
    if len(found.verdict.next_poses):
        axes.scatter(
            *_flat(found.verdict.next_poses).T, s=34, marker="x", color="#cc3311", label="next"
        )
    axes.legend(loc="upper right")
    return _svg(figure)


def _runs(errors: Errors) -> str:
    """Draw runs by their number: the table of the report has their names."""
    figure, axes = _axes(equal=False)
    run, along = errors.readings.run, errors.along_deg
    numbers = [n for n in np.unique(run) if errors.known[run == n].any()][:_MOST_RUNS]
    means = np.array([np.nanmean(along[run == n], axis=0) for n in numbers])
    at = np.arange(len(numbers))
    axes.bar(at - 0.2, means[:, 0], 0.4, color="#4477aa", label="first tangent axis")
    axes.bar(at + 0.2, means[:, 1], 0.4, color="#cc6677", label="second tangent axis")
    axes.set_xticks(at, [str(n + 1) for n in numbers])
    axes.set_xlabel("run")
    axes.set_ylabel("mean error, deg")
    axes.legend()
    return _svg(figure)
