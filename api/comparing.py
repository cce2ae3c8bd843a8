"""Two to four pipelines of a data set, or architectures, side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from benchmark.leaderboard.architectures import architectures as best_of_each
from registry.measured_pipelines import Partly, finer_for
from registry.taxonomy import InvalidValueError
from survey_data.nearest import nearest

if TYPE_CHECKING:
    from api.http.knowledge import Knowledge

FEWEST, MOST = 2, 4
SEPARATOR = ":"
"""Between extractor and model, and between detector and mask."""

_SCORE = (
    *("dataset", "condition", "extractor", "model", "studies", "rms_deg", "bound_deg"),
    *(
        "over_bound",
        "over_bound_se",
        "own_deg",
        "on_bench_deg",
        "low_deg",
        "high_deg",
        "unit_rms_deg",
    ),
    *("availability", "false_sun", "latency_us", "time_ratio", "half_fov_deg", "rank", "status"),
    "reason",
)
_CURVE = ("needed_poses", "needed_low", "needed_high", "poses", "floor_error_deg")
_FINER = ("dataset", "extractor", "model", "rms_deg", "availability")
_RING = ("inner_deg", "outer_deg", "rms_deg")


def compare_pipelines(
    known: Knowledge, dataset: str, pipelines: Sequence[str], condition: str | None = None
) -> dict[str, Any]:
    """Compare pipelines on a data set.

    Parameters
    ----------
    known : what is measured
    dataset : name of a standard data set
    pipelines : "extractor:model" each, by the names of the implementations
    condition : of the data set; its first by default

    Returns
    -------
    dict
        ``dataset``, ``condition`` and ``items``, a row a pipeline in the order given: names, error,
        bound, availability, times, studies; ``needed_poses`` and what else its learning curve says
        (None where it has none, as all but the leaders); ``conditions``, its error and availability
        by condition; ``rings``, its error by angle off the boresight. Numbers are None where
        undefined; ``reason`` says why a pipeline has no score. ``over_least`` is its error over the
        least of those compared. ``finer`` is of architectures alone, and None here.

    Raises
    ------
    InvalidValueError
        For a condition the data set lacks, fewer than two or more than four pipelines, and one that
        is not scored there.
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
                "pipeline", pipeline, expected, nearest(pipeline, sorted(by), cutoff=0)
            )
    items = [_item(known, by[pipeline], condition) for pipeline in pipelines]
    return {"dataset": dataset, "condition": condition, "items": _beside(items)}


def compare_architectures(known: Knowledge, architectures: Sequence[str]) -> dict[str, Any]:
    """Compare architectures, each by its best pipeline under nominal conditions.

    Parameters
    ----------
    known : what is measured
    architectures : "detector:mask" each

    Returns
    -------
    dict
        As `compare_pipelines`, with ``dataset`` and ``condition`` None, as each item has its own:
        of several data sets of an architecture the one whose best pipeline errs least. Fields of
        view differ (``half_fov_deg``); ``rings`` compare at equal angles. ``finer`` is what errs
        far less on the part of the samples that it answers, by the leaderboard's rule; that of a
        condition is any pipeline of the data set that errs far less there and answers half of the
        samples or more, as another than the nominal best is chosen where that condition is asked
        for (`registry.measured_pipelines.finer_for`). None where nothing does.

    Raises
    ------
    InvalidValueError
        For fewer than two or more than four, and for one that neither a data set nor a study has.
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
    return {"dataset": None, "condition": None, "items": _beside(items)}


def _architecture(known: Knowledge, name: str, best: Mapping[str, Any] | None) -> dict[str, Any]:
    if best is None or best["dataset"] is None:
        detector, _, mask = name.partition(SEPARATOR)
        without = "no data set" if best is None else "no pipeline has an error"
        nothing = dict.fromkeys((*_SCORE, *_CURVE, "conditions", "rings"))
        return {
            "detector": detector,
            "mask": mask,
            **nothing,
            "studies": [],
            "status": "none",
            "reason": without,
            "conditions": {},
            "rings": [],
            "finer": None,
        }
    wanted = f"{best['extractor']}{SEPARATOR}{best['model']}"
    board = known.measurements.board_rows(best["dataset"])
    rows = {row["condition"]: row for row in board if _name(row) == wanted}
    item = _item(known, rows, known.measurements.presets[best["dataset"]].conditions[0])
    for condition, told in item["conditions"].items():
        others = [row for row in board if row["condition"] == condition and _name(row) != wanted]
        told["finer"] = _finer(others, told["rms_deg"])
    finer = {name: best[f"finer_{name}"] for name in _FINER}
    return {**item, "finer": None if finer["dataset"] is None else finer}


def _finer(rows: Sequence[Mapping[str, Any]], error_deg: float | None) -> dict[str, Any] | None:
    """Return the pipeline with an error far below a given one, at lower availability."""
    if error_deg is None:
        return None
    found = finer_for(
        error_deg,
        [
            Partly(row["rms_deg"], row["availability"] or 0.0, row)
            for row in rows
            if row["rms_deg"] is not None
        ],
    )
    return None if found is None else {name: found.of[name] for name in _FINER}


def _item(
    known: Knowledge, rows: Mapping[str, Mapping[str, Any]], condition: str
) -> dict[str, Any]:
    any_row = next(iter(rows.values()))
    if condition in rows:
        row = rows[condition]
    else:
        # Not planned there: the pipeline is named, and that is all.
        named = ("dataset", "extractor", "model", "half_fov_deg")
        row = {
            **dict.fromkeys(_SCORE),
            **{name: any_row[name] for name in named},
            "condition": condition,
            "studies": any_row["studies"],
            "status": "none",
            "reason": "not measured under this condition",
        }
    place = tuple(any_row[name] for name in ("dataset", "extractor", "model"))
    curve = known.measurements.curve_of.get(place, {})
    return {
        **{name: any_row[name] for name in ("detector", "mask")},
        **{name: row[name] for name in _SCORE},
        **{name: curve.get(name) for name in _CURVE},
        "conditions": {
            name: {**{what: scored[what] for what in ("rms_deg", "availability")}, "finer": None}
            for name, scored in rows.items()
        },
        "finer": None,
        "rings": _rings(row),
    }


def _rings(row: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the error by off-axis angle, of the rings that have one."""
    found = []
    for name, value in row.items():
        parts = name.split("_")  # rms_<inner>_<outer>_deg
        if len(parts) == 4 and parts[0] == "rms" and parts[1].isdigit() and value is not None:
            edges = (float(parts[1]), float(parts[2]), value)
            found.append(dict(zip(_RING, edges, strict=True)))
    return found


def _beside(items: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return items with their error over the least of them."""
    least = min((i["rms_deg"] for i in items if i["rms_deg"] is not None), default=None)
    for item in items:
        error = item["rms_deg"]
        item["over_least"] = error / least if least and error is not None else None
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
        near = nearest(given, words, cutoff=0)
        raise InvalidValueError(what, given, f"one of {', '.join(words)}", near)
