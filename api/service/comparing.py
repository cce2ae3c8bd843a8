"""Compare two to four pipelines of a data set, or architectures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from api.schema.comparison import (
    FEWEST,
    MOST,
    SEPARATOR,
    ComparedRow,
    CompareQuery,
    MaskAtEqualHeight,
)
from api.schema.table import columns_of
from api.service.documents import Document
from api.service.knowledge import Knowledge
from api.service.problems import Problem, Violation
from benchmark.equal_height.record import equal_rows
from benchmark.leaderboard.architectures import architectures as best_of_each
from benchmark.leaderboard.partial_answers import PartialAnswer, better_partial_answer
from registry.height_order import at_reference
from registry.taxonomy import InvalidValueError
from survey_data.nearest import nearest_name

_SCORE = (
    *(
        "dataset",
        "condition",
        "extractor",
        "model",
        "studies",
        "own_error_deg",
        "low_deg",
        "high_deg",
    ),
    *("unit_rms_deg", "on_bench_deg", "bound_deg", "over_bound", "over_bound_se"),
    *(
        "availability",
        "false_detection_rate",
        "latency_us",
        "time_ratio",
        "half_fov_deg",
        "rank",
        "status",
    ),
    "reason",
)
_CURVE = ("needed_poses", "needed_low", "needed_high", "poses", "floor_error_deg")
#: In words: the array of `benchmark.equal_height.designs`, without loading the simulator.
EQUAL_DETECTOR = "CMOS array of 512 x 512 pixels of 12 um, or lines of such pixels"
_NAMED = ("dataset", "extractor", "model")
_FINER = (*_NAMED, "own_error_deg", "availability")
_OF_CONDITION = ("rms_all_answers_deg", "availability")
_RING = ("inner_deg", "outer_deg", "rms_deg")


def compare(known: Knowledge, query: CompareQuery) -> Document:
    """Compare two to four pipelines of a data set, or two to four architectures.

    Error, bound, availability, time, calibration poses, errors by condition and off-axis angle, and
    studies. CSV: a row each, without errors by condition and angle.
    """
    try:
        document = _compare(known.of(query.edition), query)
    except InvalidValueError as error:
        came = None if error.value is None else str(error.value)
        violation = Violation(error.parameter, came, error.expected, error.nearest)
        raise Problem(400, "not-comparable", errors=[violation]) from error
    return Document(document, columns_of(ComparedRow), lambda: document["items"])


def equal_heights(known: Knowledge) -> Document:
    """Compare masks over the same detector, at the same height, over the same field.

    Each is read by the pipeline that is best on one sensor unit, and quoted on others. By error in
    flight. `sunatlas compare --equal` measures other heights and fields.
    """
    return equal_document(equal_rows(known.measurements.directory))


def equal_document(rows: Sequence[Mapping[str, Any]]) -> Document:
    """Return rows of the comparison at equal height as a document."""
    document = {"detector": EQUAL_DETECTOR, "items": rows}
    return Document(document, columns_of(MaskAtEqualHeight), lambda: rows)


def _compare(known: Knowledge, query: CompareQuery) -> dict[str, Any]:
    if query.architecture:
        for other in ("dataset", "pipeline", "condition"):
            if given := getattr(query, other):
                expected = "nothing beside `architecture`, which has data sets of its own"
                raise InvalidValueError(other, str(given), expected)
        return compare_architectures(known, query.architecture)
    if query.dataset is None:
        raise InvalidValueError("dataset", None, "a data set with its pipelines, or architectures")
    return compare_pipelines(known, query.dataset, query.pipeline, query.condition)


def compare_pipelines(
    known: Knowledge, dataset: str, pipelines: Sequence[str], condition: str | None = None
) -> dict[str, Any]:
    """Compare pipelines ("extractor:model") on a data set, under its first condition by default.

    Items are in the given order. InvalidValueError if the data set has no such condition, if there
    are fewer than two or more than four pipelines, or if one is not scored on the data set.
    """
    _count("pipeline", pipelines)
    rows = known.measurements.board_rows(dataset)
    conditions = list(dict.fromkeys(known.measurements.presets[dataset].conditions))
    condition = conditions[0] if condition is None else condition
    _one_of("condition", condition, conditions)
    by: dict[str, dict[str, Mapping[str, Any]]] = {}
    for row in rows:
        by.setdefault(_name(row), {})[row["condition"]] = row
    for pipeline in pipelines:
        if pipeline not in by:
            expected = f"extractor{SEPARATOR}model, a pipeline that is scored on {dataset}"
            raise InvalidValueError(
                "pipeline", pipeline, expected, nearest_name(pipeline, sorted(by), cutoff=0)
            )
    items = [_item(known, by[pipeline], condition) for pipeline in pipelines]
    return {"dataset": dataset, "condition": condition, "items": _with_ratio(items)}


def compare_architectures(known: Knowledge, architectures: Sequence[str]) -> dict[str, Any]:
    """Compare architectures ("detector:mask"), each by its most accurate nominal pipeline.

    Each item has its own data set, the one with the smallest error if an architecture has several.
    InvalidValueError if there are fewer than two or more than four architectures, or if neither a
    data set nor a study has one of them.
    """
    _count("architecture", architectures)
    best = {
        f"{row['detector']}{SEPARATOR}{row['mask']}": row
        for row in best_of_each(known.measurements.leaderboard)
    }
    proposed: dict[str, list[str]] = {}
    for study in known.facts.studies.values():
        for detector, mask in study.architectures:
            proposed.setdefault(f"{detector}{SEPARATOR}{mask}", []).append(study.key)
    items = []
    for name in architectures:
        _one_of("architecture", name, sorted({*best, *proposed}))
        items.append(_architecture(known, name, best.get(name)))
    for item, name in zip(items, architectures, strict=True):
        item["proposed"] = sorted(proposed.get(name, ()))
    return {"dataset": None, "condition": None, "items": _with_ratio(items)}


def _architecture(known: Knowledge, name: str, best: Mapping[str, Any] | None) -> dict[str, Any]:
    if best is None or best["dataset"] is None:
        detector, _, mask = name.partition(SEPARATOR)
        without = "no data set" if best is None else "no pipeline has an error"
        nothing = dict.fromkeys((*_SCORE, *_CURVE, "conditions", "rings"))
        return {
            "detector": detector,
            "mask": mask,
            **nothing,
            "height_mm": None,
            "studies": [],
            "status": "none",
            "reason": without,
            "conditions": {},
            "rings": [],
            "partial_answer": None,
        }
    wanted = f"{best['extractor']}{SEPARATOR}{best['model']}"
    board = known.measurements.board_rows(best["dataset"])
    rows = {row["condition"]: row for row in board if _name(row) == wanted}
    item = _item(known, rows, known.measurements.presets[best["dataset"]].conditions[0])
    for condition, scored in item["conditions"].items():
        others = [row for row in board if row["condition"] == condition and _name(row) != wanted]
        scored["partial_answer"] = _finer(others, scored["rms_all_answers_deg"])
    finer = {name: best[f"partial_{name}"] for name in _FINER}
    return {**item, "partial_answer": None if finer["dataset"] is None else finer}


def _finer(rows: Sequence[Mapping[str, Any]], error_deg: float | None) -> dict[str, Any] | None:
    """Return the pipeline with an error far below a given one, at lower availability."""
    if error_deg is None:
        return None
    found = better_partial_answer(
        error_deg,
        [
            PartialAnswer(row["rms_all_answers_deg"], row["availability"] or 0.0, row)
            for row in rows
            if row["rms_all_answers_deg"] is not None
        ],
    )
    if found is None:
        return None
    return {name: found.subject[name] for name in (*_NAMED, *_OF_CONDITION)}


def _item(
    known: Knowledge, rows: Mapping[str, Mapping[str, Any]], condition: str
) -> dict[str, Any]:
    any_row = next(iter(rows.values()))
    if condition in rows:
        row = rows[condition]
    else:
        # Not planned under this condition: names only.
        named = (*_NAMED, "half_fov_deg")
        row = {
            **dict.fromkeys(_SCORE),
            **{name: any_row[name] for name in named},
            "condition": condition,
            "studies": any_row["studies"],
            "status": "none",
            "reason": "not measured under this condition",
        }
    place = tuple(any_row[name] for name in _NAMED)
    curve = known.measurements.curve_of.get(place, {})
    return {
        **{name: any_row[name] for name in ("detector", "mask")},
        **{name: row[name] for name in _SCORE},
        "height_mm": known.measurements.presets[row["dataset"]].geometry.focal_length_mm,
        **{name: curve.get(name) for name in _CURVE},
        "conditions": {
            name: {**{what: scored[what] for what in _OF_CONDITION}, "partial_answer": None}
            for name, scored in rows.items()
        },
        "partial_answer": None,
        "rings": _rings(row),
    }


def _rings(row: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the error of each ring of off-axis angles that has one."""
    found = []
    for name, value in row.items():
        parts = name.split("_")  # rms_<inner>_<outer>_deg
        if len(parts) == 4 and parts[0] == "rms" and parts[1].isdigit() and value is not None:
            edges = (float(parts[1]), float(parts[2]), value)
            found.append(dict(zip(_RING, edges, strict=True)))
    return found


def _with_ratio(items: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Add to each item its own error divided by the smallest of them."""
    least = min((i["own_error_deg"] for i in items if i["own_error_deg"] is not None), default=None)
    for item in items:
        error = item["own_error_deg"]
        item["ratio_to_smallest"] = error / least if least and error is not None else None
        item["own_at_1_mm_deg"] = at_reference(error, item["height_mm"])
        item.setdefault("proposed", None)
    return items


def _name(row: Mapping[str, Any]) -> str:
    return f"{row['extractor']}{SEPARATOR}{row['model']}"


def _count(what: str, given: Sequence[str]) -> None:
    if not FEWEST <= len(set(given)) == len(given) <= MOST:
        expected = f"from {FEWEST} to {MOST} values, each another"
        raise InvalidValueError(what, ", ".join(given) or None, expected)


def _one_of(what: str, given: str, words: Sequence[str]) -> None:
    if given not in words:
        near = nearest_name(given, words, cutoff=0)
        raise InvalidValueError(what, given, f"one of {', '.join(words)}", near)
