"""/detectors, /masks, /architectures/{detector}/{mask}: what is built, and what it reaches."""

from __future__ import annotations

from functools import lru_cache
from typing import Annotated, Any

from fastapi import Path, Query, Request

from api.pages import boards
from api.pages.editions import edition_shown
from api.pages.measured_figures import gap_section
from api.pages.serving import PageRouter, View
from api.schema import words
from api.schema.base import OfEdition
from api.schema.requirements import RequirementsQuery
from api.service import recommendations as service
from api.service.documents import Document
from api.service.knowledge import Knowledge
from api.web.dependencies import Known
from benchmark.leaderboard.architectures import architectures
from registry.studies import Study
from survey_data.products import built_sensors

router = PageRouter()

OTHER = {"detector": "mask", "mask": "detector"}
COLUMNS = ("value", "name", "category", "studies", "datasets", "best_own_error_deg", "best_dataset")
ARCHITECTURE_COLUMNS = (
    *("detector", "mask", "studies", "datasets", "dataset", "extractor", "model", "own_error_deg"),
    *("bound_deg", "over_bound", "half_fov_deg"),
)
#: Calibrations of an architecture that its page lists.
SHOWN = 40


@lru_cache(4)
def best_built(known: Knowledge) -> list[dict[str, Any]]:
    """Return the best measured pipeline of every detector and mask that a data set has."""
    return architectures(known.measurements.leaderboard)


def _document(known: Knowledge, attribute: str, value: str) -> dict[str, Any]:
    """Return a detector or a mask with its studies, its partners and the best of each."""
    entry = next(e for e in known.taxonomy.to_dict()[attribute] if e["value"] == value)
    studies = [s for s in known.facts.studies.values() if value in s.of(attribute)]
    built = [row for row in best_built(known) if row[attribute] == value]
    cards = [c for c in known.measurements.cards if c[attribute] == value]
    measured = [row for row in built if row["own_error_deg"] is not None]
    best = min(measured, key=lambda row: row["own_error_deg"], default=None)
    return {
        **entry,
        "studies": [s.key for s in studies],
        "datasets": [c["name"] for c in cards],
        "best": best,
        "best_own_error_deg": best and best["own_error_deg"],
        "best_dataset": best and best["dataset"],
        "architectures": _pairs(studies, built, attribute, value),
    }


def _pairs(
    studies: list[Study], built: list[dict[str, Any]], attribute: str, value: str
) -> list[dict[str, Any]]:
    """Return every partner, of studies or of data sets, with both."""
    other = OTHER[attribute]
    partners: dict[str, dict[str, Any]] = {}
    for study in studies:
        for pair in study.architectures:
            both = dict(zip(("detector", "mask"), pair, strict=True))
            if both[attribute] == value:
                entry = partners.setdefault(both[other], {**both, "studies": [], "best": None})
                entry["studies"].append(study.key)
    for row in built:
        both = {name: row[name] for name in OTHER}
        entry = partners.setdefault(row[other], {**both, "studies": [], "best": None})
        entry["best"] = row
    return sorted(partners.values(), key=lambda e: -len(e["studies"]))


def _every(known: Knowledge, query: OfEdition, request: Request, attribute: str) -> View:
    shown, known = edition_shown(known, query.edition, request), known.of(query.edition)
    values = known.taxonomy.values(attribute)
    items = [_document(known, attribute, value) for value in values]
    answer = Document(
        {"attribute": attribute, "items": items},
        COLUMNS,
        lambda: [{name: row[name] for name in COLUMNS} for row in items],
    )
    return View("values.html", answer, editions=shown)


def _one(
    known: Knowledge, query: OfEdition, request: Request, *, attribute: str, value: str
) -> View:
    shown, known = edition_shown(known, query.edition, request), known.of(query.edition)
    document = {"attribute": attribute, **_document(known, attribute, value)}
    rows = [
        {
            **{name: pair[name] for name in ("detector", "mask", "studies")},
            **{name: (pair["best"] or {}).get(name) for name in ARCHITECTURE_COLUMNS[3:]},
        }
        for pair in document["architectures"]
    ]
    hardware = [one for one in built_sensors().values() if getattr(one, attribute) == value]
    return View(
        "value.html",
        Document(document, ARCHITECTURE_COLUMNS, lambda: rows),
        hardware=hardware,
        editions=shown,
        **gap_section(known, {attribute: [value], "edition": query.edition}),
    )


Edition = Annotated[OfEdition, Query()]


@router.page("/detectors")
async def detectors(known: Known, query: Edition, request: Request) -> View:
    """Every detector of the taxonomy."""
    return _every(known, query, request, "detector")


@router.page("/masks")
async def masks(known: Known, query: Edition, request: Request) -> View:
    """Every mask of the taxonomy."""
    return _every(known, query, request, "mask")


@router.page("/detectors/{detector}")
async def detector(
    known: Known, detector: Annotated[words.Detector, Path()], query: Edition, request: Request
) -> View:
    """One detector: studies, masks it stands behind, data sets, built sensors."""
    return _one(known, query, request, attribute="detector", value=detector)


@router.page("/masks/{mask}")
async def mask(
    known: Known, mask: Annotated[words.Mask, Path()], query: Edition, request: Request
) -> View:
    """One mask: studies, detectors behind it, data sets, built sensors."""
    return _one(known, query, request, attribute="mask", value=mask)


@router.page("/architectures/{detector}/{mask}", figures=True)
async def architecture(
    known: Known,
    detector: Annotated[words.Detector, Path()],
    mask: Annotated[words.Mask, Path()],
    query: Edition,
    request: Request,
) -> View:
    """One architecture: advice, studies, data sets, and every calibration of it."""
    given = {
        "detector": [detector],
        "mask": [mask],
        "calibrations": SHOWN,
        "include": ["calibrations"],
        "edition": query.edition,
    }
    asked = RequirementsQuery.model_validate(given)
    answer = service.recommendations(known, asked)
    found = answer.document["architectures"]
    every = known.of(query.edition).facts.studies.values()
    studies = [s.key for s in every if (detector, mask) in s.architectures]
    cards = [c for c in known.measurements.cards if (c["detector"], c["mask"]) == (detector, mask)]
    leaders = [
        dict(row, name=f"{row['extractor']} + {row['model']}, {row['dataset']}")
        for card in cards
        for row in boards.first_rows(known, card["name"])[:1]
    ]
    field = boards.field_chart(leaders, "name")
    return View(
        "architecture.html",
        answer,
        detector=detector,
        mask=mask,
        architecture=found[0] if found else None,
        studies=studies,
        editions=edition_shown(known, query.edition, request),
        cards=cards,
        figures=(field,),
        field=field,
        **gap_section(known, {name: given[name] for name in ("detector", "mask", "edition")}),
    )
