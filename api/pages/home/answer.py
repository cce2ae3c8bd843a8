"""/: a question as a sentence with blanks, and architectures that answer it."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any
from urllib.parse import urlencode

from fastapi import Query, Request
from markupsafe import Markup
from pydantic import ValidationError

from api.addresses import architecture_page
from api.figures.architectures import Point, architectures_figure
from api.figures.catalogue import figure as figure_of
from api.figures.figure import Figure
from api.figures.flow_figures import CHAINS, answer_figure
from api.figures.sunburst import NAME as MODELS
from api.figures.wording import LEVELS, display_name
from api.metadata import schema_org
from api.metadata.identity import identity
from api.metadata.signposting import landing_of_atlas
from api.pages.editions import edition_shown
from api.pages.home.question import clauses, form
from api.pages.measured_figures import gap_section
from api.pages.numbers import degrees, own_error
from api.pages.serving import PageRouter, View
from api.schema.recommendations import Architecture, Measured, RecommendationRow, Recommendations
from api.schema.requirements import RequirementsQuery
from api.schema.table import columns_of
from api.service import recommendations as service
from api.service.documents import Document
from api.service.knowledge import Knowledge
from api.service.pagination import page
from api.service.problems import Problem
from api.service.refusals import refusal
from api.web.dependencies import Known
from registry.answer import Answer
from registry.flows import Counting
from registry.requirements import LIMITS, SETTINGS
from registry.taxonomy import ATTRIBUTES

router = PageRouter()

#: Names that the service takes and the page settles itself.
PAGED = ("limit", "calibrations", "include", "format", "fields", "safe")
SINGLE = {*LIMITS, *SETTINGS, "mission", "sort", "edition", "cursor"}
#: What the figure of the gap can be asked, too.
GAP = {"detector", "mask", "task", "error", "level", "edition"}
#: What errors are drawn against, and whether more of it is better.
ACROSS = {"field": ("full field of view, °", True), "poses": ("calibration poses needed", False)}
SHOWN = {
    "across": {"field": "Field of view", "poses": "Calibration poses"},
    "flow": {
        "answer": "Cross-analysis",
        **{name: CHAINS[name].title for name in ("error", "performance", "task")},
        MODELS: "Models (sunburst)",
    },
    "detail": {"grouped": "Families", "all": "All values"},
    "counting": {"studies": "Studies", "fractional": "Fractional"},
}
"""What the page shows besides the answer: parameter -> values in words, the usual one first."""


@router.page("/", twin="/answer", figures=True)
async def answer(known: Known, request: Request) -> View:
    """Render the answer to the requirements in the address, readable without JavaScript."""
    fields = request.query_params.multi_items()
    given = dict(fields)
    shown_as = {
        name: given[name] if given.get(name) in words else next(iter(words))
        for name, words in SHOWN.items()
    }
    asked = None
    try:
        asked = _ask(fields)
        found = service.ask(asked, known.measured_pipelines, known.of(asked.edition).facts)
        shown = page(found.architectures, service.PATH, asked)
    except Problem as problem:
        if request.scope["path"] != "/":
            raise
        parts: dict[str, Any] = {"asked": asked, "shown": shown_as, "document": None}
        parts["form"] = form(known, fields, {})
        view = View("home/answer.html", Document({}), problem=problem.document("/"), **parts)
        view.status_code = problem.status_code
        return view
    document = service.document(found, asked, shown.items, shown.next)
    flow = _flow(known, asked, found, shown_as, request)
    scatter, left_out = _scatter(known, found, shown_as["across"])
    kept = {name: one for name, one in shown_as.items() if one != next(iter(SHOWN[name]))}
    return View(
        "home/answer.html",
        _as_table(document, found),
        document=document,
        landing=landing_of_atlas(identity()),
        entity=schema_org.atlas(identity(), known.measurements.presets),
        problem=None,
        asked=asked,
        editions=edition_shown(known, asked.edition, request),
        clauses=dict(clauses(document.requirements)),
        figures=(flow, scatter),
        scatter=scatter,
        left_out=left_out,
        flow=flow,
        shown=shown_as,
        choices=SHOWN,
        names=LEVELS,
        worded=display_name,
        **gap_section(known, asked.model_dump(include=GAP, exclude_defaults=True)),
        own=lambda measured: _own(known, measured),
        applied=lambda change: "/?" + urlencode(_applied(document, asked, change), doseq=True),
        going_on=lambda **more: "/?" + urlencode({**_stated(asked), **kept, **more}, doseq=True),
        command=_command(asked),
        form=form(known.of(asked.edition), fields, document.requirements),
    )


def _ask(fields: Sequence[tuple[str, str]]) -> RequirementsQuery:
    """Return the requirements among the fields of a query; Problem where they are none."""
    given: dict[str, Any] = {"include": ["calibrations"]}
    for name, value in fields:
        if name in SHOWN:
            continue
        if name in PAGED:
            raise Problem(400, "unknown-parameter", f"{name} cannot be asked for here")
        if name in SINGLE:
            given[name] = f"0{value}" if value.startswith(".") else value  # as a browser sends it
        else:
            given.setdefault(name, []).append(value)
    try:
        return RequirementsQuery.model_validate(given)
    except ValidationError as error:
        errors = [{**found, "loc": ("query", *found["loc"])} for found in error.errors()]
        raise refusal(errors, _declared) from error


def _declared(query: Annotated[RequirementsQuery, Query()]) -> RequirementsQuery:
    """Declare the parameters that a refusal names."""
    return query


def _as_table(document: Recommendations, found: Answer) -> Document:
    return Document(
        document.model_dump(),
        columns_of(RecommendationRow),
        lambda: [row.model_dump() for row in service.rows(found)],
    )


def _stated(asked: RequirementsQuery) -> dict[str, Any]:
    """Return what the address states, without what leads to another page of the answer."""
    return asked.model_dump(exclude_defaults=True, exclude={"include", "cursor"})


def _applied(document: Recommendations, asked: RequirementsQuery, change: Any) -> dict[str, Any]:
    """Return the question after a change; a mission is taken apart, as it would say the same."""
    kept = {name: value for name, value in document.requirements.items() if name not in change.drop}
    kept |= change.change
    kept.pop("mission", None)
    return kept | asked.model_dump(exclude_defaults=True, include={"sort", "edition"})


def _command(asked: RequirementsQuery) -> str:
    """Return the command that answers the same question."""
    words = ["sunatlas", "recommend"]
    for name, value in _stated(asked).items():
        for one in value if isinstance(value, list) else [value]:
            words += [f"--{name.replace('_', '-')}", str(one)]
    return shlex.join(words)


def _own(known: Knowledge, measured: Measured) -> Markup:
    """Return an own error; what is the record's, nominal and over the whole field, is marked."""
    row = known.measurements.nominal.get((measured.dataset, measured.extractor, measured.model))
    is_nominal = row is not None and measured.condition == row["condition"]
    if row is not None and is_nominal and measured.own_error_deg == row["own_error_deg"]:
        return own_error(row)
    return Markup("<span>{}</span>").format(degrees(measured.own_error_deg))


def _flow(
    known: Knowledge,
    asked: RequirementsQuery,
    found: Answer,
    shown_as: Mapping[str, str],
    request: Request,
) -> Figure:
    """Return the flow that is shown: of the answer, or a figure of the survey with its filters."""
    facts = known.of(asked.edition).facts
    page_address = f"/?{request.scope['query_string'].decode('latin-1')}"
    counting: Counting = "fractional" if shown_as["counting"] == "fractional" else "studies"
    if shown_as["flow"] == "answer":
        grouped = shown_as["detail"] == "grouped"
        return answer_figure(found, facts, page_address, counting, grouped=grouped)
    where = {name: values for name in ATTRIBUTES if (values := getattr(asked, name))}
    made = figure_of(shown_as["flow"], facts, where, page_address, counting)
    return replace(made, name="flow")


def _scatter(known: Knowledge, found: Answer, across: str) -> tuple[Figure, list[str]]:
    """Return the judged errors of the best calibrations of an answer, and who has none to draw."""
    words, more = ACROSS.get(across, ACROSS["field"])
    points: list[Point] = []
    left_out: list[str] = []
    for one in (service.architecture(found, one) for one in found.architectures):
        measured = None if one.best is None else one.best.measured
        if measured is None or not (error := _judged_deg(measured, found.level)):
            continue
        value = measured.field_deg
        if not more:
            place = (measured.dataset, measured.extractor, measured.model)
            value = known.measurements.curve_of.get(place, {}).get("needed_poses")
        if value:
            points.append(_point(one, measured, value, error))
        else:
            left_out.append(f"{one.detector} + {one.mask}")
    up = "error in flight" if found.level == "flight" else "own error"
    unit = "°" if more else "poses"
    return architectures_figure(points, up, words, unit, more_is_better=more), left_out


def _judged_deg(measured: Measured, level: str) -> float | None:
    """Return the error at a level; the own one of what was not flown."""
    if level == "flight" and measured.flight_error_deg is not None:
        return measured.flight_error_deg
    return measured.own_error_deg


def _point(one: Architecture, measured: Measured, across: float, error_deg: float) -> Point:
    return Point(
        f"{one.detector} + {one.mask}",
        architecture_page(one.detector, one.mask),
        across,
        error_deg,
        measured.bound_deg,
        is_built=one.built,
    )
