"""The gap: reported accuracy, error in flight, own error and bound of architectures on one axis."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from statistics import median
from typing import Any

from api.figures.figure import Figure
from api.figures.specification import HOVER, TEXT, Plotly, axis, colour, mark, specification
from api.schema.measured_figures import GapRow
from api.schema.table import columns_of
from benchmark.leaderboard.summaries import digits

NAME = "gap"
TITLE = "Claimed, built, simulated, possible"
CAPTION = (
    "RMS error of each architecture: as studies and products report it, in simulated flight "
    "(calibrated on the ground once, then flown), own (calibrated with true directions), and the "
    "Cramer-Rao bound with the sensor unit known, in orbit its drift, too. Measured numbers are of "
    "one pipeline each; sensors differ in field and height."
)
Row = Mapping[str, Any]
Marks = Sequence[tuple[Row, str, float]]

_NEAR = 2.0  # times the bound
_MEASURED = {
    "bound": ("bound_deg", "", ""),
    "own error": ("own_error_deg", "own_low_deg", "own_high_deg"),
    "in flight": ("flight_error_deg", "flight_low_deg", "flight_high_deg"),
}
_SYMBOLS = {
    "reported by a study": ("circle-open", colour(0)),
    "reported by a product": ("x", colour(1)),
    "in flight": ("diamond", colour(2)),
    "own error": ("square", colour(5)),
    "bound": ("line-ns", TEXT),
}


def gap_figure(rows: Sequence[dict[str, Any]], level: str) -> Figure:
    """Return the figure of rows of the gap, in their order from the top."""
    return Figure(
        name=NAME,
        title=TITLE,
        caption=CAPTION,
        text=tuple(_text(rows)),
        columns=columns_of(GapRow),
        rows=tuple(rows),
        plotly=_plotly(rows),
        options={"level": level},
    )


def label(row: Row) -> str:
    """Return the name of an architecture."""
    return f"{row['detector']} + {row['mask']}"


def smallest_report(row: Row) -> float | None:
    """Return the smallest reported accuracy of an architecture, degrees."""
    return min((*row["study_rms_deg"], *row["product_rms_deg"]), default=None)


def _plotly(rows: Sequence[Row]) -> Plotly:
    return specification(
        list(_traces(rows)),
        height=130 + 23 * len(rows),
        narrowest=400,
        xaxis=axis("RMS error, deg", type="log", dtick=1, exponentformat="none"),
        yaxis=axis(
            type="category",
            categoryorder="array",
            categoryarray=[label(row) for row in rows],
            autorange="reversed",
        ),
    )


def _traces(rows: Sequence[Row]) -> Iterator[dict[str, Any]]:
    for names, kind in (("studies", "study"), ("products", "product")):
        marks = [
            (row, f"{name} reports {digits(rms)} deg ({label(row)})", rms)
            for row in rows
            for name, rms in zip(row[names], row[f"{kind}_rms_deg"], strict=True)
        ]
        yield _trace(f"reported by a {kind}", marks)
    for name, (column, low, high) in _MEASURED.items():
        known = [row for row in rows if row[column] is not None]
        marks = [
            (row, f"{label(row)}, {name}: {digits(row[column])} deg{_pipeline(row)}", row[column])
            for row in known
        ]
        ends = [(row[column], row.get(low), row.get(high)) for row in known]
        interval = {
            "array": [0.0 if most is None else most - error for error, _, most in ends],
            "arrayminus": [0.0 if least is None else error - least for error, least, _ in ends],
        }
        shown = {"error_x": {"type": "data", "thickness": 1.2, "width": 0, **interval}}
        yield _trace(name, marks) | (shown if low else {})


def _pipeline(row: Row) -> str:
    return f", {row['extractor']} + {row['model']} on {row['dataset']}"


def _trace(name: str, marks: Marks) -> dict[str, Any]:
    symbol, tone = _SYMBOLS[name]
    return {
        "type": "scatter",
        "mode": "markers",
        "name": name,
        "x": [error for _, _, error in marks],
        "y": [label(row) for row, _, _ in marks],
        "customdata": [mark(said, row["page"]) for row, said, _ in marks],
        "hovertemplate": HOVER,
        "marker": {
            "symbol": symbol,
            "color": tone,
            "size": 9,
            "line": {"width": 1.5, "color": tone},
        },
    }


def _one(row: Row) -> str:
    """Say the numbers of one architecture."""
    numbers = {"smallest report": smallest_report(row)}
    numbers |= {name: row[column] for name, (column, *_) in reversed(_MEASURED.items())}
    said = [f"{name} {digits(value)} deg" for name, value in numbers.items() if value is not None]
    return f"{label(row)}: {', '.join(said) or 'nothing reported or measured'}."


def _text(rows: Sequence[Row]) -> Iterator[str]:
    if len(rows) == 1:
        yield _one(rows[0])
        return
    best = [smallest_report(row) for row in rows]
    flown = [row["flight_error_deg"] for row in rows]
    yield (
        f"Architectures: {len(rows)}, of which {sum(b is not None for b in best)} have a reported "
        f"accuracy and {sum(f is not None for f in flown)} are flown in simulation."
    )
    both = [(b, f) for b, f in zip(best, flown, strict=True) if b is not None and f is not None]
    if both:
        yield (
            f"Of {len(both)} with both, for {sum(b > f for b, f in both)} the best reported sensor "
            f"errs more than the simulated one in flight; for {sum(b < f for b, f in both)} the "
            "report is the smaller number."
        )
    ratios = [f / row["own_error_deg"] for f, row in zip(flown, rows, strict=True) if f]
    if ratios:
        yield (
            f"The error in flight is {digits(min(ratios))} to {digits(max(ratios))} times the own "
            f"error, median {digits(median(ratios))}."
        )
    over = [
        r["own_error_deg"] / r["bound_deg"] for r in rows if r["own_error_deg"] and r["bound_deg"]
    ]
    if over:
        near = sum(one <= _NEAR for one in over)
        yield f"The own error is within {_NEAR:g} times the bound for {near} of {len(over)}."
