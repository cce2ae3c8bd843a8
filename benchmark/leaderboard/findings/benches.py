"""What a better bench buys, by what the detector gives."""

from __future__ import annotations

import math
from typing import Any

from benchmark.contract import Cell
from benchmark.leaderboard.findings.finding import Estimate, Finding, number
from benchmark.leaderboard.findings.record import FindingsRecord, geometric_mean, shared


def benches(record: FindingsRecord) -> Finding:
    """Compare the best pipeline calibrated on drawn benches with itself on true directions."""
    leading: dict[str, Cell] = {}
    for cell in sorted(record.on_bench, key=lambda cell: (record.own_error_deg(cell), cell)):
        leading.setdefault(cell.dataset, cell)
    pairs = [_pair(record, leading[name]) for name in sorted(leading)]
    array, single = (
        Estimate.median(
            f"ratio of errors on drawn benches and own errors, {kind}",
            [pair["ratio"] for pair in pairs if pair["array"] is is_array],
            "data sets",
        )
        for kind, is_array in (("array detectors", True), ("others", False))
    )
    halved, unmoved = (
        Estimate.median(
            f"error with half the bench's over that with all of it, {kind}",
            [pair["half_ratio"] for pair in pairs if pair["array"] is is_array],
            "data sets",
        )
        for kind, is_array in (("array detectors", True), ("others", False))
    )
    confirmed = Estimate.median(
        "error on drawn benches over the root of own and bench error squared",
        [pair["over_computed"] for pair in pairs],
        "data sets",
    )
    missing = len(record.best) - len(pairs)
    raised = (100.0 * (value - 1.0) for value in (single.value, single.low, single.high))
    added, least, most = map(number, raised)
    return Finding(
        "benches",
        f"A bench twice as accurate cuts the error of array detectors by {_cut(halved)}, that of "
        f"others by {_cut(unmoved)}.",
        "Calibrated on simulated benches, the best pipeline of a data set has "
        f"{number(array.value)} times the error it has with true directions for CCD, CMOS, PDA "
        f"and event detectors (median of {array.n} data sets; 95 % interval {array.interval}), "
        f"and {added} % more for other detectors ({single.n}; {least} to {most} %). Standard "
        f"benches err by {_benches(record)} RMS. Errors of sensor and bench add as squares: "
        f"measured ones are {confirmed.value:.2f} times that sum ({confirmed.low:.2f} to "
        f"{confirmed.high:.2f}).",
        (array, single, halved, unmoved, confirmed),
        (f"{missing} data sets without drawn benches",) if missing else (),
        tuple(pairs),
    )


def _pair(record: FindingsRecord, cell: Cell) -> dict[str, Any]:
    bench = record.bench_deg[cell.dataset]
    own = record.own_error_deg(cell)
    both = list(shared(record.on_bench[cell], record.errors[cell]))
    return {
        "dataset": cell.dataset,
        **{name: record.rows[cell][name] for name in ("detector", "mask")},
        "extractor": cell.extractor,
        "model": cell.model,
        "array": record.is_array(cell),
        "units": len(both),
        "own_error_deg": own,
        "bench_deg": bench,
        "ratio": geometric_mean([one / two for one, two in both]),
        "over_computed": math.sqrt(
            math.fsum(one**2 for one, _ in both) / math.fsum(two**2 + bench**2 for _, two in both)
        ),
        "half_ratio": math.hypot(own, bench / 2.0) / math.hypot(own, bench),
    }


def _cut(ratio: Estimate) -> str:
    """Say by how much an error falls, with its interval."""
    low, middle, high = (100.0 * (1.0 - value) for value in (ratio.high, ratio.value, ratio.low))
    return f"{number(middle)} % ({number(low)} to {number(high)} %)"


def _benches(record: FindingsRecord) -> str:
    errors = sorted(set(record.bench_deg.values()))
    return " or ".join(f"{number(error)} deg" for error in errors)
