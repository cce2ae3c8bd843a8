"""Leaderboard summary as Markdown: the best of each architecture, and the parts."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from benchmark.leaderboard.overview import WITHIN

Row = Mapping[str, Any]

#: What the table of architectures shows, and how sure it is.
ARCHITECTURES = (
    "The best pipeline of each architecture (a detector and a mask) under nominal conditions, on "
    "its data set with the smallest error. In flight: the same pipeline, calibrated on the ground "
    "once and flown for 2.5 years. Own error: calibrated with true directions, geometric "
    "mean over sensor units ± standard error. Quoted: the pipeline is chosen on even units, its "
    "error given on odd ones. On a bench: expected with the standard calibration bench. × bound: "
    "RMS error divided by the Cramer-Rao bound on the standard unit. = marks a tie with the "
    "runner-up in a paired test over the units; group is the number of tied pipelines. Pipelines "
    "with a lower error but below 95 % availability are listed in brackets."
)

_HEADINGS = {
    "architecture": "---",
    "best pipeline": "---",
    "data set": "---",
    "in flight, deg": "---:",
    "own error, deg": "---:",
    "quoted, deg": "---:",
    "on a bench, deg": "---:",
    "× bound": "---:",
    "group": "---:",
    "studies": "---:",
}


def best_per_architecture_table(rows: Iterable[Row]) -> str:
    """Write the rows of `benchmark.leaderboard.architectures.architectures` as a table."""
    return _table(_HEADINGS, map(_architecture, rows))


def tally(rows: Sequence[Row]) -> str:
    """Count architectures whose best pipeline is near the bound, and ties."""
    near = (
        f"{sum((row['over_bound'] or limit + 1) <= limit for row in rows)} within {limit:g}"
        for limit in WITHIN
    )
    ties = sum(row["tie"] for row in rows)
    return f"Of {len(rows)} architectures, {', '.join(near)} times the bound; {ties} are ties."


def _architecture(row: Row) -> Sequence[str]:
    if row["extractor"] is None:
        return f"{row['detector']}, {row['mask']}", "none has an error", *["-"] * 8
    error = row["own_se"]
    several = len(row["datasets"])
    return (
        f"{row['detector']}, {row['mask']}",
        f"{row['extractor']} + {row['model']}{_finer(row)}",
        row["dataset"] + (f" (of {several})" if several > 1 else ""),
        digits(row["flight_error_deg"]),
        f"{digits(row['own_error_deg'])}{'=' if row['tie'] else ''}"
        + ("" if error is None else f" ± {100 * error:.1f} %"),
        digits(row["quoted_deg"]),
        digits(row["on_bench_deg"]),
        digits(row["over_bound"]),
        str(row["first_group"] or "-"),
        str(len(row["studies"]) or "-"),
    )


def _finer(row: Row) -> str:
    """Name the pipeline with a lower error at lower availability."""
    if row["partial_extractor"] is None:
        return ""
    error = digits(row["partial_own_error_deg"])
    return (
        f" ({row['partial_extractor']} + {row['partial_model']}: {error} deg at "
        f"{100 * row['partial_availability']:.0f} % availability)"
    )


def digits(value: float | None, count: int = 3, nothing: str = "-") -> str:
    """Spell a number in so many significant digits, never with an exponent.

    This is the one spelling of an error on pages, in commands and in documents.

    Parameters
    ----------
    value : None, NaN and infinities for none
    count : significant digits
    nothing : text in place of a value that is none
    """
    if value is None or not math.isfinite(value):
        return nothing
    if value == 0:
        return "0"
    rounded = float(f"{value:.{count - 1}e}")
    decimals = count - 1 - math.floor(math.log10(abs(rounded)))
    return f"{rounded:,.{max(0, min(decimals, 8))}f}"


def _table(headings: Mapping[str, str], rows: Iterable[Sequence[str]]) -> str:
    lines: list[Iterable[str]] = [headings.keys(), headings.values(), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)
