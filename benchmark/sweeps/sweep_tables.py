"""Sweeps as tables of the leaderboard: CSV, Markdown and HTML.

The CSV holds every column. Markdown and HTML show the error over the bound, a row a method and
a column a point, and of the reference settings more.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from benchmark.results.csv_tables import text_of
from benchmark.sweeps.plan import SERIES
from benchmark.synthetic_features.series import SWEEPS
from registry.taxonomy import taxonomy_row

Row = Mapping[str, Any]

HEADING = "Sweeps"
LEGEND = (
    "Error of every method on features in closed form, at the same observations for all, over the "
    "Cramer-Rao bound of one coordinate; brightness and background count as unknown. Numbers are "
    "the root mean square error of one coordinate over the bound; a dash: nothing found. Where "
    "less than 90 % are found the share stands beside it. Of the series `frames` the share of all "
    "samples stands after an exclamation mark that are answered more than 1 px off, or where there "
    "is nothing to find."
)
REFERENCE = {
    "rms": "RMS",
    "bias": "Bias",
    "bound": "Bound",
    "over_bound": "RMS / bound",
    "found_fraction": "Found",
}
_IDENTITY = ("series", "sweep", "point", "extractor")
_BOUND = "bound"


@dataclass(frozen=True)
class SweepTable:
    """One sweep of one series.

    Attributes
    ----------
    series, title, description
        What it is.
    first
        Heading of the first column.
    columns
        Headings of the others.
    rows
        Heading, then (cell, column, text) a column.
    """

    series: str
    title: str
    description: str
    first: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, tuple[tuple[str, str, str], ...]], ...]


def tables(rows: Sequence[Row]) -> list[SweepTable]:
    """Arrange stored rows, in their order, as tables."""
    found: list[SweepTable] = []
    measured = [row for row in rows if row["sweep"]]
    for (series, sweep), group in groupby(measured, key=lambda row: (row["series"], row["sweep"])):
        if sweep == "reference":
            found += _references(series, list(group))
        else:
            found.append(_sweep(series, sweep, list(group)))
    return found


def unmeasured_settings(rows: Sequence[Row]) -> list[tuple[str, str, str]]:
    """Return (series, extractor, reason) of what is not measured."""
    return [(r["series"], r["extractor"], r["reason"]) for r in rows if not r["sweep"]]


def cell_of(row: Row) -> str:
    """Name a row in messages."""
    return "/".join(row[name] for name in _IDENTITY)


def to_csv(rows: Sequence[Row]) -> str:
    """Write all columns of all rows."""
    columns = list(dict.fromkeys(column for row in rows for column in row)) or list(_IDENTITY)
    columns = [*_IDENTITY, *(column for column in columns if column not in _IDENTITY)]
    return text_of(columns, map(taxonomy_row, rows))


def to_markdown(rows: Sequence[Row]) -> list[str]:
    """Write the tables as lines; none without rows."""
    if not rows:
        return []
    lines = [f"# {HEADING}", "", LEGEND, ""]
    before = ""
    for table in tables(rows):
        if table.series != before:
            lines += [f"## {table.series}", "", table.description + ".", ""]
            before = table.series
        lines += [f"### {table.title}", "", f"| {' | '.join((table.first, *table.columns))} |"]
        lines.append("| --- |" + " ---: |" * len(table.columns))
        lines += [
            f"| {' | '.join((name, *(text for _, _, text in values)))} |"
            for name, values in table.rows
        ]
        lines.append("")
    left = unmeasured_settings(rows)
    if left:
        lines += ["## Not measured", ""]
        lines += [f"- {name} on {series or 'any'}: {reason}" for series, name, reason in left]
    return lines


def _references(series: str, rows: list[Row]) -> Iterator[SweepTable]:
    for point, group in groupby(sorted(rows, key=_by_point), key=_by_point):
        listed = sorted(group, key=lambda r: (r["rms"] is None, r["rms"] or 0.0, r["extractor"]))
        yield SweepTable(
            series,
            f"reference: {point}",
            _describe(series),
            f"Extractor ({rows[0]['unit']})",
            tuple(REFERENCE.values()),
            tuple(
                (
                    row["extractor"],
                    tuple((cell_of(row), name, _number(row[name])) for name in REFERENCE),
                )
                for row in listed
            ),
        )


def _sweep(series: str, sweep: str, rows: list[Row]) -> SweepTable:
    points = list(dict.fromkeys(row["point"] for row in rows))
    by_place = {(row["point"], row["extractor"]): row for row in rows}
    bounds = {row["point"]: row["bound"] for row in rows if row["bound"] is not None}

    def name(point: str, extractor: str) -> str:
        return f"{series}/{sweep}/{point}/{extractor}"

    first = tuple((name(p, _BOUND), _BOUND, _number(bounds.get(p))) for p in points)
    body = [(f"{_BOUND} ({rows[0]['unit']})", first)]
    for extractor in sorted({row["extractor"] for row in rows}):
        shown = tuple(
            (name(p, extractor), "over_bound", _over_bound(by_place.get((p, extractor))))
            for p in points
        )
        body.append((extractor, shown))
    heading = SWEEPS.get(sweep, sweep)
    return SweepTable(
        series, f"{sweep}: {heading}", _describe(series), "Extractor", tuple(points), tuple(body)
    )


def _describe(series: str) -> str:
    return SERIES[series].description if series in SERIES else series


def _by_point(row: Row) -> str:
    return str(row["point"])


def _over_bound(row: Row | None) -> str:
    if row is None or row["found_fraction"] is None:
        return "-"
    share, wrong = row["found_fraction"], row["wrong_fraction"]
    said = _number(row["over_bound"])
    if share < 0.9 and row["over_bound"] is not None:
        said += f" ({share:.2f})"
    # elsewhere a pixel may be the error that is measured, not a wrong answer
    return said + (f" !{wrong:.3g}" if wrong and row["series"] == "frames" else "")


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:#.4g}".rstrip(".")
