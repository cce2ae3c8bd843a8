"""The committed page of the leaderboard: the best of each architecture, in Markdown."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from benchmark.leaderboard import summaries
from benchmark.leaderboard.architectures import architectures, first_boards
from benchmark.leaderboard.scope import BEHIND, CLOSE, UNITS, UNITS_BEHIND

Board = Mapping[str, Any]
Row = Mapping[str, Any]

#: Name of the committed page.
PAGE = "leaderboard.md"

_SHARES = ("availability", "false_detection_rate")
#: Columns of the tables by data set, and their headings.
_COLUMNS = {
    "best_of_extractor": "Best of extractor",
    "studies": "Studies",
    "rank": "#",
    "own_error_deg": "Own error (deg)",
    "units": "Units (deg)",
    "on_bench_deg": "On a bench (deg)",
    "over_bound": "RMS / bound",
    "repeatability_deg": "Repeatability (deg)",
    "availability": "Answered",
    "false_detection_rate": "False Suns",
}
#: Pipelines that are not the best of their extractor are on the page down to this rank.
_RANKS = 3

LEGEND = (
    "Own error: angle between the predicted and the true direction of the Sun, RMS, for a "
    "pipeline calibrated with true directions. It is the geometric mean over sensor units and "
    "includes the errors of false detections. Readings are corrected by the unit's dark and flat "
    "readings. On a bench: error expected with the standard calibration bench, the root sum of "
    "squares of own error and bench error. Bound: Cramer-Rao bound over the same samples for a "
    "known sensor unit, ± the standard error of the ratio; the second bound is for a unit known "
    "only through its dark and flat readings. Answered: share of the observable samples with an "
    "answer; false Suns: share of the other samples with an answer. Repeatability: standard "
    "deviation of the answers to a constant direction. Pipelines below 95 % availability rank "
    f"last. Under the first condition, pipelines with at most {CLOSE:g} times the error of the "
    f"first are scored on {UNITS} units, those with at most {BEHIND:g} times on {UNITS_BEHIND}; "
    "pipelines that a paired test over the units cannot separate share a rank, marked =. The best "
    "pipeline of each extractor comes first. Studies: number of mapped studies that used a "
    "pipeline on such a sensor, or that it represents if they do not state theirs."
)


def _format_number(column: str, row: Row) -> str:
    """Spell a column of a row for people: four significant digits, a dash for none."""
    if column in _SPELT:
        return _SPELT[column](row)
    value = row[column]
    if value is None:
        return "-"
    if column in _SHARES:
        return f"{value:.3f}"
    return _digits(value) if isinstance(value, float) else str(value)


def _rank(row: Row) -> str:
    return "-" if row["rank"] is None else f"{row['rank']}{'=' if row['tied'] else ''}"


def _units(row: Row) -> str:
    if row["low_deg"] is None:
        return "-"
    return f"{_digits(row['low_deg'])} to {_digits(row['high_deg'])}"


_SPELT: Mapping[str, Callable[[Row], str]] = {
    "rank": _rank,
    "units": _units,
    "best_of_extractor": lambda row: "yes" if row["best_of_extractor"] else "-",
    "studies": lambda row: str(len(row["studies"]) or "-"),
}


def _digits(value: float) -> str:
    return f"{value:#.4g}".rstrip(".")


def page(board: Board) -> str:
    """Write the best of each architecture, and of each extractor on each data set, in Markdown."""
    best = architectures(board)
    about = (
        "Of each data set's first condition the best pipeline of each extractor; behind them the "
        f"others of the first {_RANKS} ranks. All pipelines and conditions: `sunatlas leaderboard "
        "--dataset NAME`, or the page and the API of `sunatlas serve`."
    )
    lines = [
        "# Leaderboard",
        "",
        LEGEND,
        "",
        "## By architecture",
        "",
        summaries.ARCHITECTURES,
        "",
        summaries.best_per_architecture_table(best),
        "",
        summaries.tally(best),
        "",
        "## By data set",
        "",
        about,
        "",
        f"| Data set | Pipeline | {' | '.join(_COLUMNS.values())} |",
        "| --- | --- |" + " ---: |" * len(_COLUMNS),
    ]
    for dataset, rows in first_boards(board):
        for row in rows:
            listed = row["rank"] is not None and not (row["twin_of"] or row["folded"])
            if listed and (row["best_of_extractor"] or row["rank"] <= _RANKS):
                texts = (_format_number(column, row) for column in _COLUMNS)
                pipeline = f"{row['extractor']} + {row['model']}"
                lines.append(f"| {dataset['name']} | {pipeline} | {' | '.join(texts)} |")
    return "\n".join(lines) + "\n"
