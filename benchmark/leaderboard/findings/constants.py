"""What it costs to leave the constants of a projection as drawn."""

from __future__ import annotations

import math
from statistics import median
from typing import Any

from benchmark.contract import Cell
from benchmark.leaderboard.board import NOMINAL
from benchmark.leaderboard.findings.finding import Estimate, Finding, number
from benchmark.leaderboard.findings.record import FindingsRecord, shared

#: The projection with the constants of the drawing, and the same one with fitted constants.
DRAWN, FITTED = "spm", "pinhole"


def constants(record: FindingsRecord) -> Finding:
    """Compare a projection as drawn with the same one fitted on a bench, behind each extractor.

    The extractors of a data set share its sensor, so that it counts once, with their median.
    """
    every = {cell for cell in (*record.rows, *record.unavailable) if cell.model in (DRAWN, FITTED)}
    places = sorted({(cell.dataset, cell.extractor) for cell in every})
    rows = []
    for dataset, extractor in places:
        drawn, fitted = (Cell(dataset, NOMINAL, extractor, model) for model in (DRAWN, FITTED))
        if drawn in record.rows and fitted in record.rows:
            rows.append(_pair(record, drawn, fitted))
    data_sets = sorted({row["dataset"] for row in rows})
    of = "data sets"
    ratio, even = (
        Estimate.median(
            name, [median(r[column] for r in rows if r["dataset"] == one) for one in data_sets], of
        )
        for name, column in (
            ("ratio of errors, drawn over fitted on the standard bench", "bench_ratio"),
            ("error of a bench that cancels the gain, deg", "break_even_deg"),
        )
    )
    worse = sum(row["bench_ratio"] < 1.0 for row in rows)
    missing = len(places) - len(rows)
    return Finding(
        "constants",
        f"A projection with nominal constants has {number(ratio.value)} times the error of one "
        "fitted on a bench.",
        f"Same extractor, the bench's error included: median of {ratio.n} data sets; 95 % interval "
        f"{ratio.interval}. Fitting raises the error in {worse} of {len(rows)} pairs. It pays up "
        f"to a bench error of {number(even.value)} deg ({even.interval}), for the assembly "
        "tolerances of the data sets.",
        (ratio, even),
        (f"{missing} pairs below 95 % availability",) if missing else (),
        tuple(rows),
    )


def _pair(record: FindingsRecord, drawn: Cell, fitted: Cell) -> dict[str, Any]:
    bench = record.bench_deg[drawn.dataset]
    units = list(shared(record.errors[drawn], record.errors[fitted]))
    squares = [one**2 - two**2 for one, two in units]
    return {
        "dataset": drawn.dataset,
        "extractor": drawn.extractor,
        "drawn_deg": record.own_error_deg(drawn),
        "fitted_deg": record.own_error_deg(fitted),
        "units": len(units),
        "bench_deg": bench,
        "bench_ratio": record.ratio(drawn, fitted, (0.0, bench)),
        "break_even_deg": math.sqrt(max(math.fsum(squares) / len(squares), 0.0)),
    }
