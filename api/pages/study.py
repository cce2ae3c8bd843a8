"""/studies and /studies/{key}: what the survey maps, and what of it runs here."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import Path, Query

from api.http.dependencies import Known
from api.http.models.studies import StudiesQuery
from api.http.models.words import StudyKey
from api.http.routers import studies as told
from api.pages.serving import PageRouter, View

router = PageRouter()

NAMES = {
    "task": "Task",
    "accuracy": "Class of accuracy",
    "error": "Error addressed",
    "detector": "Detector",
    "mask": "Mask",
    "model": "Calibration model",
    "extractor": "Feature extractor",
    "accuracy_deg": "Published accuracy",
    "accuracy_kind": "Kind of that accuracy",
    "precision_deg": "Published precision",
    "precision_kind": "Kind of that precision",
    "fov_deg": "Field of view",
}
BASES = {
    "survey-table": "a mapping table of the survey",
    "authors-table": "the survey authors' own table",
    "survey-text": "the survey's text",
    "abstract": "the study's abstract or record",
    "title": "the study's title",
    "inferred": "inferred from what else is known of the study",
    "recalled": "recalled, not seen on a page",
    "unknown": "not known",
}
STATES = {
    "complete": "runs here completely",
    "partial": "runs here in part",
    "none": "nothing of it runs here yet",
}
IDENTITIES = {
    "confirmed": "author, year and topic confirmed on a public page",
    "recalled": "bibliographic data recalled, not seen on a page",
    "ambiguous": "more than one publication fits the key",
    "unknown": "no publication identified for the key",
}
FILTERS = ("detector", "mask", "model", "extractor", "task")
EVERY = 500  # studies of one page; there are 129


@router.page("/studies")
async def studies(known: Known, query: Annotated[StudiesQuery, Query()]) -> View:
    """Every study that meets the filters, with what it maps to and how much of it runs."""
    every = query.model_copy(update={"limit": EVERY})
    answer = await told.studies(known, every)
    return View(
        "studies.html",
        answer,
        asked=query,
        filters={name: known.taxonomy.to_dict()[name] for name in FILTERS},
        names=NAMES,
        states=STATES,
        mapped=len(known.facts.studies),
    )


@router.page("/studies/{key}")
async def study(known: Known, key: Annotated[StudyKey, Path()]) -> View:
    """One study: attributes with their basis, what it runs, reported beside measured."""
    answer = await told.study(known, key)
    found = answer.document
    claims = [e.claim for e in known.measurements.claims.values() if key in e.claim.study]
    return View(
        "study.html",
        answer,
        names=NAMES,
        bases=BASES,
        states=STATES,
        identities=IDENTITIES,
        best=_best(found["pipelines"]),
        claims=claims,
        verdicts={e.claim.id: e.verdict for e in known.measurements.claims.values()},
        datasets=[c for c in known.measurements.cards if key in c["follows"]],
        algorithms=[i for i in known.catalogue.listing(None) if key in i.studies],
    )


def _best(pipelines: list[dict[str, Any]]) -> dict[str, Any] | None:
    """Return the score with the least error among all of a study's, with its pipeline."""
    scored = [
        {**pipeline, **score}
        for pipeline in pipelines
        for score in pipeline["scores"]
        if score["rms_deg"] is not None
    ]
    return min(scored, key=lambda score: score["rms_deg"], default=None)
