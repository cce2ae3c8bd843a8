"""Pictures of a calibration's report, as SVG text."""

from __future__ import annotations

import io
import re
from typing import TYPE_CHECKING, Any

import numpy as np

from algorithms.angles import separation_deg
from algorithms.contract import Floats
from api.calibrate.calibration import Calibration
from api.calibrate.readings import Readings
from api.calibrate.uncertainty import tangent_offsets

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_SIZE = (5.2, 4.4)
#: Samples that are drawn one by one; more are thinned evenly.
_MOST_DRAWN = 1500


def pictures(found: Calibration) -> dict[str, str]:
    """Return SVG by title: residuals over the field, their sizes, runs, uncertainty, next poses."""
    readings = found.readings
    predicted = found.model.predict(readings.features, readings.context)
    offsets = predicted - readings.sun
    errors = separation_deg(predicted, readings.sun)
    along = tangent_offsets(offsets, readings.sun)
    few = readings.thinned(_MOST_DRAWN)
    off_axis = _flat(few.sun)
    step = max(-(-len(readings) // _MOST_DRAWN), 1)
    made = {
        "Residuals over the field": _residuals(off_axis, along[::step], errors[::step]),
        "Size of residuals": _histogram(errors, found),
        "1-sigma uncertainty over the field": _uncertainty(found, few, off_axis),
        "Poses, and the next twenty to take": _poses(found, off_axis),
    }
    if len(np.unique(readings.run)) > 1:
        made["Each run's mean residual"] = _runs(found, along)
    return made


def _flat(sun: Floats) -> Floats:
    """Directions (N, 3) on a plane: angle off the boresight, in degrees, along x and y."""
    off = np.degrees(np.arctan2(np.linalg.norm(sun[:, :2], axis=1), sun[:, 2]))
    around = np.arctan2(sun[:, 1], sun[:, 0])
    return np.column_stack([off * np.cos(around), off * np.sin(around)])


def _axes(equal: bool = True) -> tuple[Figure, Any]:
    from matplotlib import figure as drawing  # noqa: PLC0415 - a second that only pictures need

    figure = drawing.Figure(figsize=_SIZE, layout="constrained")
    axes = figure.add_subplot()
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


def _residuals(places: Floats, along: Floats, errors: Floats) -> str:
    figure, axes = _axes()
    known = np.flatnonzero(np.isfinite(errors))
    size = float(np.sqrt(np.mean(errors[known] ** 2))) or 1.0
    reach = float(np.ptp(places)) / 25.0
    points = axes.scatter(*places[known].T, c=errors[known], s=9, cmap="viridis")
    axes.quiver(
        *places[known].T, *(along[known].T / size * reach),
        angles="xy", scale_units="xy", scale=1.0, width=0.0022,
    )  # fmt: skip
    figure.colorbar(points, label="residual, deg")
    axes.set_title(f"an arrow of {reach:.2g} deg is {size:.2g} deg", fontsize=9)
    return _svg(figure)


def _histogram(errors: Floats, found: Calibration) -> str:
    figure, axes = _axes(equal=False)
    axes.hist(errors[np.isfinite(errors)], bins=60, color="#4477aa", label="fitted")
    if found.chosen.errors is not None:
        left = found.chosen.errors[np.isfinite(found.chosen.errors)]
        axes.hist(left, bins=60, histtype="step", color="#cc6677", label="left out")
    axes.set_xlabel("residual, deg")
    axes.set_ylabel("samples")
    axes.legend()
    return _svg(figure)


def _uncertainty(found: Calibration, few: Readings, places: Floats) -> str:
    figure, axes = _axes()
    sigma = found.deviation_deg(few.features, dict(few.context))
    points = axes.scatter(*places.T, c=sigma, s=12, cmap="magma")
    figure.colorbar(points, label="1-sigma of an axis, deg")
    return _svg(figure)


def _poses(found: Calibration, places: Floats) -> str:
    figure, axes = _axes()
    axes.scatter(*places.T, s=5, color="#bbbbbb", label="measured")
    if len(found.verdict.next_poses):
        axes.scatter(
            *_flat(found.verdict.next_poses).T, s=26, marker="x", color="#cc3311", label="next"
        )
    axes.legend()
    return _svg(figure)


def _runs(found: Calibration, along: Floats) -> str:
    figure, axes = _axes(equal=False)
    run = found.readings.run
    numbers = np.unique(run)
    means = np.array([np.nanmean(along[run == n], axis=0) for n in numbers])
    axes.bar(np.arange(len(numbers)) - 0.2, means[:, 0], 0.4, label="first axis")
    axes.bar(np.arange(len(numbers)) + 0.2, means[:, 1], 0.4, label="second axis")
    axes.set_xticks(
        np.arange(len(numbers)),
        # dollars would be taken for a formula
        [found.readings.run_names[n].replace("$", r"\$") for n in numbers],
        rotation=30,
    )
    axes.set_ylabel("mean residual, deg")
    axes.legend()
    return _svg(figure)
