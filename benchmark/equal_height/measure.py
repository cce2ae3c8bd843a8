"""What one worker does: the pipelines that read a mask best, on one design and several units."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from algorithms.chain import Scored
from algorithms.contract import Extractor
from benchmark.contract import FLIGHT
from benchmark.datasets.preset import Preset
from benchmark.equal_height.designs import DESIGNS, Place, UnfitError, preset
from benchmark.metrics.ranking import UnitErrors
from benchmark.metrics.score import Score, is_available
from benchmark.metrics.separation import store
from benchmark.running.stages import Task
from benchmark.running.task import measure as score_task

Row = Mapping[str, Any]

#: Extractors tried on a design, each in its best pipeline on the standard data set of the mask.
TRIED = 5
#: Units that errors are quoted on; the standard one chooses the pipeline.
UNITS = 9


@dataclass(frozen=True)
class EqualTask:
    """A design at a place, and the pipelines tried on it."""

    design: str
    place: Place
    pipelines: tuple[tuple[type[Extractor], Scored], ...]
    units: int = UNITS


def candidates(scores: Iterable[Row], dataset: str, condition: str) -> list[tuple[str, str]]:
    """Return the best pipelines (extractor, model) of a data set's standard unit, best first.

    One an extractor, `TRIED` at most, of those that answer often enough to be ranked.
    """
    rows = [
        row
        for row in scores
        if (row["dataset"], row["condition"], row["unit"]) == (dataset, condition, 0)
        and row["rms_all_answers_deg"] is not None
        and is_available(row)
    ]
    rows.sort(key=lambda row: (row["rms_all_answers_deg"], row["extractor"], row["model"]))
    best: dict[str, str] = {}
    for row in rows:
        best.setdefault(row["extractor"], row["model"])
    return list(best.items())[:TRIED]


def measure(task: EqualTask) -> dict[str, Any]:
    """Return the row of a design: its best pipeline's errors, or the reason why it has none.

    Chosen on the standard unit under the first condition, quoted on others, where it is calibrated
    with true directions; flown as it was chosen.
    """
    design = DESIGNS[task.design]
    row: dict[str, Any] = {
        "design": task.design,
        "mask": design.mask,
        "height_mm": task.place.height_mm,
        "half_fov_deg": task.place.half_fov_deg,
        "units": task.units,
        **dict.fromkeys(("extractor", "model"), ""),
        **dict.fromkeys(_NUMBERS),
        "reason": "",
    }
    try:
        built = preset(task.design, task.place)
    except UnfitError as error:
        return {**row, "reason": str(error)}
    nominal = built.conditions[0]
    tried = [
        (score.rms_all_answers_deg, score, one)
        for one in task.pipelines
        if (score := _score(built, nominal, one, 0)) is not None
    ]
    if not tried:
        return {**row, "reason": "no pipeline of this mask answers often enough here"}
    _, chosen_by, (extractor, model) = min(tried, key=lambda found: found[0])
    on_units = range(1, task.units + 1)
    own, flight = (
        UnitErrors(
            tuple(
                None if score is None else store(score.rms_all_answers_deg)
                for score in (_score(built, name, (extractor, model), unit) for unit in on_units)
            )
        )
        for name in (nominal, FLIGHT)
    )
    return {
        **row,
        "extractor": extractor.about.name,
        "model": model.about.name,
        "own_error_deg": own.own_error_deg,
        "own_low_deg": own.low_deg,
        "own_high_deg": own.high_deg,
        "flight_error_deg": flight.own_error_deg,
        "flight_low_deg": flight.low_deg,
        "flight_high_deg": flight.high_deg,
        "bound_deg": store(chosen_by.bound_deg),
    }


_NUMBERS = (
    *("own_error_deg", "own_low_deg", "own_high_deg"),
    *("flight_error_deg", "flight_low_deg", "flight_high_deg", "bound_deg"),
)


def _score(
    built: Preset, condition: str, pipeline: tuple[type[Extractor], Scored], unit: int
) -> Score | None:
    """Return the score of a pipeline on a unit; None below 95 % availability."""
    extractor, model = pipeline
    task = Task(built, condition, extractor, (model,), unit, all_observable=True)
    (outcome,) = score_task(task).outcomes
    score = outcome.score
    return score if score is not None and is_available(score.row()) else None
