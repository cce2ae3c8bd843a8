"""/: ranked sensors and calibrations; and /scatter, the plot alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from fastapi import Request
from pydantic import ValidationError

from api.addresses import architecture_page
from api.http.routers import recommendations as service
from api.metadata import schema_org
from api.metadata.identity import identity
from api.metadata.signposting import landing_of_atlas
from api.pages.editions import edition_shown
from api.pages.plots.scatter import Point, Scatter
from api.pages.serving import PageRouter, View
from api.pages.study import NAMES
from api.schema.recommendations import RecommendationRow
from api.schema.requirements import RequirementsQuery
from api.schema.table import columns_of
from api.service.knowledge import Knowledge
from api.service.problems import Problem
from api.service.refusals import refusal
from api.web.answers import Answer
from api.web.dependencies import Known
from registry.requirements import HAZARDS, LIMITS, SETTINGS
from registry.taxonomy import ATTRIBUTES

router = PageRouter()

#: Names in the address that say how the answer is shown, for the page's script.
SHOWN = (
    *("chart", "counting", "detail", "view", "dataset", "board_condition", "board_field"),
    *("board_sort", "board_order", "across", "rows"),
)
#: Names that the service takes and the page settles itself.
PAGED = ("limit", "calibrations", "format", "fields")
#: What errors are drawn against, and whether more of it is better.
ACROSS = {"field": ("field of view, °", True), "poses": ("calibration poses needed", False)}
FIRST, MOST = 10, 500
BOARD_ROWS = 8
SORTS = (("advice", "Advice"), ("support", "Studies"), ("measured", "Measurement"))
KINDS = (
    ("advised", "Advised by the survey"),
    ("proposed", "Used in studies"),
    ("measured", "Measured here"),
)
LIMIT_WORDS = {
    "max_error_deg": ("error at most", "°"),
    "min_fov_deg": ("field of view at least", "°"),
    "min_availability": ("availability at least", ""),
    "max_latency_us": ("latency at most", " µs"),
    "bench_deg": ("calibration bench error", "°"),
    "confidence": ("confidence over units and benches", ""),
}
LIST_WORDS = {
    "survive": "must tolerate",
    "properties": "extractor property",
    "exclude_needs": "without",
}


@router.page("/", twin="/answer")
async def answer(known: Known, request: Request) -> View:
    """Render the answer to the requirements in the address, readable without JavaScript."""
    fields = request.query_params.multi_items()
    shown = {name: value for name, value in fields if name in SHOWN}
    try:
        asked = _ask(fields)
    except Problem as problem:
        view = View("answer.html", _nothing(), problem=problem.document("/"), **_parts(known))
        view.status_code = problem.status_code
        return view
    parts = _parts(known.of(asked.edition))
    answer = await service.recommendations(known, asked)
    document = answer.document
    best = _best_measured(document)
    landing = landing_of_atlas(identity())
    return View(
        "answer.html",
        answer,
        landing=landing,
        entity=schema_org.atlas(identity(), known.measurements.presets),
        problem=None,
        asked=asked,
        editions=edition_shown(known, asked.edition, request),
        clauses=_clauses(asked),
        first=MOST if shown.get("rows") == "all" else FIRST,
        scatter=_scatter(known, document, shown.get("across", "field")),
        across=shown.get("across", "field"),
        backing=len({key for a in document["architectures"] for key in a["studies"]}),
        measured=sum(1 for a in document["architectures"] if a["best"]["measured"]),
        best=best,
        board=_board(known, best),
        blocked_by=_in_words(document["blocked"]["constraint"]) if document["blocked"] else "",
        **parts,
    )


@router.page("/scatter")
async def scatter(known: Known, request: Request) -> View:
    """Render the scatter plot alone, for the page's script."""
    fields = request.query_params.multi_items()
    across = dict(fields).get("across", "field")
    answer = await service.recommendations(known, _ask(fields))
    drawn = _scatter(known, answer.document, across)
    return View(
        "scatter_alone.html",
        answer,
        scatter=drawn,
        across=across,
        best=_best_measured(answer.document),
        sorts=SORTS,
    )


def _ask(fields: Sequence[tuple[str, str]]) -> RequirementsQuery:
    """Return the requirements among the fields of a query; Problem where they are none."""
    given: dict[str, Any] = {}
    for name, value in fields:
        if name in SHOWN:
            continue
        if name in PAGED:
            raise Problem(400, "unknown-parameter", f"{name} cannot be asked for here")
        if name in LIMITS or name in SETTINGS or name in ("sort", "edition"):
            given[name] = value
        else:
            given.setdefault(name, []).append(value)
    try:
        return RequirementsQuery.model_validate({**given, "limit": MOST})
    except ValidationError as error:
        errors = [{**found, "loc": ("query", *found["loc"])} for found in error.errors()]
        raise refusal(errors, service.recommendations) from error


def _nothing() -> Answer:
    return Answer({"architectures": [], "count": 0}, columns_of(RecommendationRow), list)


def _parts(known: Knowledge) -> dict[str, Any]:
    """Return the parts of the page that do not depend on the requirements."""
    taxonomy = known.taxonomy.to_dict()
    return {
        "mapped": len(known.facts.studies),
        "taxonomy": {name: taxonomy[name] for name in ATTRIBUTES},
        "names": NAMES,
        "hazards": HAZARDS,
        "properties": known.facts.properties,
        "limits": LIMIT_WORDS,
        "sorts": SORTS,
        "kinds": KINDS,
    }


def _clauses(asked: RequirementsQuery) -> list[str]:
    """Return the requirements in words."""
    given = asked.model_dump(exclude_defaults=True)
    clauses = []
    for name in ATTRIBUTES:
        subject = NAMES[name].lower()
        if given.get(name):
            clauses.append(f"{subject} {' or '.join(given[name])}")
        if given.get(f"exclude_{name}"):
            clauses.append(f"{subject} not {' nor '.join(given[f'exclude_{name}'])}")
    for name, (words, unit) in LIMIT_WORDS.items():
        if name in given:
            clauses.append(f"{words} {given[name]:g}{unit}")
    for name, words in LIST_WORDS.items():
        if given.get(name):
            clauses.append(f"{words} {' and '.join(given[name])}")
    return clauses


def _in_words(constraint: str) -> str:
    """Return parameters joined by " + " as the form names them."""
    return " + ".join(
        f"not that {NAMES[name.removeprefix('exclude_')].lower()}"
        if name.startswith("exclude_")
        else LIMIT_WORDS.get(name, (LIST_WORDS.get(name) or NAMES.get(name, name).lower(), ""))[0]
        for name in constraint.split(" + ")
    )


def _best_measured(document: Mapping[str, Any]) -> Mapping[str, Any] | None:
    """Return the architecture with the lowest measured error."""
    judged = [
        a
        for a in document["architectures"]
        if a["best"]["measured"] and a["best"]["measured"]["error_deg"] is not None
    ]
    return min(judged, key=lambda a: a["best"]["measured"]["error_deg"], default=None)


def _scatter(known: Knowledge, document: Mapping[str, Any], across: str) -> Scatter:
    words, more = ACROSS.get(across, ACROSS["field"])
    points: list[Point] = []
    left_out: list[str] = []
    for a in document["architectures"]:
        measured = a["best"]["measured"]
        if not measured or not measured["error_deg"]:
            continue
        place = tuple(measured[name] for name in ("dataset", "extractor", "model"))
        if more:
            value = measured["field_deg"] or measured["fov_deg"]
        else:
            value = known.measurements.curve_of.get(place, {}).get("needed_poses")
        name = f"{a['detector']} + {a['mask']}"
        if not value:
            left_out.append(name)
            continue
        points.append(
            Point(
                name,
                architecture_page(a["detector"], a["mask"]),
                value,
                measured["error_deg"],
                measured["nominal"]["bound_deg"],
                measured["finer"],
            )
        )
    return Scatter(points, words, more, "°" if more else "poses", left_out)


def _board(known: Knowledge, best: Mapping[str, Any] | None) -> dict[str, Any] | None:
    """Return the first rows of the board that the best measured calibration stands on."""
    if best is None:
        return None
    measured = best["best"]["measured"]
    rows = [
        row
        for row in known.measurements.board_rows(measured["dataset"])
        if row["condition"] == measured["condition"]
    ]
    return {
        "dataset": measured["dataset"],
        "condition": measured["condition"],
        "rows": rows[:BOARD_ROWS],
        "total": len(rows),
    }
