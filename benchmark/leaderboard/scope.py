"""What the published leaderboard holds: which pipelines are scored where, by one rule.

1. Under the first condition of a data set, every pipeline that fits it, on the standard unit.
2. Under each other condition, of those: every extractor with the model that ranks first behind
   it, or, where none gives an error (a method of blooming waits for light that blooms), with those
   of the leading pipelines, with all where it has none of them; the `LEADING` first pipelines;
   every pipeline that a mapped study used on such a sensor.
3. Under the first condition on other units: what errs at most `CLOSE` times as much as the first
   on the standard unit can lead the board, and the first `MOST` of these are scored on `UNITS`
   units; of the others that err at most `BEHIND` times as much the first `MOST` on
   `UNITS_BEHIND`. What is further behind is scored no further.
4. Of the `LEADING` first pipelines those that can lead or are not far behind on `UNITS` units
   again: calibrated on drawn benches (`ON_BENCH`), and under the conditions of what becomes of a
   sensor after its calibration (`SINCE`).
5. Under the first condition on `UNITS` units: where two families of methods meet to decide one of
   the survey's directions (`benchmark.directions.rules`), the `OF_FAMILY` first of each.

What another condition does to a pipeline far behind under the first one helps nobody choose;
`sunatlas benchmark` measures it for whoever asks.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from functools import cache
from itertools import groupby
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from benchmark.contract import FLIGHT, ON_BENCH, Cell
from benchmark.directions.rules import is_of, rules
from benchmark.metrics.ranking import order
from benchmark.metrics.score import is_available
from benchmark.plan.combinations import cells, scorable_plan, study_plans
from benchmark.plan.parts import Parts, installed_parts
from benchmark.plan.shown import data_sets
from registry.resolution import resolve_all
from registry.taxonomy import Plan

if TYPE_CHECKING:
    from benchmark.datasets.preset import Preset

Row = Mapping[str, Any]
#: Keys of studies by detector, mask, extractor and model of a pipeline that they used.
Studied = Mapping[tuple[str, str, str, str], tuple[str, ...]]

#: Times the first one's error on the standard unit up to which a pipeline can lead its board.
CLOSE = 1.5
#: Units that such pipelines are scored on, the standard one among them.
UNITS = 10
#: Times the first one's error up to which a pipeline is scored on `UNITS_BEHIND` units.
BEHIND = 4.0
UNITS_BEHIND = 5
#: Pipelines of a board that are scored on so many units each.
MOST = 20
#: Pipelines of a board that are scored under every condition, and on drawn benches.
LEADING = 5
#: Pipelines of a family that are scored on so many units.
OF_FAMILY = 2
#: Conditions of sensors that are no longer as they were calibrated: chance differs by unit.
SINCE = (FLIGHT, "hot", "cold", "aged")


def compare(parts: Parts) -> dict[str, str]:
    """Return the first condition of each data set: the one on which everything is scored."""
    return {name: preset.conditions[0] for name, preset in parts.presets.items()}


def first(parts: Parts) -> list[Cell]:
    """List what is scored before anything is known: point 1 of the rule, in order."""
    condition = compare(parts)
    return [cell for cell in cells(parts=parts) if cell.condition == condition[cell.dataset]]


def followers(
    scores: Mapping[Cell, Row],
    parts: Parts,
    studied: Collection[tuple[str, str, str, str]] | None = None,
) -> list[Cell]:
    """List what follows from the first scores: points 2 and 3 of the rule, in order.

    Pipelines without an error neither rank nor lead.
    `studied` are detector, mask, extractor and model of pipelines that studies used; those of the
    registry by default.
    """
    used = studied_pipelines(parts) if studied is None else frozenset(studied)
    found: list[Cell] = []
    known = [cell for cell in first(parts) if cell in scores]
    for dataset, group in groupby(known, key=lambda cell: cell.dataset):
        preset = parts.presets[dataset]
        board = list(group)
        ranked = sorted(
            (cell for cell in board if scores[cell]["rms_all_answers_deg"] is not None),
            key=lambda cell: order(scores[cell], cell),
        )
        leading = ranked[:LEADING]
        kept = {*leading, *_best_of_each(ranked)}
        kept |= set(_of_silent(board, ranked, {cell.model for cell in leading}))
        kept |= {
            cell
            for cell in board
            if (preset.detector, preset.mask, cell.extractor, cell.model) in used
        }
        found += [
            Cell(dataset, condition, cell.extractor, cell.model)
            for condition in preset.conditions[1:]
            for cell in kept
        ]
        units = dict(_units(ranked, scores))
        often = {**units, **dict.fromkeys(_of_families(ranked, scores, preset), UNITS)}
        found += [
            replace(cell, unit=unit) for cell, number in often.items() for unit in range(1, number)
        ]
        found += [
            replace(cell, condition=ON_BENCH, unit=unit)
            for cell in leading
            if cell in units
            for unit in range(UNITS)
        ]
        found += [
            replace(cell, condition=condition, unit=unit)
            for cell in leading
            if cell in units
            for condition in SINCE
            if condition in preset.conditions
            for unit in range(1, UNITS)
        ]
    return sorted(found)


def _units(ranked: list[Cell], scores: Mapping[Cell, Row]) -> Iterator[tuple[Cell, int]]:
    """Give of each pipeline that is not far behind the first the number of its units.

    What answers too seldom to be ranked is not held against the first: it stays on one unit.
    """
    if not ranked:
        return
    first = scores[ranked[0]]
    room = {UNITS: MOST, UNITS_BEHIND: MOST}
    for cell in ranked:
        if is_available(scores[cell]) == is_available(first):
            times = scores[cell]["rms_all_answers_deg"] / first["rms_all_answers_deg"]
            number = UNITS if times <= CLOSE and room[UNITS] else UNITS_BEHIND
            if times <= BEHIND and room[number]:
                room[number] -= 1
                yield cell, number


def _of_families(ranked: list[Cell], scores: Mapping[Cell, Row], preset: Preset) -> Iterator[Cell]:
    """Give the first of both families of every rule that this data set helps to decide."""
    able = [cell for cell in ranked if is_available(scores[cell])]
    for rule in rules().values():
        if rule.kind == "duel" and rule.is_on(preset):
            both = [
                [cell for cell in able if is_of(family, cell.extractor, cell.model)][:OF_FAMILY]
                for family in rule.families
            ]
            if all(both):
                yield from (cell for cells_of_one in both for cell in cells_of_one)


def published_scope(scores: Mapping[Cell, Row], parts: Parts) -> frozenset[Cell]:
    """Return everything that the published leaderboard holds, given the scores it has."""
    return frozenset((*first(parts), *followers(scores, parts)))


def _best_of_each(ranked: list[Cell]) -> Iterator[Cell]:
    """Give of each extractor the pipeline that ranks first."""
    seen = set()
    for cell in ranked:
        if cell.extractor not in seen:
            seen.add(cell.extractor)
            yield cell


def _of_silent(board: list[Cell], ranked: list[Cell], models: Collection[str]) -> Iterator[Cell]:
    """Give of each extractor without an error its pipelines with these models, or else all."""
    answering = {cell.extractor for cell in ranked}
    for extractor in sorted({cell.extractor for cell in board} - answering):
        of_it = [cell for cell in board if cell.extractor == extractor]
        yield from [cell for cell in of_it if cell.model in models] or of_it


def studied_pipelines(parts: Parts) -> frozenset[tuple[str, str, str, str]]:
    """Return detector, mask, extractor and model of every pipeline that a mapped study used.

    Pipelines in which something stands in for what the study states count as well: they are what
    is shown for it.
    """
    return frozenset(_studies_of(parts))


@cache
def studies_of_pipelines() -> Studied:
    """Return which mapped studies used each installed pipeline on its architecture, by their keys.

    As `studied_pipelines` of what is installed, and of a study with a sensor of its own what it
    runs there; the keys are sorted.
    """
    return MappingProxyType(_studies_of(installed_parts(), study_plans()))


def _studies_of(
    parts: Parts, own: Mapping[str, Plan] = MappingProxyType({})
) -> dict[tuple[str, str, str, str], tuple[str, ...]]:
    found: dict[tuple[str, str, str, str], set[str]] = {}
    shown = data_sets(parts=parts) if not own else data_sets()
    resolved = resolve_all(scorable_plan(parts=parts), own=own, data_sets=shown)
    for key, resolution in resolved.items():
        for pipeline in resolution.pipelines:
            used = (pipeline.detector, pipeline.mask, pipeline.extractor, pipeline.model)
            found.setdefault(used, set()).add(key)
    return {used: tuple(sorted(keys)) for used, keys in found.items()}
