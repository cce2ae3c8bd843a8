"""Generated parts of the README: picture of the best calibrations, findings and tallies."""

from __future__ import annotations

import math
import statistics
from collections.abc import Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from api.docs.knowledge import knowledge
from benchmark.claims.ledger import Entry, ledger, tally
from benchmark.error_budget.record import RECORD as ERROR_BUDGET
from benchmark.error_budget.sentences import NEAR, bound_of, verdict
from benchmark.leaderboard.architectures import architectures, first_boards
from benchmark.metrics.score import is_available
from benchmark.plot_style import svg
from registry.fidelity.grading import tally_text
from registry.recommendation import recommend
from registry.resolution import Resolution

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Row = Mapping[str, Any]

#: Told apart by every kind of colour vision (Okabe and Ito).
_BEST, _STUDIES, _BUILT, _BOUND = "#0072b2", "#d55e00", "#009e73", "#1a1d21"
#: Ratio of errors up to which two are equivalent in practice.
_ALIKE = 1.03
_WIDTH_IN, _ROW_IN, _FRAME_IN = 8.6, 0.215, 1.15


def picture() -> str:
    """Draw for every architecture what is measured beside what bounds it, as SVG."""
    return svg(figure, "Error of the best calibration of every architecture, against its bound")


def figure() -> Figure:
    """Draw the same as a figure of Matplotlib."""
    from matplotlib.figure import Figure  # noqa: PLC0415 - a second that only pictures need

    rows = sorted(_architectures(), key=lambda row: row["own_deg"] or 1e9, reverse=True)
    drawn = Figure(figsize=(_WIDTH_IN, _ROW_IN * len(rows) + _FRAME_IN), layout="constrained")
    axes = drawn.subplots()
    for height, row in enumerate(rows):
        _draw(axes, height, row)
    axes.set_xscale("log")
    axes.set_yticks(
        range(len(rows)), [f"{row['detector']}, {row['mask']}" for row in rows], fontsize="small"
    )
    axes.set_ylim(-0.8, len(rows) - 0.2)
    axes.set_xlabel("Own error of the direction to the Sun, deg (nominal condition)")
    axes.grid(axis="x", color="#e3e7eb")
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(axis="y", length=0)
    names = {
        "best calibration measured": (_BEST, "o", "full"),
        "best that a mapped study used": (_STUDIES, "o", "none"),
        "built sensors, reported": (_BUILT, "^", "full"),
        "Cramer-Rao bound, unit known": (_BOUND, "|", "full"),
    }
    for name, (colour, mark, fill) in names.items():
        axes.plot([], [], mark, color=colour, label=name, fillstyle=fill)
    drawn.legend(loc="outside upper center", ncols=4, frameon=False, fontsize="small")
    return drawn


def findings() -> str:
    """Write five findings, each with its number and an interval."""
    said = (_distance(), _methods(), _advice(), _light_of_the_earth(), _poses())
    return "\n".join(f"{number}. {sentence}" for number, sentence in enumerate(said, start=1))


def tallies() -> str:
    """Count claims by verdict and studies by grade of their run."""
    entries = _ledger()
    counted = ", ".join(f"{number} {name}" for name, number in tally(entries).items() if number)
    own = sum(entry.review.case == "its case" for entry in entries)
    resolved = knowledge().resolutions
    grades = [resolution.fidelity.grade for resolution in resolved.values()]
    measured = sum(_is_measured(resolution) for resolution in resolved.values())
    return (
        f"- **Claims.** {len(entries)} statements of the survey about algorithms, tested: "
        f"{counted}. The trials of {own} are the case of the survey's sentence, the others in "
        "part; nothing is refuted by another case ([docs/claims.md](docs/claims.md)).\n"
        f"- **Studies.** {len(resolved)} studies, run here: {tally_text(grades)}. Faithful: "
        "sensor, condition and methods are the study's own, stated or inferred with a reason. "
        "Close: one of these differs. Stand-in: more differ. "
        f"{measured} have a measured score ([docs/survey.md](docs/survey.md), `sunatlas studies "
        "KEY`)."
    )


def _is_measured(resolution: Resolution) -> bool:
    """Return whether one of the nearest pipelines has a score in its first setting."""
    scored = knowledge().measurements.score_of
    return any(
        scored.get((at.dataset, at.condition, pipeline.extractor, pipeline.model), {}).get("status")
        == "ok"
        for pipeline in resolution.strongest_pipelines
        for at in pipeline.settings[:1]
    )


@cache
def _architectures() -> Sequence[Row]:
    return architectures(knowledge().measurements.leaderboard)


@cache
def _ledger() -> tuple[Entry, ...]:
    return ledger()


def _draw(axes: Axes, height: int, row: Row) -> None:
    if row["own_deg"] is None:
        return
    axes.plot([row["bound_deg"], row["own_deg"]], [height] * 2, color="#c5ccd3", linewidth=1.2)
    axes.plot(row["bound_deg"], height, "|", color=_BOUND, markersize=8)
    built = _build().get(row["dataset"], ())
    axes.plot(built, [height] * len(built), "^", color=_BUILT, markersize=4.5)
    used = _best_used(row["dataset"])
    if used is not None:
        axes.plot(used, height, "o", color=_STUDIES, fillstyle="none", markersize=7)
    axes.plot(row["own_deg"], height, "o", color=_BEST, markersize=4.5)


@cache
def _build() -> Mapping[str, Sequence[float]]:
    """Accuracies of the built sensors that each data set stands for, degrees."""
    return {
        row["dataset"]: [
            sensor["accuracy_rms_deg"]
            for sensor in row["sensors"]
            if sensor["accuracy_rms_deg"] is not None
        ]
        for row in knowledge().measurements.realism
    }


@cache
def _boards() -> Mapping[str, Sequence[Row]]:
    """Ranked rows of each data set's first condition that answer often enough."""
    return {
        dataset["name"]: [row for row in rows if row["rank"] is not None and is_available(row)]
        for dataset, rows in first_boards(knowledge().measurements.leaderboard)
    }


def _best_used(dataset: str) -> float | None:
    """Least error of the pipelines that mapped studies used, degrees; None for none."""
    used = [row["own_deg"] for row in _boards()[dataset] if row["studies"]]
    return min(used, default=None)


def _distance() -> str:
    rows = list(ERROR_BUDGET.read().values())
    ratios = [row["rms_deg"] / bound_of(row) for row in rows]
    low, middle, high = statistics.quantiles(ratios, n=4)
    near = sum(verdict(row).is_near_bound for row in rows)
    return (
        f"**On {near} of {len(rows)} data sets the best pipeline is within {NEAR:g} times the "
        f"physical limit.** Its error on unit 0 is {middle:.1f} times the Cramer-Rao bound "
        f"(median of the data sets; middle half {low:.1f} to {high:.1f}). The bound is for an "
        "estimator that knows the sensor unit only through its dark and flat frames "
        "([docs/limits.md](docs/limits.md))."
    )


def _methods() -> str:
    """Compare each study's best pipeline with the best on the same data set, by own error."""
    nominal = {
        (row["dataset"], row["extractor"], row["model"]): row
        for rows in _boards().values()
        for row in rows
    }
    least = {name: min(row["own_deg"] for row in rows) for name, rows in _boards().items()}
    factors = []
    for key in knowledge().resolutions:
        rows = (
            nominal.get((dataset, pipeline.extractor, pipeline.model))
            for pipeline in knowledge().resolutions[key].pipelines
            for dataset in {setting.dataset for setting in pipeline.settings}
        )
        ratios = [row["own_deg"] / least[row["dataset"]] for row in rows if row is not None]
        if ratios:
            factors.append(min(ratios))
    low, middle, high = statistics.quantiles(factors, n=4)
    return (
        "**Better methods exist than those of most studies.** On the same data set the best "
        f"method that a study used has {middle:.1f} times the own error of the best one measured "
        f"(median of {len(factors)} studies; middle half {low:.1f} to {high:.1f}; "
        "`sunatlas leaderboard`)."
    )


def _advice() -> str:
    """Compare what has evidence in the literature with the best on the same data, over all data.

    Of the architecture that is ranked first for each task; own errors, nominal condition.
    """
    ratios: dict[str, float] = {}
    for task in knowledge().taxonomy.values("task"):
        found = recommend({"task": [task]}, knowledge().measured_pipelines)
        table, first = found.question.table, found.architectures[0]
        by_data: dict[str, list[tuple[float, bool]]] = {}
        for at in np.flatnonzero(found.question.measured & (table.row_place == first.number)):
            design, row = table.designs[table.row_design[at]], table.rows[at]
            evident = bool(design.advice or design.users)
            error = float(found.question.errors.own_deg[at])
            by_data.setdefault(row.dataset, []).append((error, evident))
        for dataset, errors in by_data.items():
            used = min((e for e, evident in errors if evident), default=math.inf)
            ratios[dataset] = used / min(e for e, _ in errors)
    alike = sum(ratio < _ALIKE for ratio in ratios.values())
    return (
        f"**On {alike} of {len(ratios)} data sets the literature has a calibration as accurate as "
        "any.** There a calibration that the survey advises or a study used has an own error "
        "within 3 % of the best one measured. The data sets are those of the architectures ranked "
        f"first for each task; over all of them the median ratio is "
        f"{statistics.median(ratios.values()):.1f} and the largest {max(ratios.values()):.0f} "
        "(`sunatlas recommend --task Volume`)."
    )


def _light_of_the_earth() -> str:
    lines = {entry.claim.id: entry for entry in _ledger()}["C29"].outcome
    if lines is None:
        return "**Earth albedo** was not measured on digital and analog sensors."
    dark, lit = (lines.lines[name] for name in ("black Earth", "sunlit Earth"))
    change = abs(lit.median[0] - dark.median[0])
    return (
        "**Earth albedo moves a photodiode cube, not a pinhole camera.** It raises the RMS error "
        f"of the cube from {dark.median[1]:.2g} deg to {lit.median[1]:.2g} deg (range over "
        f"sensor units {lit.low[1]:.2g} to {lit.high[1]:.2g}); a CMOS pinhole camera changes by "
        f"less than {_ceiling(change):g} deg ([C29](docs/claims.md#c29))."
    )


def _ceiling(value: float) -> float:
    """Return the next power of ten above a value."""
    return float(10.0 ** math.ceil(math.log10(value)))


def _poses() -> str:
    rows = [row for row in knowledge().measurements.curves if not row["in_order"]]
    poses = [row["needed_poses"] or math.inf for row in rows]
    low, middle, high = statistics.quantiles(poses, n=4)
    never = sum(number == math.inf for number in poses)
    return (
        f"**About {middle:.0f} calibration poses are enough for half of the leading pipelines.** "
        "With that many random poses the error is within 10 % of its floor (median of "
        f"{len(rows)} pipelines; middle half {low:.0f} to {high:.0f}). {never} of them need more "
        "poses than their data set has ([docs/learning-curves.md](docs/learning-curves.md))."
    )
