"""What it costs to follow an answer: its first calibration beside the best one by brute force.

``python -m benchmark.experiments regret [SEED ...]``. Requirement sets are drawn: tasks,
exclusions, limits of error and field, hazards, availability. Of each, every stored pipeline is
looked at for the one that errs least of those that meet all, from the stored rows alone, without
what answers. By measurement the answer must name it first; in its usual order the answer must say
by how much its first calibration errs more. The exit code is 1 unless it always does.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from statistics import geometric_mean
from typing import Any

import numpy as np

from benchmark import datasets
from benchmark.assessment.task_costs import joint_cost
from benchmark.datasets.hazards import hazards
from benchmark.metrics.rings import EDGES_DEG, field_error
from benchmark.metrics.score import AVAILABLE
from benchmark.results.pipelines import pipelines, standard_benches
from benchmark.results.store import Store
from registry.catalogue import catalogue
from registry.draws import BENCHES
from registry.fitting import stages
from registry.measured_pipelines import MeasuredPipeline, Measurements
from registry.ranking import Sort
from registry.recommendation import Recommendation, recommend
from registry.requirements import CLASSES_DEG, CONFIDENCE, EXCLUDE, HAZARDS, NEEDS
from registry.studies import Facts, facts

Row = Mapping[str, Any]
Asked = Mapping[str, Any]
Place = tuple[str, str, str]

NUMBER = 100
SEED = 20
#: What may be asked: its share of the sets, and the most values of it.
_DRAWN = (
    *(("task", 0.5, 2), ("error", 0.15, 2), ("model", 0.1, 3), ("exclude_task", 0.1, 2)),
    *(("accuracy", 0.15, 2), ("exclude_detector", 0.3, 3), ("exclude_mask", 0.3, 3)),
    *(("exclude_model", 0.3, 5), ("exclude_extractor", 0.3, 5)),
)
#: Requirements that the studies of an architecture have to meet.
_OF_STUDIES = ("task", "error", "accuracy")
#: Relative difference of two numbers that are the same one.
SAME = 1e-12


@dataclass(frozen=True)
class DrawnRequirement:
    """An answer to drawn requirements, compared with the best stored pipeline that meets them.

    Attributes
    ----------
    requirements
        The requirements.
    best_deg
        Least error by brute force; infinite where no measured pipeline meets them.
    best_there_deg
        Least error likewise on the architecture that the usual answer names first.
    own_ratio
        Cost of that architecture by the tasks asked for (its error where none are), over the least
        cost of those that the survey advises or studies used; NaN where all of those are unknown.
    first_deg, stated_ratio
        By order of the answer: error of the first calibration (infinite where it is not measured
        or its availability is too low), and the ratio to the best that the answer states.
    """

    requirements: Asked
    best_deg: float
    best_there_deg: float
    own_ratio: float
    first_deg: Mapping[Sort, float]
    stated_ratio: Mapping[Sort, float | None]

    @property
    def is_consistent(self) -> bool:
        """Whether the best is first by measurement, and the usual answer states its regret."""
        if not math.isclose(self.first_deg["measured"], self.best_deg, rel_tol=SAME):
            return False
        stated = self.stated_ratio["advice"]
        if math.isinf(self.first_deg["advice"]):
            return stated is None
        ratio = self.first_deg["advice"] / self.best_deg
        return stated is not None and math.isclose(stated, ratio, rel_tol=SAME)


def drawn_requirements(number: int, seed: int, known: Facts) -> Iterator[Asked]:
    """Yield requirement sets: each kind of requirement is in some of them.

    Parameters
    ----------
    number, seed
        How many, and of which draw.
    known
        For the values there are.
    """
    rng = np.random.default_rng(seed)
    for _ in range(number):
        asked: dict[str, Any] = {
            name: _some(rng, known.taxonomy.values(name.removeprefix(EXCLUDE)), most)
            for name, share, most in _DRAWN
            if rng.random() < share
        }
        if rng.random() < 0.4:
            asked["max_error_deg"] = float(10.0 ** rng.uniform(-2.0, 1.0))
        if rng.random() < 0.4:
            asked["min_fov_deg"] = float(rng.uniform(20.0, 140.0))
        if rng.random() < 0.4:
            asked["survive"] = _some(rng, HAZARDS, 2)
        if rng.random() < 0.2:
            asked["min_availability"] = float(rng.uniform(0.9, 1.0))
        if rng.random() < 0.2:
            asked["bench_deg"] = float(rng.choice([0.0, 0.003, 0.1]))
        if rng.random() < 0.2:
            asked["confidence"] = float(rng.uniform(0.5, 0.99))
        if rng.random() < 0.2:
            asked["exclude_needs"] = _some(rng, NEEDS, 2)
        yield asked


def _some(rng: np.random.Generator, values: Iterable[str], most: int) -> list[str]:
    every = list(values)
    return sorted(rng.choice(every, rng.integers(1, most + 1), replace=False).tolist())


def pipelines_of(rows: Iterable[Row]) -> dict[Place, dict[tuple[str, int], Row]]:
    """Return stored rows by condition and unit, of every pipeline."""
    table: dict[Place, dict[tuple[str, int], Row]] = {}
    for row in rows:
        place = (row["dataset"], row["extractor"], row["model"])
        table.setdefault(place, {})[row["condition"], row["unit"]] = row
    return table


def errors(
    table: Mapping[Place, Mapping[tuple[str, int], Row]],
    drawn: Mapping[Place, MeasuredPipeline],
    asked: Asked,
    known: Facts,
) -> Iterator[tuple[tuple[str, str], float, Row]]:
    """Yield architecture, error and first row of every stored pipeline that meets requirements.

    Parameters
    ----------
    table
        Rows by condition and unit, by pipeline.
    drawn
        By pipeline, for how far units scatter and what the standard bench errs.
    asked
        Names and values of `registry.requirements.PARAMETERS`, without latency and properties.
    known
        Studies and advice: what is asked of studies, they or advice meet.
    """
    models = {name: stages(model) for name, model in catalogue().models.items()}
    places: dict[tuple[str, str], bool] = {}
    for place, by in table.items():
        dataset, _, model = place
        conditions = datasets.get(dataset).conditions
        by_condition = {condition: row for (condition, unit), row in by.items() if unit == 0}
        first = by_condition.get(conditions[0])
        if first is None or first["rms_deg"] is None:
            continue
        pair = (first["detector"], first["mask"])
        if pair not in places:
            places[pair] = _has_what_is_asked(pair, asked, known)
        has = {
            "detector": {pair[0]},
            "mask": {pair[1]},
            "extractor": {first["extractor_taxonomy"]},
            "model": set(models[model]),
        }
        if not places[pair] or any(_refuses(asked, n, v, known) for n, v in has.items()):
            continue
        tried = hazards(conditions)
        if any(hazard not in tried for hazard in asked.get("survive", ())):
            continue
        names = [conditions[0], *(n for h in asked.get("survive", ()) for n in tried[h])]
        if any(name not in by_condition for name in names):
            continue
        units = [row for (name, _), row in by.items() if name == conditions[0]]
        about = drawn[place]
        if not set(about.needs).isdisjoint(asked.get("exclude_needs", ())):
            continue
        error = _judge([by_condition[name] for name in names], units, about, asked)
        if error is not None:
            yield pair, error, first


def _has_what_is_asked(pair: tuple[str, str], asked: Asked, known: Facts) -> bool:
    """Say whether a study of an architecture, or advice, has the tasks and errors asked for."""
    there = [s for s in known.studies.values() if pair in s.architectures]
    wanted = {name: set(asked[name]) for name in _OF_STUDIES if name in asked}
    out = set(asked.get(EXCLUDE + "task", ()))
    if not wanted and not (out and there):
        return True
    for study in there:
        tasks = set(study.of("task"))
        left = (tasks - out) & wanted.get("task", tasks)
        if (left or (not tasks and "task" not in wanted)) and all(
            values & set(study.of(name)) for name, values in wanted.items()
        ):
            return True
    return bool(wanted) and all(
        any(a.means(pair) and a.requirement == name and a.value in values for a in known.advice)
        for name, values in wanted.items()
    )


def _refuses(asked: Asked, name: str, has: set[str], known: Facts) -> bool:
    def every(values: Iterable[str]) -> set[str]:
        return {kind for value in values for kind in known.taxonomy.kinds(name, value)}

    return bool(
        (name in asked and not has & every(asked[name]))
        or has & every(asked.get(EXCLUDE + name, ()))
    )


def _judge(
    rows: Sequence[Row], units: Sequence[Row], about: MeasuredPipeline, asked: Asked
) -> float | None:
    """Return the largest error over conditions, the first first; None if a limit is broken.

    Errors are those of the middle one of the units; a limit has to hold over units and benches.
    """
    field = asked.get("min_fov_deg")
    known = [row["charged_deg"] for row in units if row["charged_deg"]]
    share = geometric_mean(known) / rows[0]["charged_deg"] if known else 1.0
    found = [share * _over(row, field) for row in rows]
    if (field is not None and math.isinf(found[0])) or (
        asked.get("survive") and math.isinf(max(found))
    ):
        return None
    least = asked.get("min_availability")
    if least is not None and any(
        (row["availability"] if row["rms_deg"] is not None else 0.0) < least for row in rows
    ):
        return None
    largest = [asked["max_error_deg"]] if "max_error_deg" in asked else []
    classes = [CLASSES_DEG.get(name, math.inf) for name in asked.get("accuracy", ())]
    if classes and math.isfinite(max(classes)):
        largest.append(max(classes))
    error = max(found)
    if (largest or "bench_deg" in asked) and math.isfinite(error):
        bench = asked.get("bench_deg", about.bench_deg)
        draws = sorted(
            math.hypot(error * unit, bench * one) for unit in about.unit_ratios for one in BENCHES
        )
        kept = asked.get("confidence", CONFIDENCE) * len(draws)
        error = draws[min(math.ceil(kept - 1e-9), len(draws)) - 1]
    return None if largest and error > min(largest) else error


def _over(row: Row, field: float | None) -> float:
    """Return the error over the narrowest cone that holds a field, else over the whole one."""
    half = 180.0 if row["half_fov_deg"] is None else row["half_fov_deg"]
    if field is not None:
        if 2.0 * half < field:
            return math.inf
        for edge in (int(e) for e in EDGES_DEG[1:]):
            if 2.0 * min(edge, half) >= field and (error := field_error(row, edge)) is not None:
                outside = row["charged_deg"] ** 2 - row["rms_deg"] ** 2  # of false Suns
                return math.sqrt(error**2 + max(outside, 0.0))
            if edge >= half:
                break
    answered = row["availability"]
    if row["rms_deg"] is None or answered is None or answered < AVAILABLE:
        return math.inf
    return float(row["charged_deg"])


def regrets(store: Store, number: int = NUMBER, seed: int = SEED) -> Iterator[DrawnRequirement]:
    """Yield the answers to drawn requirements, beside the best by brute force.

    Parameters
    ----------
    store
        Of stored scores.
    number, seed
        Of requirement sets.
    """
    known = facts()
    table = pipelines_of(store.rows(unit=None))
    benches = standard_benches(store.pins())
    measured = Measurements(pipelines(store.rows(unit=None), bench_deg=benches))
    drawn = {(row.dataset, row.extractor, row.model): row for row in measured.rows}
    for asked in drawn_requirements(number, seed, known):
        by: dict[tuple[str, str], float] = {}
        own: dict[tuple[str, str], float] = {}
        for pair, error, row in errors(table, drawn, asked, known):
            if error < by.get(pair, math.inf):
                by[pair], own[pair] = error, joint_cost(asked.get("task", ()), pair, error, row)
        orders: tuple[Sort, ...] = ("measured", "advice")
        answers = {sort: recommend(asked, measured, sort=sort, facts=known) for sort in orders}
        named = answers["advice"].architectures
        first = (named[0].detector, named[0].mask) if named else None
        evident = [(a.detector, a.mask) for a in named if a.advice or a.studies]
        yield DrawnRequirement(
            asked,
            min(by.values(), default=math.inf),
            by.get(first, math.inf) if first else math.inf,
            _ratio(own.get(first, math.inf) if first else math.inf, map(own.get, evident)),
            {sort: _first(answer) for sort, answer in answers.items()},
            {sort: answer.regret and answer.regret["ratio"] for sort, answer in answers.items()},  # type: ignore[misc]
        )


def _ratio(first: float, evident: Iterable[float | None]) -> float:
    known = [cost for cost in evident if cost is not None and math.isfinite(cost)]
    return first / min(known) if known else math.nan


def _first(answer: Recommendation) -> float:
    """Return what the first calibration named errs; infinite if nothing is measured of it."""
    if not answer.architectures:
        return math.inf
    measured = answer.architectures[0].calibrations[0].measured
    error = None if measured is None else measured["error_deg"]
    return float(error) if isinstance(error, float) else math.inf
