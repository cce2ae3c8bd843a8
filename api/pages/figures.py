"""/figures: the survey's figures, each with its table."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Annotated, Any

from fastapi import Path, Query, Request

from api.figures import wording
from api.figures.catalogue import MATRIX, FigureName, evidence_map
from api.figures.catalogue import figure as drawn
from api.figures.figure import Figure, Row
from api.figures.statements import number_of_studies, statements
from api.pages.editions import edition_shown
from api.pages.measured_figures import LISTED
from api.pages.numbers import degrees, kind_said, own_error, wide
from api.pages.serving import DRAWN, PageRouter, View
from api.schema.figures import FigureQuery, MatrixQuery
from api.schema.studies import StudyFilters
from api.service import figures as service
from api.service.knowledge import Knowledge
from api.web.dependencies import NO_PARAMETERS, Known
from registry.taxonomy import ATTRIBUTES, LEVELS
from survey_data.reported import QUANTITIES

NOT_KNOWN = "not known"


Cell = tuple[str, str, str]
"""Heading, text, and what stands below it."""


router = PageRouter()


@router.page("/figures")
async def figures(known: Known, _asked: Annotated[None, NO_PARAMETERS] = None) -> View:
    """List the figures."""
    answer = service.figures(known)
    return View(
        "figures.html",
        answer,
        matrix=MATRIX,
        measured=LISTED,
        counted=number_of_studies(),
        unmapped=known.editions[1].studies,
    )


@router.page(f"/figures/{MATRIX}", figures=True)
async def matrix(known: Known, query: Annotated[MatrixQuery, Query()], request: Request) -> View:
    """Studies by two attributes, gaps as visible as what is there."""
    found = _matrix(known, query, request)
    gaps: dict[str, list[dict[str, Any]]] = {}
    for row in found.rows:
        if row["state"] not in ("measured", "studied") or not row["count"]:
            pair = " × ".join(
                wording.display_name(row[f"{side}_level"], row[side]) for side in _SIDES
            )
            gaps.setdefault(row["state"], []).append({**row, "pair": pair})
    chosen = {"rows": query.rows, "columns": query.columns}
    return _view(known, found, query, request, chosen=chosen, gaps=gaps)


@router.page("/figures/{figure}", figures=True)
async def figure(
    known: Known,
    figure: Annotated[FigureName, Path()],
    query: Annotated[FigureQuery, Query()],
    request: Request,
) -> View:
    """One figure of the survey."""
    found = drawn(figure, known.of(query.edition).facts, query.by_attribute(), _page(request))
    return _view(known, found, query, request, chosen={}, gaps={})


def _matrix(known: Knowledge, query: MatrixQuery, request: Request) -> Figure:
    asked = (query.by_attribute(), query.rows, query.columns, _page(request))
    return evidence_map(known.of(query.edition).facts, *asked, evidence=known.evidence)


def _page(request: Request) -> str:
    """Return the address of the page of what is asked for."""
    path = request.scope["path"]
    for suffix in DRAWN:
        path = path.removesuffix(suffix)
    query = request.scope["query_string"].decode("latin-1")
    return f"{path}?{query}" if query else path


def _view(
    known: Knowledge,
    found: Figure,
    query: StudyFilters,
    request: Request,
    *,
    chosen: Mapping[str, str],
    gaps: Mapping[str, list[dict[str, Any]]],
) -> View:
    cells = _CELLS.get(found.name, _flow_cells)
    rows = [
        (at, cells(row), row.get("count"), row["studies"])
        for at, row in enumerate(found.rows)
        if row["studies"]
    ]
    whole = not query.by_attribute() and query.edition == "survey"
    return View(
        "figure.html",
        service.document_of(found),
        figures=(found,),
        figure=found,
        abbreviations=_abbreviations(known, found),
        rows=rows,
        asked=query,
        chosen=chosen,
        gaps={state: gaps[state] for state in _GAPS if state in gaps},
        gap_words=_GAPS,
        filters={name: known.taxonomy.to_dict()[name] for name in ATTRIBUTES},
        names=wording.LEVELS,
        levels=LEVELS,
        statements=statements(found.name) if whole else (),
        counted=number_of_studies(),
        mapped=len(known.of(query.edition).facts.studies),
        editions=edition_shown(known, query.edition, request),
    )


_SIDES = ("row", "column")
_GAPS = {
    "measured": "Measured here, without a study",
    "unknown": "Unknown: no study is known to have both",
    "unstudied": "Unstudied",
    "impossible": "Impossible",
}
"""State of a pair without a study -> heading of its list."""
_NAMED = (
    *(("level", "value"), ("next_level", "next_value")),
    *(("row_level", "row"), ("column_level", "column")),
)


def _abbreviations(known: Knowledge, found: Figure) -> list[tuple[str, str]]:
    """Return the values that a figure writes short, with their names, in alphabetical order."""
    met = {
        (row[level], row[value])
        for row in found.rows
        for level, value in _NAMED
        if row.get(level) and row.get(value)
    }
    met |= {
        (level, row[level])
        for row in found.rows
        for level in ("detector", "mask", "accuracy", "model")
        if row.get(level)
    }
    named = {
        wording.display_name(level, value): wording.value_name(known.taxonomy, level, value)
        for level, value in met
    }
    return sorted((short, name) for short, name in named.items() if short != name)


def _flow_cells(row: Row) -> list[Cell]:
    end: Cell = ("To", "–", "")
    if row["next_level"]:
        shown = wording.display_name(row["next_level"], row["next_value"])
        end = ("To", shown, wording.LEVELS[row["next_level"]])
    start = wording.display_name(row["level"], row["value"])
    return [("Value", start, wording.LEVELS[row["level"]]), end]


def _model_cells(row: Row) -> list[Cell]:
    level = row["level"]
    within = row["model_category"] if level != "model_category" else ""
    below = wording.LEVELS[level]
    shown = wording.display_name(level, row[level])
    return [
        ("Arc", shown, "" if row["name"] == shown else row["name"]),
        ("Ring", below, ""),
        ("Within", wording.display_name("model_category", within) if within else "–", ""),
    ]


def _publication_cells(row: Row) -> list[Cell]:
    value = row["value"] or "venue not known"
    stack = "kind not known" if row["stack"] == "unknown" else row["stack"]
    return [("Year or venue", value, ""), ("Part of the bar", stack, "")]


def _sensor_cells(row: Row) -> list[Cell]:
    named = [
        (
            wording.LEVELS[level],
            wording.display_name(level, row[level]) if row[level] else NOT_KNOWN,
            "",
        )
        for level in ("detector", "mask", "accuracy")
    ]
    return [
        ("Year", str(row["year"] or NOT_KNOWN), ""),
        *named,
        ("Field of view", wide(row["fov_deg"]), ""),
        *(_reported_cell(quantity, row) for quantity in QUANTITIES),
    ]


def _reported_cell(quantity: str, row: Row) -> Cell:
    number = row[f"{quantity}_deg"]
    kind = "" if number is None else kind_said(row[f"{quantity}_kind"])
    return (quantity.capitalize(), degrees(number), kind)


def _matrix_cells(row: Row) -> list[Cell]:
    pair = [
        (
            wording.LEVELS[row[f"{side}_level"]],
            wording.display_name(row[f"{side}_level"], row[side]),
            "",
        )
        for side in _SIDES
    ]
    measured = wording.plural(row["pipelines"], "pipeline")
    return [
        *pair,
        ("Measured here", measured if row["pipelines"] else "–", row["best_dataset"] or ""),
        ("Best own error", _own_error(row), ""),
    ]


def _own_error(row: Row) -> str:
    names = ("dataset", "extractor", "model", "own_error_deg")
    return own_error({name: row[f"best_{name}"] for name in names})


_CELLS: Mapping[str, Callable[[Row], list[Cell]]] = {
    "models": _model_cells,
    "publications": _publication_cells,
    "coordinates": _sensor_cells,
    MATRIX: _matrix_cells,
}
