"""What the README tells first: the answer as a picture, findings with their numbers, tallies."""

from __future__ import annotations

import math
import statistics
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

from api.docs.knowledge import knowledge
from benchmark.claims.ledger import Entry, ledger, tally
from benchmark.error_budget.record import RECORD as ERROR_BUDGET
from benchmark.error_budget.sentences import NEAR, PARTS, verdict
from benchmark.leaderboard import summaries
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
    axes.set_xlabel("Own RMS error of the direction to the Sun, deg (nominal condition)")
    axes.grid(axis="x", color="#e3e7eb")
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(axis="y", length=0)
    names = {
        "best calibration measured": (_BEST, "o", "full"),
        "best that a mapped study used": (_STUDIES, "o", "none"),
        "built sensors, as published": (_BUILT, "^", "full"),
        "Cramer-Rao bound": (_BOUND, "|", "full"),
    }
    for name, (colour, mark, fill) in names.items():
        axes.plot([], [], mark, color=colour, label=name, fillstyle=fill)
    drawn.legend(loc="outside upper center", ncols=4, frameon=False, fontsize="small")
    return drawn


def findings() -> str:
    """Say what the measurements show, in five sentences made of their numbers."""
    said = (_distance(), _methods(), _advice(), _light_of_the_earth(), _poses())
    return "\n".join(f"{number}. {sentence}" for number, sentence in enumerate(said, start=1))


def tallies() -> str:
    """Count the claims by verdict, and the studies by how near to them what runs is."""
    entries = _ledger()
    counted = ", ".join(f"{number} {name}" for name, number in tally(entries).items() if number)
    resolved = knowledge().resolutions
    grades = [resolution.fidelity.grade for resolution in resolved.values()]
    measured = sum(_is_measured(resolution) for resolution in resolved.values())
    return (
        f"**Claims tried**: of the {len(entries)} statements that the survey's text makes about "
        f"algorithms, {counted} ([docs/claims.md](docs/claims.md)).\n\n"
        f"**Studies run**: {tally_text(grades)}, of {len(resolved)}. A run is faithful where "
        "its sensor, condition, methods and compensations are the study's own, stated or inferred "
        "with a reason; close where one of these departs from the study, a stand-in where more do. "
        f"{measured} are measured where they stand for the study. What departs, and what would "
        "settle it: [docs/survey.md](docs/survey.md), `sunatlas studies KEY`."
    )


def _is_measured(resolution: Resolution) -> bool:
    """Say whether one of the pipelines that rest on most has a score in its first setting."""
    scored = knowledge().measurements.score_of
    return any(
        scored.get((at.dataset, at.condition, pipeline.extractor, pipeline.model), {}).get("status")
        == "ok"
        for pipeline in resolution.nearest
        for at in pipeline.settings[:1]
    )


def table() -> str:
    """Write the best pipeline of each architecture against its bound."""
    rows = _architectures()
    return "\n\n".join(
        (
            summaries.tally(rows),
            summaries.best_per_architecture_table(rows),
            summaries.ARCHITECTURES,
        )
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
    judged = [verdict(row) for row in ERROR_BUDGET.read().values()]
    near = sum(one.near for one in judged)
    held = Counter(PARTS[one.leading] for one in judged if not one.near)
    (most, count), *_ = held.most_common()
    return (
        f"**What light allows.** On {near} of {len(judged)} data sets the own error of the best "
        f"pipeline is within {NEAR:g} times the Cramer-Rao bound for a unit known by its dark and "
        f"flat readings; of the other {len(judged) - near}, {count} are held back by {most} "
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
        f"**What studies used and what measures best.** The best pipeline of each of "
        f"{len(factors)} studies has {middle:.1f} times the own error of the best one on the same "
        f"data set (median; middle half of the studies {low:.1f} to {high:.1f}; "
        "`sunatlas leaderboard`)."
    )


def _advice() -> str:
    """Compare, task by task, what has evidence in the literature with the best on the same data."""
    ratios = []
    for task in knowledge().taxonomy.values("task"):
        first = recommend({"task": [task]}, knowledge().measured, limit=1).architectures[0]
        by_data: dict[object, list[tuple[float, bool]]] = {}
        for one in first.calibrations:
            for measured in filter(None, (one.measured, *one.other_datasets)):
                error = measured["own_deg"]
                if isinstance(error, float):
                    evident = bool(one.advised or one.studies)
                    by_data.setdefault(measured["dataset"], []).append((error, evident))
        known = (
            min(e for e, evident in errors if evident) / min(e for e, _ in errors)
            for errors in by_data.values()
            if any(evident for _, evident in errors)
        )
        ratios.append(min(known, default=math.inf))
    alike = sum(ratio < _ALIKE for ratio in ratios)
    return (
        f"**Advice and measurement often disagree.** For {alike} of the survey's {len(ratios)} "
        "tasks the best calibration that its text advises or a study used is within 3 % of the "
        "best one measured on the same data set of the first architecture; for the others its own "
        f"error is up to {max(ratios):.2g} times as large (`sunatlas recommend --task Volume`)."
    )


def _light_of_the_earth() -> str:
    lines = {entry.claim.id: entry for entry in _ledger()}["C29"].outcome
    if lines is None:
        return "**Light from the Earth** was not measured on digital and analog sensors."
    dark, lit = (lines.lines[name] for name in ("black Earth", "sunlit Earth"))
    change = abs(lit.median[0] - dark.median[0])
    return (
        "**Earth albedo ruins analog sensors and leaves digital ones alone.** It raises the RMS "
        f"error of a photodiode cube from {dark.median[1]:.2g} ({dark.low[1]:.2g} to "
        f"{dark.high[1]:.2g} over units) to {lit.median[1]:.2g} deg ({lit.low[1]:.2g} to "
        f"{lit.high[1]:.2g}); that of a CMOS pinhole camera changes by {change:.1g} deg "
        "([C29](docs/claims.md#c29))."
    )


def _poses() -> str:
    rows = [row for row in knowledge().measurements.curves if not row["in_order"]]
    few, given = 50, [row["needed_poses"] for row in rows]
    enough = sum(needed is not None and needed <= few for needed in given)
    never = sum(needed is None for needed in given)
    return (
        f"**How many calibration poses are enough.** With {few} random poses {enough} of "
        f"{len(rows)} leading calibrations are within 10 % of the own error that more poses do not "
        f"improve; {never} {'is' if never == 1 else 'are'} not within 10 % with all poses of "
        "their data set ([docs/learning-curves.md](docs/learning-curves.md))."
    )
