"""Generated parts of README and leaderboard summary: a picture, findings, tallies, a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

from api.cli.asking import knowledge
from api.service import leaderboard
from benchmark.claims.ledger import ledger, tally
from benchmark.leaderboard import summaries
from benchmark.leaderboard.architectures import architectures, first_boards
from benchmark.metrics.score import is_available
from benchmark.plot_style import svg
from registry.fidelity.grading import tally_text
from survey_data.products import built_sensors

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Row = Mapping[str, Any]

#: Colour (Okabe and Ito: told apart by every kind of colour vision), marker, fill, size and name.
_MARKS: Mapping[str, tuple[str, str, str, float, str]] = {
    "flight": ("#cc79a7", "D", "full", 4, "best calibration, in flight"),
    "best": ("#0072b2", "o", "full", 4.5, "the same, own error"),
    "used": ("#d55e00", "o", "none", 7, "best that a mapped study used"),
    "built": ("#009e73", "^", "full", 4.5, "built sensors, published"),
    "bound": ("#1a1d21", "|", "full", 8, "Cramer-Rao bound, unit known"),
}
_WIDTH_IN, _ROW_IN, _FRAME_IN = 8.6, 0.215, 1.35
#: Why a built sensor can lie left of a bound.
_OTHER = (
    "Open triangle: a built sensor below the bound. The bound is the simulated sensor's; the built "
    "one has another size, light or field."
)


def findings() -> str:
    """Write five findings, each with intervals, what is left out, and its command."""
    every = leaderboard.findings(knowledge())
    return "\n".join(f"{number}. {one.markdown}" for number, one in enumerate(every, start=1))


def tallies() -> str:
    """Count claims by verdict and studies by grade of their run."""
    entries, known = ledger(), knowledge()
    counted = ", ".join(f"{number} {name}" for name, number in tally(entries).items() if number)
    own = sum(entry.review.case == "its case" for entry in entries)
    resolved = known.resolutions
    cells = [
        {
            (at.dataset, at.condition, pipeline.extractor, pipeline.model)
            for pipeline in resolution.strongest_pipelines
            for at in pipeline.settings[:1]
        }
        for resolution in resolved.values()
    ]
    scored = {at for at, row in known.measurements.score_of.items() if row.get("status") == "ok"}
    without = sum("None" in study.of("model") for study in known.facts.studies.values())
    return (
        f"- **Claims.** {len(entries)} statements of the survey about algorithms, tested: "
        f"{counted}. The trials of {own} are the case of the survey's sentence, the others in "
        "part; nothing is refuted by another case ([docs/claims.md](docs/claims.md)).\n"
        f"- **Studies.** {len(resolved)} studies, run here: "
        f"{tally_text(one.fidelity.grade for one in resolved.values())}. Faithful: "
        "sensor, condition, methods, calibration and score are the study's own. Assumed: nothing "
        "known differs, but facts that it takes to judge are unknown. Close: one part differs. "
        f"Stand-in: more differ. They make {len(set().union(*cells))} distinct cells (a pipeline "
        f"on a data set under a condition); {without} studies have no model in the survey, and one "
        f"is chosen here; {sum(bool(some & scored) for some in cells)} have a measured score "
        "([docs/survey.md](docs/survey.md), `sunatlas studies KEY`)."
    )


def best_per_architecture() -> str:
    """Tabulate the best pipeline of each architecture, how far from its bound and how sure."""
    rows = _architectures()
    table = summaries.best_per_architecture_table(rows)
    return f"{summaries.ARCHITECTURES}\n\n{table}\n\n{summaries.tally(rows)}"


def picture() -> str:
    """Draw for every architecture what is measured beside what bounds it, as SVG."""
    return svg(figure, "Error of the best calibration of every architecture, against its bound")


def figure() -> Figure:
    """Draw the same as a figure of Matplotlib."""
    from matplotlib.figure import Figure  # noqa: PLC0415 - a second that only pictures need

    rows = sorted(_architectures(), key=_first_deg, reverse=True)
    drawn = Figure(figsize=(_WIDTH_IN, _ROW_IN * len(rows) + _FRAME_IN), layout="constrained")
    axes = drawn.subplots()

    def mark(kind: str, errors: Sequence[float], height: int, fill: str = "") -> None:
        colour, marker, usual, size, _ = _MARKS[kind]
        style: dict[str, Any] = {"color": colour, "fillstyle": fill or usual, "markersize": size}
        axes.plot(errors, [height] * len(errors), marker, **style)

    for height, row in enumerate(rows):
        if row["own_error_deg"] is None:
            continue
        ends = [row["bound_deg"], row["own_error_deg"], _first_deg(row)]
        axes.plot(ends, [height] * 3, color="#c5ccd3", linewidth=1.2)
        mark("bound", ends[:1], height)
        # as published, root mean squares; those read on a page: what is recalled is left out
        built = [
            one.accuracy_rms_deg
            for one in built_sensors().values()
            if (one.detector, one.mask) == (row["detector"], row["mask"])
            and one.accuracy_rms_deg is not None
            and one.basis != "recalled"
        ]
        mark("built", [error for error in built if error >= row["bound_deg"]], height)
        mark("built", [error for error in built if error < row["bound_deg"]], height, "none")
        used = [other["own_error_deg"] for other in _boards()[row["dataset"]] if other["studies"]]
        mark("used", sorted(used)[:1], height)
        mark("best", ends[1:2], height)
        mark("flight", ends[2:], height)
    axes.set_xscale("log")
    names = [f"{row['detector']}, {row['mask']}" for row in rows]
    axes.set_yticks(range(len(rows)), names, fontsize="small")
    axes.set_ylim(-0.8, len(rows) - 0.2)
    axes.set_xlabel(f"Error of the direction to the Sun, deg\n{_OTHER}", fontsize="small")
    axes.grid(axis="x", color="#e3e7eb")
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(axis="y", length=0)
    for colour, marker, fill, _, name in _MARKS.values():
        axes.plot([], [], marker, color=colour, label=name, fillstyle=fill)
    drawn.legend(loc="outside upper center", ncols=5, frameon=False, fontsize="small")
    return drawn


def _first_deg(row: Row) -> float:
    """Return the error in flight, or the own error of what was not flown; large for neither."""
    return float(row["flight_error_deg"] or row["own_error_deg"] or 1e9)


@cache
def _architectures() -> Sequence[Row]:
    return architectures(knowledge().measurements.leaderboard)


@cache
def _boards() -> Mapping[str, Sequence[Row]]:
    """Ranked rows of each data set's first condition that answer often enough."""
    return {
        dataset["name"]: [row for row in rows if row["rank"] is not None and is_available(row)]
        for dataset, rows in first_boards(knowledge().measurements.leaderboard)
    }
