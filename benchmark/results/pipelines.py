"""Stored scores as recommendations take them: by pipeline, under every condition and unit."""

from __future__ import annotations

import dataclasses
import math
import statistics
from collections.abc import Iterable, Mapping
from typing import Any

from benchmark import datasets
from benchmark.contract import FLIGHT
from benchmark.datasets.hazards import hazards
from benchmark.datasets.pins import Pin
from benchmark.metrics.ranking import UnitErrors, luck_of_standard
from benchmark.metrics.rings import EDGES_DEG, field_error
from benchmark.metrics.score import is_available
from benchmark.metrics.separation import store
from registry.catalogue import catalogue
from registry.draws import FEWEST_UNITS, unit_ratios
from registry.fitting import stages
from registry.measured_pipelines import MeasuredPipeline, Score
from registry.requirements import NEEDS

_PLAIN = tuple(
    f.name for f in dataclasses.fields(Score) if f.name not in {"rms_deg", "is_available", "cones"}
)
#: Half field of view of a sensor that is made for all directions.
ALL_DIRECTIONS_DEG = 180.0

Row = Mapping[str, Any]
Place = tuple[str, str, str]


def pipelines(
    rows: Iterable[Row],
    latency_us: Mapping[Place, float | None] | None = None,
    bench_deg: Mapping[str, float | None] | None = None,
) -> list[MeasuredPipeline]:
    """Return what is measured of every pipeline on every standard data set.

    Errors are own errors over all answers: geometric means over units, or, of a condition that was
    measured on the standard one alone, its error times what that mean is of the standard unit's
    under the first. In flight are the errors under the condition of that name, and of data sets in
    orbit those of the first.

    Rows of data sets, conditions and models that there are no longer are passed over. `latency_us`
    is of a call with one sample on this machine, by data set, extractor and model; `bench_deg` the
    fixed error of the standard calibration bench by data set, 0 by default.
    """
    by: dict[Place, dict[tuple[str, int], Row]] = {}
    for row in rows:
        place = (row["dataset"], row["extractor"], row["model"])
        by.setdefault(place, {})[row["condition"], row["unit"]] = row
    known = {name: stages(scored) for name, scored in catalogue().models.items()}
    conditions = {name: datasets.get(name).conditions for name in datasets.names()}
    needs = {name: _needs(scored.about.context) for name, scored in catalogue().models.items()}
    aloft = {name for name in conditions if datasets.get(name).context_columns}
    spread = _spreads(by, {name: of_it[0] for name, of_it in conditions.items()})
    of_flight, luck = _spreads(by, dict.fromkeys(conditions, FLIGHT)), _luck(by)
    found = []
    for place, scores in by.items():
        dataset, extractor, model = place
        if model not in known or dataset not in conditions:
            continue
        first = scores.get((conditions[dataset][0], 0))
        if first is None:
            continue
        own = _over_units(scores, first["condition"])
        flight = own
        if dataset not in aloft:
            flight = _over_units(scores, FLIGHT, luck.get(dataset, 1.0))
        if own is None:
            continue
        units, nominal = own
        share = _share(units, first)
        found.append(
            MeasuredPipeline(
                dataset=dataset,
                detector=first["detector"],
                mask=first["mask"],
                extractor=extractor,
                extractor_taxonomy=first["extractor_taxonomy"],
                model=model,
                stages=known[model],
                nominal=nominal,
                hazards={
                    hazard: tuple(_under(scores, name, share) for name in names)
                    for hazard, names in hazards(conditions[dataset]).items()
                    if all((name, 0) in scores for name in names)
                },
                half_fov_deg=half_field_deg(first),
                latency_us=(latency_us or {}).get(place),
                unit_own_error_deg=units,
                unit_ratios=unit_ratios(units, spread.get(dataset, 0.0)),
                bench_deg=(bench_deg or {}).get(dataset) or 0.0,
                needs=needs[model],
                height_mm=datasets.get(dataset).geometry.focal_length_mm,
                flight=flight[1] if flight else None,
                flight_units_deg=flight[0] if flight else (),
                flight_ratios=unit_ratios(
                    flight[0] if flight else (),
                    of_flight.get(dataset, spread.get(dataset, 0.0)),
                ),
            )
        )
    return found


def standard_benches(pins: Mapping[tuple[str, str, str], Pin]) -> dict[str, float | None]:
    """Return the fixed error of the standard calibration bench by data set, from pinned splits."""
    first = {name: datasets.get(name).conditions[0] for name in datasets.names()}
    return {
        name: pin.bench_deg
        for (name, condition, split), pin in pins.items()
        if split == "test" and condition == first.get(name)
    }


def _unit_errors(scores: Mapping[tuple[str, int], Row], condition: str) -> tuple[float, ...]:
    """Return the errors of all units under a condition, the standard one first."""
    return tuple(
        row["rms_all_answers_deg"]
        for (name, _), row in sorted(scores.items())
        if name == condition and row["rms_all_answers_deg"]
    )


def _over_units(
    scores: Mapping[tuple[str, int], Row], condition: str, luck: float = 1.0
) -> tuple[tuple[float, ...], Score] | None:
    """Return the errors of all units under a condition, and the score with their geometric mean.

    Of the standard unit are what is no error, and the errors over cones, in proportion. Where it is
    the only unit its error is taken times `luck`. None where it was not measured.
    """
    standard = scores.get((condition, 0))
    if standard is None:
        return None
    units = _unit_errors(scores, condition)
    if len(units) == 1:
        found = _score(standard, luck)
        return units, dataclasses.replace(found, rms_deg=store(luck * units[0]))
    mean_deg = UnitErrors(units).own_error_deg
    return units, dataclasses.replace(_score(standard, _share(units, standard)), rms_deg=mean_deg)


def _share(units: tuple[float, ...], standard: Row) -> float:
    """Return the geometric mean over units over the error of the standard one; 1 for one unit."""
    error: float | None = standard["rms_all_answers_deg"]
    if len(units) < 2 or not error:
        return 1.0
    return math.exp(math.fsum(map(math.log, units)) / len(units)) / error


def _under(scores: Mapping[tuple[str, int], Row], condition: str, share: float) -> Score:
    """Return the score under a condition, over its units where several were measured.

    Of one unit the error is taken times the `share` that the units have of it under the first.
    """
    found = _over_units(scores, condition)
    if found is not None and len(found[0]) > 1:
        return found[1]
    return _score(scores[condition, 0], share)


def _luck(by: Mapping[Place, Mapping[tuple[str, int], Row]]) -> dict[str, float]:
    """Return by data set what takes the luck of the standard unit away where it alone was flown."""
    found: dict[str, list[UnitErrors]] = {}
    for (dataset, _, _), scores in by.items():
        found.setdefault(dataset, []).append(UnitErrors(_unit_errors(scores, FLIGHT)))
    return {dataset: luck_of_standard(errors) for dataset, errors in found.items()}


def _spreads(
    by: Mapping[Place, Mapping[tuple[str, int], Row]], conditions: Mapping[str, str]
) -> dict[str, float]:
    """Return by data set how far log errors of units scatter: the median over its pipelines.

    Under one of its conditions each.
    """
    found: dict[str, list[float]] = {}
    for (dataset, _, _), scores in by.items():
        units = _unit_errors(scores, conditions.get(dataset, ""))
        if len(units) >= FEWEST_UNITS:
            found.setdefault(dataset, []).append(statistics.stdev(map(math.log, units)))
    return {dataset: statistics.median(spreads) for dataset, spreads in found.items()}


def _needs(context: Iterable[str]) -> tuple[str, ...]:
    read = set(context)
    return tuple(name for name, columns in NEEDS.items() if not read.isdisjoint(columns))


def half_field_deg(row: Row) -> float:
    """Return half the field of view of a row's sensor; of one without, that of all directions."""
    half: float | None = row["half_fov_deg"]
    return ALL_DIRECTIONS_DEG if half is None else half


def _score(row: Row, share: float) -> Score:
    """Return a score, errors times a share; without an error where the run was refused.

    What false Suns add to the mean square over the whole field, they add to that over any cone: the
    sensor answers them whatever part of its field is used.
    """
    half = half_field_deg(row)
    error = row["rms_all_answers_deg"]
    false_suns = 0.0 if error is None else max(error**2 - row["rms_deg"] ** 2, 0.0)
    cones: list[tuple[float, float | None]] = []
    # The last ring may reach beyond the field; all its samples lie within.
    for edge in EDGES_DEG[1:]:
        inside = field_error(row, edge)
        charged = None if inside is None else share * math.sqrt(inside**2 + false_suns)
        cones.append((min(float(edge), half), charged))
        if edge >= half:
            break
    plain: dict[str, Any] = {name: row[name] for name in _PLAIN}
    own = None if error is None else share * error
    return Score(**plain, rms_deg=own, is_available=is_available(row), cones=tuple(cones))
