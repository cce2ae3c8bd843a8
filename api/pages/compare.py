"""/compare: two to four architectures, or pipelines of a data set, side by side."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from fastapi import Query, Request
from pydantic import Field

from api.figures.figure import Figure
from api.figures.lines import Line, line_figure
from api.pages.editions import edition_shown
from api.pages.sensors import best_built
from api.pages.serving import PageRouter, View
from api.schema import words
from api.schema.base import OfEdition
from api.schema.comparison import MOST, SEPARATOR
from api.schema.parameters import GIVEN, Several, several
from api.service.comparing import compare_architectures, compare_pipelines
from api.service.documents import Document
from api.service.knowledge import Knowledge
from api.service.problems import Problem, Violation
from api.web.dependencies import Known
from benchmark.metrics.score import AVAILABLE
from registry.taxonomy import InvalidValueError

router = PageRouter()

COLUMNS = (
    *("detector", "mask", "dataset", "condition", "extractor", "model", "status", "own_error_deg"),
    *("bound_deg", "over_bound", "ratio_to_smallest", "availability", "half_fov_deg", "rank"),
    *("low_deg", "high_deg", "needed_poses", "latency_us", "studies", "proposed"),
)
FEWEST = 2
#: Architectures that differ in what a designer weighs: a start for who has none in mind.
START = ("CMOS:Encoded", "CMOS:Single-Ap.", "QPD:Single-Ap.", "PD:Maskless")


class CompareQuery(OfEdition):
    """What is compared: architectures, or pipelines of a data set."""

    architecture: Several[str] = several("Two to four of detector:mask.")
    dataset: Annotated[words.DatasetName | None, GIVEN] = Field(None)
    condition: Annotated[words.Condition | None, GIVEN] = Field(None)
    pipeline: Several[str] = several("Two to four of extractor:model on the data set.")


@router.page("/compare", figures=True)
async def compare(known: Known, query: Annotated[CompareQuery, Query()], request: Request) -> View:
    """Side by side what was asked for; else what can be."""
    document = _compare(known.of(query.edition), query)
    items: list[Mapping[str, Any]] = document["items"]
    pipelines = bool(query.dataset)
    names = [
        f"{i['extractor']} + {i['model']}" if pipelines else f"{i['detector']} + {i['mask']}"
        for i in items
    ]
    built = [f"{row['detector']}{SEPARATOR}{row['mask']}" for row in best_built(known)]
    chart = _chart(items, names)
    return View(
        "compare.html",
        Document(document, COLUMNS, lambda: [{c: i.get(c) for c in COLUMNS} for i in items]),
        asked=query,
        editions=edition_shown(known, query.edition, request),
        names=names,
        pipelines=pipelines,
        most=MOST,
        start=START,
        architectures=built,
        datasets=list(known.measurements.presets),
        ways=_ways(known, query.dataset),
        conditions=known.measurements.presets[query.dataset].conditions if query.dataset else (),
        every_condition=list(dict.fromkeys(c for i in items for c in i["conditions"])),
        available=AVAILABLE,
        machine=timed.processor if (timed := known.measurements.times.machine) else "",
        figures=(chart,),
        chart=chart,
    )


def _compare(known: Knowledge, query: CompareQuery) -> dict[str, Any]:
    """Return the comparison; nothing where fewer than two are named yet."""
    nothing: dict[str, Any] = {"dataset": query.dataset, "condition": None, "items": []}
    try:
        if query.dataset:
            ways = list(dict.fromkeys(query.pipeline or ()))
            if len(ways) < FEWEST:
                return nothing
            return compare_pipelines(known, query.dataset, ways, query.condition)
        named = list(dict.fromkeys(query.architecture or ()))
        return nothing if len(named) < FEWEST else compare_architectures(known, named)
    except InvalidValueError as error:
        said = Violation(error.parameter, str(error.value), error.expected, error.nearest)
        raise Problem(422, "invalid-value", errors=[said]) from error


def _ways(known: Knowledge, dataset: str | None) -> list[str]:
    """Return the pipelines of a data set as they are named, best first."""
    if dataset is None:
        return []
    rows = known.measurements.board_rows(dataset)
    return list(dict.fromkeys(f"{r['extractor']}{SEPARATOR}{r['model']}" for r in rows))


def _chart(items: list[Mapping[str, Any]], names: list[str]) -> Figure:
    lines = [
        Line(name, [((r["inner_deg"] + r["outer_deg"]) / 2, r["rms_deg"]) for r in item["rings"]])
        for item, name in zip(items, names, strict=True)
        if item["rings"]
    ]
    return line_figure(
        "field",
        "Errors of those compared against the Sun's angle off the boresight",
        lines,
        "angle off the boresight, °",
        "Unit 0 RMS, °",
    )
