"""/studies and /studies/{key}: attributes of the studies and their implementation here."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import Path, Query, Request
from pydantic import Field

from api.metadata import schema_org
from api.metadata.signposting import landing_of_study
from api.pages.editions import edition_shown
from api.pages.serving import PageRouter, View
from api.schema.parameters import GIVEN
from api.schema.studies import StudiesQuery
from api.schema.words import StudyKey
from api.service import studies as service
from api.service.knowledge import Knowledge
from api.service.studies import ladder
from api.web.dependencies import Known
from benchmark.leaderboard.board import NOMINAL
from benchmark.metrics.score import AVAILABLE
from registry.fidelity.grading import GRADES as IN_WORDS
from registry.fidelity.grading import TALLIED, tally_text
from registry.fidelity.purposes import PURPOSES

router = PageRouter()

NAMES = {
    "task": "Task",
    "accuracy": "Accuracy class",
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
    "full-text": "the study's own text",
    "abstract": "the study's abstract or record",
    "title": "the study's title",
    "inferred": "inferred from other facts about the study",
    "recalled": "recalled, not checked against a source",
    "unknown": "not known",
}
GRADES = {grade: f"{TALLIED[grade]}: {words}" for grade, words in IN_WORDS.items()}
IDENTITIES = {
    "confirmed": "author, year and topic confirmed on a public page",
    "recalled": "bibliographic data recalled, not checked against a source",
    "ambiguous": "more than one publication fits the key",
    "unknown": "no publication identified for the key",
}
FILTERS = ("detector", "mask", "model", "extractor", "task")
EVERY = 500  # studies of one page
FIRST = 15  # rows shown at first


STEPS = ("format", "fields", "limit", "cursor", "sort", "safe")


class StudiesPage(StudiesQuery):
    """Filters of the list, and whether all rows are shown."""

    rows: Annotated[Literal["first", "all"] | None, GIVEN] = Field(
        None, description="The first rows of the list, or all."
    )


@router.page("/studies")
async def studies(known: Known, query: Annotated[StudiesPage, Query()], request: Request) -> View:
    """List the studies that match the filters, with attributes and grade."""
    every = StudiesQuery.model_validate(
        {**query.model_dump(exclude={"rows"}, exclude_defaults=True), "limit": EVERY}
    )
    answer = service.studies(known, every)
    return View(
        "studies.html",
        answer,
        asked=query,
        shown=answer.document["items"][: EVERY if query.rows == "all" else FIRST],
        selection=query.model_dump(exclude_defaults=True, exclude={*STEPS, "rows"}),
        untitled=sum(not item["title"] for item in answer.document["items"]),
        filters={name: known.taxonomy.to_dict()[name] for name in FILTERS},
        names=NAMES,
        grades=GRADES,
        mapped=len(known.of(query.edition).facts.studies),
        editions=edition_shown(known, query.edition, request),
        tallied=tally_text(study["grade"] for study in answer.document["items"]),
    )


@router.page("/studies/{key}")
async def study(known: Known, key: Annotated[StudyKey, Path()]) -> View:
    """Show a study: attributes with basis, implementation, reported and measured accuracy."""
    answer = service.study(known, key)
    claims = [e.claim for e in known.measurements.claims.values() if key in e.claim.study]
    landing = landing_of_study(key, answer.document["doi"])
    return View(
        "study.html",
        answer,
        landing=landing,
        entity=schema_org.study(answer.document, landing),
        available=AVAILABLE,
        nominal=NOMINAL,
        names=NAMES,
        bases=BASES,
        grades=GRADES,
        purposes=PURPOSES,
        identities=IDENTITIES,
        last_mapped=known.editions[0].last_year,
        edition=next(one for one in known.editions if one.name == answer.document["edition"]),
        claims=claims,
        standard=_standard(known, key) if answer.document["own_sensor"] else None,
        verdicts={e.claim.id: e.verdict for e in known.measurements.claims.values()},
        datasets=[c for c in known.measurements.cards if key in c["follows"]],
        algorithms=[i for i in known.catalogue.implementations(None) if key in i.studies],
    )


def _standard(known: Knowledge, key: str) -> dict[str, Any] | None:
    """Return the rungs of a study's method on the standard sensor of its kind; None for none."""
    resolution = known.standard_resolutions.get(key)
    own = service.headline(resolution, known) if resolution else None
    return ladder(own, known.measurements)
