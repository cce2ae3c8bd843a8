"""The studies and their implementation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from benchmark.metrics.score import is_available

if TYPE_CHECKING:
    from api.service.measurements import Measurements

import math
from collections.abc import Sequence
from dataclasses import replace

from api.schema.studies import AttributeValue, Edition, StudiesQuery, StudyRow
from api.schema.table import columns_of
from api.schema.words import StudyKey
from api.service.documents import Document, listing
from api.service.knowledge import Knowledge
from benchmark.leaderboard.headlines import read_differences
from registry.fidelity.evidence import SCORE_FACTOR, own_error, reason_for_score
from registry.fidelity.runnable import RunnablePipeline
from registry.resolution import Resolution
from registry.studies import Study
from survey_data.reported import Quantity


def studies(known: Knowledge, query: StudiesQuery) -> Document:
    """List the studies of the survey: 129 keys in its tables, 128 in its text.

    `edition=all` includes added studies. BibTeX, RIS and CSL JSON: references to studies with a
    known title.
    """
    known = known.of(query.edition)
    chosen = [study for study in known.facts.studies.values() if _is_wanted(study, query, known)]
    rows = [_row(study, known) for study in chosen]
    found = listing(rows, "/v1/studies", query, StudyRow, lambda items: [*map(_flat, items)])
    return found if query.fields else replace(found, cited=found.document["items"])


def editions(known: Knowledge) -> Document:
    """List the editions of the studies, for citation.

    A version consists of the data package's version, the number of studies and a digest of their
    tables.
    """
    items = [one.to_dict() for one in known.editions]
    return Document({"items": items}, columns_of(Edition), lambda: items)


def study(known: Knowledge, key: StudyKey) -> Document:
    """Return a study: values with basis, implementation and scores.

    Pipelines implement the study's method or the nearest one; values that are not implemented are
    listed as gaps. CSV: the values. BibTeX, RIS, CSL JSON: the reference.
    """
    known = known.of("all")
    found = known.facts.study(key)
    resolution = known.resolutions[key]
    described = found.to_dict()
    document = {
        **_row(found, known),
        "note": described["note"],
        "attributes": described["attributes"],
        "departures": [departure.to_dict() for departure in resolution.fidelity.departures],
        "purposes": dict(resolution.fidelity.purposes),
        "reported_accuracy": _report(found, "accuracy"),
        "reported_precision": _report(found, "precision"),
        "own_sensor": _own_sensor(resolution, known),
        "ladder": ladder(headline(resolution, known), known.measurements),
        "pipelines": [
            {**pipeline.to_dict(), "scores": _scores(pipeline, known)}
            for pipeline in resolution.pipelines
        ],
        "gaps": [gap.to_dict() for gap in resolution.gaps],
    }
    return Document(
        document,
        columns_of(AttributeValue),
        lambda: document["attributes"],
        cited=[document],
        saved_as=key,
    )


def _report(study: Study, quantity: Quantity) -> dict[str, Any] | None:
    found = study.report(quantity)
    return None if found is None else found.to_dict()


def _own_sensor(resolution: Resolution, known: Knowledge) -> str:
    """Describe the data set that is made after a study alone; empty if it runs on standard ones."""
    best = resolution.best_pipeline
    if best is None or best.settings[0].dataset in known.measurements.presets:
        return ""
    return known.measurements.preset(best.settings[0].dataset).description


def _row(study: Study, known: Knowledge) -> dict[str, Any]:
    summary = study.summary()
    values = summary.pop("values")
    resolution = known.resolutions[study.key]
    best = resolution.best_pipeline
    graded = resolution.fidelity
    scored = [_scores(pipeline, known) for pipeline in resolution.pipelines]
    runs = {
        "pipelines": len(resolution.pipelines),
        "cells": sum(map(len, scored)),
        "scored": sum(score["status"] is not None for scores in scored for score in scores),
        "basis": {} if best is None else dict(best.basis),
        "assumed": {} if best is None else dict(best.assumed),
    }
    return {
        **summary,
        "grade": graded.grade,
        "sentence": graded.sentence,
        "state": resolution.state,
        "runs": runs,
        "headline": headline(resolution, known),
        "values": values,
    }


_NUMBERS = ("status", "own_error_deg", "rms_deg", "bound_deg", "over_bound", "availability")


def _flat(item: Mapping[str, Any]) -> dict[str, Any]:
    """Return a study as a row of the table: values by attribute, confirmations in words."""
    said = [f"{one['name']}, {one['date']}: {one['confirms']}" for one in item["verified"]]
    return {**item, **item["values"], "verified": said}


def _scores(pipeline: RunnablePipeline, known: Knowledge) -> list[dict[str, Any]]:
    """Return a pipeline's published scores in each setting used for the study."""
    found = []
    for one in pipeline.settings:
        at = one.dataset, one.condition, pipeline.extractor, pipeline.model
        row = known.measurements.score_of.get(at, {})
        found.append({**one.to_dict(), **{name: row.get(name) for name in _NUMBERS}})
    return found


def headline(resolution: Resolution, known: Knowledge) -> dict[str, Any] | None:
    """Return the score that a study is shown by, or None where it is not measured.

    Of the pipelines that rest on most, each in the setting that tells most of the study, the one of
    the least own error.
    """
    found = []
    for pipeline in resolution.strongest_pipelines:
        score = _scores(pipeline, known)[0]
        if score["own_error_deg"] is not None:
            members = {name: score[name] for name in ("dataset", "condition", *_NUMBERS[1:])}
            found.append({"extractor": pipeline.extractor, "model": pipeline.model, **members})
    return min(found, key=lambda score: score["own_error_deg"], default=None)


def _is_wanted(study: Study, query: StudiesQuery, known: Knowledge) -> bool:
    """Say whether a study is among those asked for."""
    return (
        (not query.key or study.key in query.key)
        and _in_years(study, query.year_min, query.year_max)
        and _has_words(study, query.q)
        and (not query.grade or known.resolutions[study.key].fidelity.grade in query.grade)
        and (not query.state or known.resolutions[study.key].state in query.state)
        and _has_values(study, query.by_attribute(), known)
    )


def _has_values(study: Study, wanted: dict[str, list[str]], known: Knowledge) -> bool:
    """Say whether a study has, of every attribute, one of the wanted values or of their kinds."""
    kinds = known.taxonomy.kinds
    return all(
        not set(study.of(attribute)).isdisjoint(
            kind for value in values for kind in kinds(attribute, value)
        )
        for attribute, values in wanted.items()
    )


def _in_years(study: Study, first: int | None, last: int | None) -> bool:
    if first is None and last is None:
        return True
    if study.year is None:
        return False
    return (first is None or first <= study.year) and (last is None or study.year <= last)


def _has_words(study: Study, words: str | None) -> bool:
    if words is None:
        return True
    text = f"{study.key} {study.title} {study.authors} {study.venue}".casefold()
    return all(word in text for word in words.casefold().split())


COMPARED = ("key", "grade", "reported_deg", "kind", "rms_deg", "own_error_deg", "times", "reason")
"""Study, grade, figure as printed and of which kind, as RMS, own error here, their ratio, and why
they may be far from each other."""


def compare_accuracy(known: Knowledge) -> list[dict[str, Any]]:
    """Return a row for every study that reports an accuracy and has a score, the worst first.

    The own error is that which the study is graded by. The worst is furthest from a ratio of one.
    A reason that is no fact of the study says how the two differ, and is none for its grade.
    """
    differences = read_differences()
    rows = []
    for key, resolution in known.resolutions.items():
        study = known.facts.study(key)
        reported = study.report("accuracy")
        own = own_error(resolution.strongest_pipelines, known.measurements.own_errors)
        if reported is None or own is None:
            continue
        rows.append(
            {
                "key": key,
                "grade": resolution.fidelity.grade,
                "reported_deg": reported.value_deg,
                "kind": reported.label,
                "rms_deg": reported.rms_deg,
                "own_error_deg": own,
                "times": own / reported.rms_deg,
                "reason": reason_for_score(study, known.facts)
                or differences.get((key, "accuracy"), ""),
            }
        )
    return sorted(rows, key=lambda row: (-abs(math.log(row["times"])), row["key"]))


def say_comparison(rows: Sequence[Mapping[str, Any]]) -> str:
    """Say how published and measured accuracy agree: rank correlation, and how many are near."""
    if len(rows) < 3:
        return f"{len(rows)} studies report an accuracy and have a score."
    from scipy.stats import spearmanr  # noqa: PLC0415 - half a second

    found = spearmanr([row["rms_deg"] for row in rows], [row["own_error_deg"] for row in rows])
    near = sum(1.0 / SCORE_FACTOR <= row["times"] <= SCORE_FACTOR for row in rows)
    times = [row["times"] for row in rows]
    return (
        f"{len(rows)} studies report an accuracy and have a score. Spearman's rank correlation of "
        f"reported and own error is {found.statistic:.2f} (p = {found.pvalue:.1g}); {near} are "
        f"within a factor of {SCORE_FACTOR:g}, the ratios range from {min(times):.2g} to "
        f"{max(times):.2g}. Both are RMS, over all units measured; docs/limits.md compares figures "
        "of each study's own kind, precisions too, on unit 0."
    )


_RUNG = ("extractor", "model", "own_error_deg", "availability")


def ladder(own: Mapping[str, Any] | None, measurements: Measurements) -> dict[str, Any] | None:
    """Return the rungs below a study's reported figure, on one data set and condition.

    Parameters
    ----------
    own : score of the study's own method, with `dataset` and `condition`; None for none
    measurements : published scores

    Returns
    -------
    dict or None
        ``dataset``, ``condition``, ``nominal`` (whether that is the data set's first condition,
        under which own errors are over all units), ``own`` and ``best`` (names, own error and
        availability), ``bound_deg`` with the unit known and ``bound_unit_deg`` with the unit known
        by its darks and flats. None where the study's method has no error.
    """
    if own is None:
        return None
    dataset, condition = own["dataset"], own["condition"]
    scored = (
        row
        for (name, at, *_), row in measurements.score_of.items()
        if (name, at) == (dataset, condition) and row["own_error_deg"] is not None
    )
    best = min(
        scored,
        key=lambda row: (
            not is_available(row),
            row["own_error_deg"],
            row["extractor"],
            row["model"],
        ),
    )
    pin = measurements.pins.get((dataset, condition, "test"))
    return {
        "dataset": dataset,
        "condition": condition,
        "nominal": condition == measurements.preset(dataset).conditions[0],
        "own": {name: own[name] for name in _RUNG},
        "best": {name: best[name] for name in _RUNG},
        "bound_deg": measurements.bounds(dataset).get(condition),
        "bound_unit_deg": pin and pin.bound_unit_deg,
    }
