"""Generated parts of the README: picture of the best calibrations, findings and tallies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

from api.docs.knowledge import knowledge
from api.service import leaderboard
from benchmark.claims.ledger import Entry, ledger, tally
from benchmark.leaderboard.architectures import architectures, first_boards
from benchmark.metrics.score import is_available
from benchmark.plot_style import svg
from registry.fidelity.grading import tally_text
from registry.resolution import Resolution
from registry.taxonomy import Architecture
from survey_data.hardware import hardware
from survey_data.reported import reported_accuracies

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Row = Mapping[str, Any]

#: Told apart by every kind of colour vision (Okabe and Ito).
_BEST, _STUDIES, _BUILT, _BOUND = "#0072b2", "#d55e00", "#009e73", "#1a1d21"
_WIDTH_IN, _ROW_IN, _FRAME_IN = 8.6, 0.215, 1.35
#: Why a built sensor can lie left of a bound.
_OTHER = (
    "Open triangle: a built sensor below the bound. The bound is the simulated sensor's; the built "
    "one has another size, light or field."
)


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
    axes.set_xlabel(
        f"Own error of the direction to the Sun, deg (nominal condition)\n{_OTHER}",
        fontsize="small",
    )
    axes.grid(axis="x", color="#e3e7eb")
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(axis="y", length=0)
    names = {
        "best calibration measured": (_BEST, "o", "full"),
        "best that a mapped study used": (_STUDIES, "o", "none"),
        "built sensors, published": (_BUILT, "^", "full"),
        "Cramer-Rao bound, unit known": (_BOUND, "|", "full"),
    }
    for name, (colour, mark, fill) in names.items():
        axes.plot([], [], mark, color=colour, label=name, fillstyle=fill)
    drawn.legend(loc="outside upper center", ncols=4, frameon=False, fontsize="small")
    return drawn


@cache
def findings() -> str:
    """Write five findings, each with intervals, what is left out, and its command."""
    every = leaderboard.findings(knowledge())
    return "\n".join(f"{number}. {one.markdown}" for number, one in enumerate(every, start=1))


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
        "sensor, condition, methods, calibration and score are the study's own. Assumed: nothing "
        "known differs, but facts that it takes to judge are unknown. Close: one part differs. "
        f"Stand-in: more differ. They make {_cells(resolved)} distinct cells (a pipeline on a data "
        f"set under a condition); {_without_model()} studies have no model in the survey, and one "
        f"is chosen here; {measured} have a measured score ([docs/survey.md](docs/survey.md), "
        "`sunatlas studies KEY`)."
    )


def _cells(resolved: Mapping[str, Resolution]) -> int:
    """Count the cells that studies are judged by, one that several share once."""
    return len(
        {
            (at.dataset, at.condition, pipeline.extractor, pipeline.model)
            for resolution in resolved.values()
            for pipeline in resolution.strongest_pipelines
            for at in pipeline.settings[:1]
        }
    )


def _without_model() -> int:
    """Count the studies that the survey lists no model for."""
    studies = knowledge().facts.studies.values()
    return sum("None" in study.of("model") for study in studies)


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
    built = _built().get((row["detector"], row["mask"]), ())
    for fill, beyond in (("full", False), ("none", True)):
        some = [error for error in built if (error < row["bound_deg"]) is beyond]
        axes.plot(some, [height] * len(some), "^", color=_BUILT, fillstyle=fill, markersize=4.5)
    used = _best_used(row["dataset"])
    if used is not None:
        axes.plot(used, height, "o", color=_STUDIES, fillstyle="none", markersize=7)
    axes.plot(row["own_deg"], height, "o", color=_BEST, markersize=4.5)


@cache
def _built() -> Mapping[Architecture, Sequence[float]]:
    """Accuracies of built sensors as root mean squares, degrees, by their detector and mask.

    Those read on a page; what is recalled is left out.
    """
    found: dict[Architecture, list[float]] = {}
    for sensor in hardware().values():
        if sensor.accuracy_deg is not None and sensor.basis != "recalled":
            figure = reported_accuracies("accuracy", sensor.accuracy_deg, sensor.accuracy_kind)
            found.setdefault((sensor.detector, sensor.mask), []).append(figure.rms_deg)
    return found


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
