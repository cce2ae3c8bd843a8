"""/v1/studies: the mapped studies, and what of each can be run."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Path, Query

from api import columns
from api.http.answers import Answer, AnswerRoute, listing
from api.http.dependencies import AS_ACCEPTED, Known, TableOnly
from api.http.knowledge import Knowledge
from api.http.models.base import Selected
from api.http.models.studies import Studies, StudiesQuery, StudyDetail
from api.http.models.words import StudyKey
from api.http.pagination import ordered, page
from registry.resolution import RunnablePipeline
from registry.studies import Study
from survey_data.reported import Quantity

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/studies", summary="The mapped studies", response_model=Studies | Selected)
async def studies(known: Known, query: Annotated[StudiesQuery, Query()]) -> Answer:
    """Studies of the survey's mapping: 129, where it states 128. Filters narrow the list."""
    found = [study for study in known.facts.studies.values() if _is_wanted(study, query, known)]
    rows = ordered([_row(study, known) for study in found], query.sort)
    shown = page(rows, "/v1/studies", query)
    return listing(
        shown,
        shown.items,
        columns.STUDIES,
        lambda: [{**item, **item["values"]} for item in shown.items],
        fields=query.fields,
    )


@router.get(
    "/studies/{key}",
    summary="One study",
    response_model=StudyDetail,
)
async def study(
    known: Known,
    key: Annotated[StudyKey, Path(description="Key of the study.", examples=["Chang2008"])],
    query: TableOnly = AS_ACCEPTED,  # noqa: ARG001 - the route has read it
) -> Answer:
    """Every value of the mapping with its basis, and what of the study is scored.

    That is the pipelines that run what the study did, or what stands nearest to it, each with the
    data sets that it is scored on; and the values that do not run as they are. As CSV: the values.
    """
    found = known.facts.study(key)
    resolution = known.resolutions[key]
    described = found.to_dict()
    document = {
        **_row(found, known),
        "note": described["note"],
        "attributes": described["attributes"],
        "reported_accuracy": _reported(found, "accuracy"),
        "reported_precision": _reported(found, "precision"),
        "pipelines": [
            {**pipeline.to_dict(), "scores": _scores(pipeline, known)}
            for pipeline in resolution.pipelines
        ],
        "gaps": [gap.to_dict() for gap in resolution.gaps],
    }
    return Answer(document, columns.STUDY, lambda: document["attributes"])


def _reported(study: Study, quantity: Quantity) -> dict[str, Any] | None:
    found = study.reported(quantity)
    return None if found is None else found.to_dict()


def _row(study: Study, known: Knowledge) -> dict[str, Any]:
    summary = study.summary()
    values = summary.pop("values")
    resolution = known.resolutions[study.key]
    best = resolution.best
    scored = [_scores(pipeline, known) for pipeline in resolution.pipelines]
    runs = {
        "pipelines": len(resolution.pipelines),
        "cells": sum(len(pipeline.datasets) for pipeline in resolution.pipelines),
        "scored": sum(score["status"] is not None for scores in scored for score in scores),
        "basis": {} if best is None else dict(best.basis),
        "assumed": {} if best is None else dict(best.assumed),
    }
    return {**summary, "state": resolution.state, "runs": runs, "values": values}


def _scores(pipeline: RunnablePipeline, known: Knowledge) -> list[dict[str, Any]]:
    """Return what is published of a pipeline, under the first condition of each data set."""
    found = []
    for dataset in pipeline.datasets:
        row = known.measurements.nominal.get((dataset, pipeline.extractor, pipeline.model), {})
        names = ("condition", "status", "rms_deg", "bound_deg", "availability")
        found.append({"dataset": dataset, **{name: row.get(name) for name in names}})
    return found


def _is_wanted(study: Study, query: StudiesQuery, known: Knowledge) -> bool:
    """Say whether a study is among those asked for."""
    return (
        _in_years(study, query.year_min, query.year_max)
        and _has_words(study, query.q)
        and (not query.state or known.resolutions[study.key].state in query.state)
        and _has_values(study, query.wanted(), known)
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
