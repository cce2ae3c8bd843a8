"""The five findings, each a question asked of the published record."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from statistics import median
from typing import Any

from algorithms.calibration.drawn import DrawnModel
from algorithms.chain import Chain
from benchmark.contract import Cell
from benchmark.error_budget.sentences import NEAR, bound_of, contributions
from benchmark.leaderboard.board import NOMINAL
from benchmark.leaderboard.findings.finding import Estimate, Finding, number
from benchmark.leaderboard.findings.record import ARRAYS, FindingsRecord, geometric_mean, shared
from benchmark.learning_curves.floor import NEAR as NEAR_FLOOR
from benchmark.metrics.score import AVAILABLE
from registry.catalogue import catalogue
from registry.resolution import Resolution
from registry.studies import METHODS

#: Times the error over observable samples above which an error is mostly that of false detections.
PENALTY = 2.0
#: What a method rests on that is not the study's: memory, or a choice of ours.
_NOT_THE_STUDYS = frozenset({"recalled", "defaulted"})


@dataclass(frozen=True)
class Use:
    """A pipeline of a study on a data set, as the registry maps it."""

    study: str
    cell: Cell
    chosen: bool


def methods(record: FindingsRecord, resolutions: Mapping[str, Resolution]) -> Finding:
    """Compare the best method of each study with the best one measured on the same data set.

    Pipelines that several studies share count once.
    """
    uses = [use for use in _uses(resolutions) if use.cell in record.rows]
    left_out = [_without(set(resolutions) - {use.study for use in uses}, "without a score")]
    for keep, said in _steps(record):
        kept = [use for use in uses if keep(use)]
        left_out.append(_without({use.study for use in uses} - {use.study for use in kept}, said))
        uses = kept
    best = _best_of_studies(record, uses)
    users: dict[Cell, list[str]] = {}
    for study, cell in sorted(best.items()):
        users.setdefault(cell, []).append(study)
    pairs = tuple(_pair_of_methods(record, cell, users[cell]) for cell in sorted(users))
    one = f"pipelines of {len(best)} studies"
    own = Estimate.median("ratio of own errors", [pair["ratio"] for pair in pairs], one)
    bench = Estimate.median(
        "ratio of errors on the standard bench", [pair["bench_ratio"] for pair in pairs], one
    )
    return Finding(
        "methods",
        f"A calibrated method of a study has {number(own.value)} times the own error of the best "
        f"one, and {number(bench.value)} times its error on a bench.",
        f"Median of {own.n} pipelines that {len(best)} studies used, each against the best one "
        f"measured on the same data set; 95 % interval {own.interval} with true directions, "
        f"{bench.interval} with the error of the standard bench in both.",
        (own, bench),
        tuple(filter(None, left_out)),
        pairs,
    )


def _uses(resolutions: Mapping[str, Resolution]) -> Iterator[Use]:
    for study, found in resolutions.items():
        for pipeline in found.pipelines:
            chosen = any(pipeline.basis[part] in _NOT_THE_STUDYS for part in METHODS)
            for dataset in dict.fromkeys(setting.dataset for setting in pipeline.settings):
                cell = Cell(dataset, NOMINAL, pipeline.extractor, pipeline.model)
                yield Use(study, cell, chosen)


def _steps(record: FindingsRecord) -> tuple[tuple[Callable[[Use], bool], str], ...]:
    """Return what a use has to be, and how those are called that are not, in order."""

    def honest(use: Use) -> bool:
        row = record.rows[use.cell]
        return bool(row["rms_all_answers_deg"] <= PENALTY * row["rms_deg"])

    return (
        (honest, "whose error is mostly that of false detections"),
        (lambda use: not use.chosen, "whose extractor or model we chose"),
        (lambda use: not is_drawn(use.cell.model), "whose model has no fitted constant"),
    )


def is_drawn(model: str) -> bool:
    """Return whether a model takes all its constants from the drawing."""
    scored = catalogue().models[model]
    last = scored.model if isinstance(scored, Chain) else scored
    return issubclass(last, DrawnModel)


def _without(studies: set[str], said: str) -> str:
    named = f" ({', '.join(sorted(studies))})" if len(studies) <= 3 else ""
    noun = "study" if len(studies) == 1 else "studies"
    return f"{len(studies)} {noun} {said}{named}" if studies else ""


def _best_of_studies(record: FindingsRecord, uses: list[Use]) -> Mapping[str, Cell]:
    """Return the pipeline of each study that is nearest to the best on its data set."""
    found: dict[str, tuple[float, Cell]] = {}
    for use in uses:
        place = record.ratio(use.cell, record.best[use.cell.dataset]), use.cell
        found[use.study] = min(found.get(use.study, place), place)
    return {study: cell for study, (_, cell) in found.items()}


def _pair_of_methods(record: FindingsRecord, cell: Cell, studies: list[str]) -> dict[str, Any]:
    best, bench = record.best[cell.dataset], record.bench_deg[cell.dataset]
    return {
        "dataset": cell.dataset,
        "extractor": cell.extractor,
        "model": cell.model,
        "studies": studies,
        "own_error_deg": record.own_error_deg(cell),
        "best_extractor": best.extractor,
        "best_model": best.model,
        "best_own_error_deg": record.own_error_deg(best),
        "bench_deg": bench,
        "ratio": record.ratio(cell, best),
        "bench_ratio": record.ratio(cell, best, (bench, bench)),
    }


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
            rows.append(_pair_of_constants(record, drawn, fitted))
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


def _pair_of_constants(record: FindingsRecord, drawn: Cell, fitted: Cell) -> dict[str, Any]:
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


def benches(record: FindingsRecord) -> Finding:
    """Compare the best pipeline calibrated on drawn benches with itself on true directions."""
    leading: dict[str, Cell] = {}
    for cell in sorted(record.on_bench, key=lambda cell: (record.own_error_deg(cell), cell)):
        leading.setdefault(cell.dataset, cell)
    pairs = [_pair_of_benches(record, leading[name]) for name in sorted(leading)]
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


def _pair_of_benches(record: FindingsRecord, cell: Cell) -> dict[str, Any]:
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


#: Share of the squared error from which on a source dominates.
DOMINANT = 0.5


def sources(
    budgets: Mapping[str, Mapping[str, Any]], architectures: Mapping[str, tuple[str, str]]
) -> Finding:
    """Compare the best pipeline of each data set with its bound and with true spot positions."""
    pairs = [
        _pair_of_sources(name, row, *architectures[name]) for name, row in sorted(budgets.items())
    ]
    arrays = [p for p in pairs if p["detector"] in ARRAYS and p["extractor_share"] is not None]
    led = [pair for pair in arrays if pair["extractor_share"] > DOMINANT]
    distance = Estimate.median("ratio to the bound", [p["over_bound"] for p in pairs], "data sets")
    near = Estimate.share(
        f"within {NEAR:g} times the bound",
        sum(pair["over_bound"] <= NEAR for pair in pairs),
        len(pairs),
        "data sets",
    )
    biased = Estimate.share(
        "extractor's bias over half of the squared error", len(led), len(arrays), "data sets"
    )
    return Finding(
        "sources",
        "The bias of the extractor, not noise, limits the best pipeline on "
        f"{len(led)} of {len(arrays)} data sets of array detectors: {_masks(led, arrays)}.",
        "There it makes up more than half of the squared error (95 % interval of the share "
        f"{biased.interval}). Over all {distance.n} data sets the best pipeline has "
        f"{number(distance.value)} times the error of its Cramer-Rao bound (median; "
        f"{distance.interval}), and {round(near.value * near.n)} are within {NEAR:g} times "
        f"({near.interval}).",
        (distance, near, biased),
        (f"from the share, {len(pairs) - len(arrays)} data sets without an array detector",),
        tuple(pairs),
    )


def _pair_of_sources(name: str, row: Mapping[str, Any], detector: str, mask: str) -> dict[str, Any]:
    bias = contributions(dict(row)).get("extractor")
    return {
        "dataset": name,
        "detector": detector,
        "mask": mask,
        "extractor": row["extractor"],
        "model": row["model"],
        "rms_deg": row["rms_deg"],
        "bound_deg": bound_of(row),
        "over_bound": row["rms_deg"] / bound_of(row),
        "extractor_share": None if bias is None else min((bias / row["as_is_deg"]) ** 2, 1.0),
    }


def _masks(led: list[dict[str, Any]], arrays: list[dict[str, Any]]) -> str:
    """Name the masks of the data sets that it limits, each with how many of how many."""

    def count(mask: str, pairs: list[dict[str, Any]]) -> int:
        return sum(pair["mask"] == mask for pair in pairs)

    masks = sorted(
        {pair["mask"] for pair in led}, key=lambda m: (-count(m, led) / count(m, arrays), m)
    )
    return ", ".join(f"{mask} {count(mask, led)} of {count(mask, arrays)}" for mask in masks)


Row = Mapping[str, Any]


def poses(curves: Iterable[Row]) -> Finding:
    """Count the poses from which on the best pipeline is near its floor, with and without bench."""
    first = [row for row in curves if row["place"] == 1]
    kept = [row for row in first if not row["in_order"]]
    pairs = [_pair_of_poses(row) for row in kept]
    of = "data sets"
    own, bench, answers = (
        Estimate.median(name, [_or_more(pair[column]) for pair in pairs], of)
        for name, column in (
            ("poses for the error with true directions", "own_poses"),
            ("poses for the error on the standard bench", "bench_poses"),
            ("poses for 95 % of answers", "answer_poses"),
        )
    )
    return Finding(
        "poses",
        f"On a bench, {number(bench.value)} calibration poses are enough for the accuracy, and "
        f"{number(answers.value)} for the field.",
        f"From {number(bench.value)} random poses on (median of {bench.n} data sets; 95 % interval "
        f"{bench.interval}) the error of the best pipeline on the standard bench is within "
        f"{100 * (NEAR_FLOOR - 1):.0f} % of its floor; with true directions from "
        f"{number(own.value)} on "
        f"({own.interval}). It answers {100 * AVAILABLE:.0f} % of the test split from "
        f"{number(answers.value)} on ({answers.interval}), because models answer only inside the "
        "hull of their poses; a planned grid may need fewer.",
        (own, bench, answers),
        (f"{len(first) - len(kept)} flights, which have no choice of poses",),
        tuple(pairs),
    )


def _pair_of_poses(row: Row) -> dict[str, Any]:
    bench = row["bench_deg"]
    return {
        "dataset": row["dataset"],
        "extractor": row["extractor"],
        "model": row["model"],
        "floor_deg": row["floor_error_deg"],
        "bench_deg": bench,
        "poses_given": row["poses"],
        "own_poses": _from(row, lambda point: _is_near(point, row["floor_error_deg"], 0.0)),
        "bench_poses": _from(row, lambda point: _is_near(point, row["floor_error_deg"], bench)),
        "answer_poses": _from(row, _answers),
    }


def _from(row: Row, meets: Callable[[Row], bool]) -> int | None:
    """Return the smallest number of poses from which on every point meets a condition."""
    found: int | None = None
    for point in reversed(row["points"]):
        if point["refused"] or not meets(point):
            break
        found = point["poses"]
    return found


def _is_near(point: Row, floor_deg: float | None, bench_deg: float) -> bool:
    if floor_deg is None or point["middle_deg"] is None:
        return False
    limit = NEAR_FLOOR * math.hypot(floor_deg, bench_deg)
    return math.hypot(point["middle_deg"], bench_deg) <= limit


def _answers(point: Row) -> bool:
    return bool(point["availability"] is not None and point["availability"] >= AVAILABLE)


def _or_more(count: int | None) -> float:
    return math.inf if count is None else float(count)
